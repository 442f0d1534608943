"""Discretisations of the legs of a robot: model, element count or mesh, layout and theory."""

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from lumped.legs import Theory
from lumped.models.segments import Layout
from validation.models.options import (
    BEAM_ORDER,
    DEFAULT_OPTIONS,
    LITERAL_ORDER,
    SEGMENT_ORDER,
    Ends,
    ModelOptions,
)

RefinedModel: TypeAlias = Literal["segments", "beam", "solid"]


@dataclass(frozen=True)
class Discretisation:
    """Discretisation and theory of the legs.

    `elements` per leg, for segments and beam. `layout`, for segments: "half" has springs of half
    length at both ends, "literal" is the paper's text (§3.2). `theory`, for segments and beam.
    `divisions` across the smaller side of the section and `ends`, for solids.
    """

    model: RefinedModel
    layout: Layout = "half"
    theory: Theory = "timoshenko"
    elements: int = DEFAULT_OPTIONS.elements
    divisions: int = DEFAULT_OPTIONS.divisions
    ends: Ends = "rigid"

    @property
    def options(self) -> ModelOptions:
        """Options of a model; CAD parts become legs of ten prismatic pieces."""
        return replace(
            DEFAULT_OPTIONS,
            elements=self.elements,
            layout=self.layout,
            theory=self.theory,
            divisions=self.divisions,
            ends=self.ends,
            parts="stepped",
        )

    def with_count(self, count: int) -> "Discretisation":
        """The discretisation with another element count, or other divisions for a solid."""
        if self.model == "solid":
            return replace(self, divisions=count)
        return replace(self, elements=count)

    @property
    def element_order(self) -> float:
        """Formal order in 1/n of the frequencies of segments and beams."""
        if self.model == "beam":
            return BEAM_ORDER
        return SEGMENT_ORDER if self.layout == "half" else LITERAL_ORDER

    @property
    def fewest_elements(self) -> int:
        """The smallest element count: the literal layout fuses an element with each end."""
        return 2 if self.model == "segments" and self.layout == "literal" else 1

    @property
    def formulation(self) -> str:
        """The formulation without its theory, as tables and legends name it."""
        if self.model == "solid":
            return f"solid, {self.ends} ends"
        if self.model == "beam":
            return "beam FE"
        layouts = {"half": "half-length end springs", "literal": "springs between elements only"}
        return f"segments, {layouts[self.layout]}"

    @property
    def label(self) -> str:
        """The formulation, with its theory if that is not Timoshenko's."""
        return f"{self.formulation}{self._theory}"

    @property
    def _theory(self) -> str:
        return ", Euler–Bernoulli" if self.theory == "euler-bernoulli" else ""

    @property
    def look(self) -> str:
        """The entry of `validation.drawing.style.LOOKS` with its colour and marker."""
        if self.model == "solid":
            return "solid" if self.ends == "rigid" else "solid, free"
        theory = "-euler-bernoulli" if self.theory == "euler-bernoulli" else ""
        layout = ", literal layout" if self.layout == "literal" else ""
        return f"{self.model}{theory}{layout}"


FORMULATIONS = (
    Discretisation("segments", "half"),
    Discretisation("segments", "literal"),
    Discretisation("beam"),
)
# The formulations without shear and rotary inertia.
EULER_BERNOULLI = tuple(
    replace(discretisation, theory="euler-bernoulli") for discretisation in FORMULATIONS
)
