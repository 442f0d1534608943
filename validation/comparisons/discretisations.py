"""Formulation of the legs with its element count or mesh, layout and theory.

Input: the formulation's name and numbers. Output: a `Discretisation` with the model options, formal
order of convergence and labels that follow from it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from lumped.model_choices import Ends, Layout, Theory
from validation.models.options import (
    DEFAULT_OPTIONS,
    LITERAL_ORDER,
    MODELS,
    OF_ELEMENTS,
    ModelOptions,
    RefinedModel,
)


class Parameter(NamedTuple):
    """Parameter of a discretisation over which a study shows convergence.

    `heading`: its name in headings, as in "convergence with element count". `axis`: label of the
    axis of its values.
    """

    heading: str
    axis: str


# Parameters by the field of `Discretisation` that has the value.
PARAMETERS: Mapping[str, Parameter] = {
    "elements": Parameter("element count", "elements per leg"),
    "divisions": Parameter("mesh", "divisions across the section"),
}


@dataclass(frozen=True)
class Discretisation:
    """Formulation of the legs with its element count or mesh, layout and theory.

    `elements`: number per leg (segments and beam). `layout` (segments): "half" has springs of half
    length at both ends, "literal" follows the text of the paper (§3.2). `theory` (segments and
    beam): Timoshenko's or that of Euler and Bernoulli. For solids, `divisions` are the elements
    across the smaller side of the section, and `ends` the condition of the end faces.
    """

    model: RefinedModel
    layout: Layout = "half"
    theory: Theory = "timoshenko"
    elements: int = DEFAULT_OPTIONS.elements
    divisions: int = DEFAULT_OPTIONS.divisions
    ends: Ends = "rigid"

    @property
    def options(self) -> ModelOptions:
        """Options of the model. CAD parts become legs of ten prismatic pieces."""
        return replace(
            DEFAULT_OPTIONS,
            elements=self.elements,
            layout=self.layout,
            theory=self.theory,
            divisions=self.divisions,
            ends=self.ends,
            parts="stepped",
        )

    @property
    def refined(self) -> str:
        """Parameter in `PARAMETERS` that a convergence study changes."""
        return "divisions" if self.model == "solid" else "elements"

    @property
    def count(self) -> int:
        """Value of the parameter `refined`: element count, or divisions for a solid."""
        count: int = getattr(self, self.refined)
        return count

    def with_count(self, count: int) -> "Discretisation":
        """Copy with another value of the parameter `refined`."""
        parameters: dict[str, Any] = {self.refined: count}
        return replace(self, **parameters)

    @property
    def element_order(self) -> float:
        """Formal order of convergence of the frequencies of segments and beams in 1/n."""
        if self.model == "segments" and self.layout == "literal":
            return LITERAL_ORDER
        return MODELS[self.model].order

    @property
    def fewest_elements(self) -> int:
        """Smallest element count that the formulation allows.

        The literal layout joins one element rigidly to each end, hence it needs two.
        """
        return 2 if self.model == "segments" and self.layout == "literal" else 1

    @property
    def formulation(self) -> str:
        """Name of the formulation in tables and legends, without its theory."""
        if self.model == "solid":
            return f"solid, {self.ends} ends"
        if self.model != "segments":
            return "beam FE" if self.model == "beam" else MODELS[self.model].words
        layouts = {"half": "half-length end springs", "literal": "springs between elements only"}
        return f"segments, {layouts[self.layout]}"

    @property
    def label(self) -> str:
        """Name of the formulation, with its theory unless that is Timoshenko's."""
        return f"{self.formulation}{self._theory}"

    @property
    def _theory(self) -> str:
        return ", Euler–Bernoulli" if self.theory == "euler-bernoulli" else ""

    @property
    def look(self) -> str:
        """Key of `validation.drawing.style.LOOKS` for colour and marker."""
        if self.model == "solid":
            return "solid" if self.ends == "rigid" else "solid, free"
        theory = "-euler-bernoulli" if self.theory == "euler-bernoulli" else ""
        layout = ", literal layout" if self.layout == "literal" else ""
        return f"{self.model}{theory}{layout}"


# Layouts of the springs, by model. Other models have no springs.
_LAYOUTS: Mapping[str, tuple[Layout, ...]] = {"segments": ("half", "literal")}
FORMULATIONS = tuple(
    Discretisation(model, layout)
    for model in OF_ELEMENTS
    for layout in _LAYOUTS.get(model, ("half",))
)
# The formulations without shear and rotary inertia.
EULER_BERNOULLI = tuple(
    replace(discretisation, theory="euler-bernoulli") for discretisation in FORMULATIONS
)
