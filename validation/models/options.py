"""Table of the models, and the record of the options that select their variants.

Input: none. Output: names and properties of the models, and `ModelOptions` with the defaults of the
command line and of Python. Rule: this module imports nothing that is slow to import, because the
commands take the names of the models from it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias, get_args

from lumped.model_choices import (
    Ends,
    EquivalentBy,
    Layout,
    LegSprings,
    PartLegs,
    ReductionBy,
    Release,
    Theory,
)

# Models without mass, and therefore without frequencies.
StaticModel: TypeAlias = Literal["vjm", "links"]
# Models that divide legs into elements. Their matrices are in `validation.models.leg_models`.
ElementModel: TypeAlias = Literal["segments", "beam"]
# Models that can be refined, models with frequencies, and all models.
RefinedModel: TypeAlias = Literal[ElementModel, "solid"]
ModalModel: TypeAlias = Literal["simplified", RefinedModel]
ModelName: TypeAlias = Literal["simplified", StaticModel, RefinedModel]


@dataclass(frozen=True)
class ModelOptions:
    """Options of the models, as on the command line; in brackets, the models that each affects.

    `legs` (vjm, links): the 6×6 compliance of the robot file, or that of the equivalent prism.
    `theory`: beam theory (segments, beam; vjm and links with equivalent legs). `elements`
    (segments, beam): number per leg. `release`: treatment of the joint at a leg's tip, `layout`:
    positions of the springs (segments). `ends`: condition of the end faces, `divisions`: elements
    across the section (solid). `equivalent`: matrix of the leg, 6×6 stiffness or compliance, whose
    diagonal the equivalent prism has. `parts` (segments, beam): CAD parts as equivalent legs, as
    legs stepped in prismatic pieces, or condensed to their interfaces with mass. `reduction`
    (solid): CAD parts by modes with all interfaces fixed (Craig and Bampton) or free (MacNeal,
    Rubin).
    """

    legs: LegSprings = "given"
    theory: Theory = "timoshenko"
    elements: int = 20
    release: Release = "condensed"
    layout: Layout = "half"
    ends: Ends = "rigid"
    divisions: int = 4
    equivalent: EquivalentBy = "stiffness"
    parts: PartLegs = "equivalent"
    reduction: ReductionBy = "fixed"


DEFAULT_OPTIONS = ModelOptions()
# Orders of convergence of frequencies in 1/elements: segments with half-length end springs,
# segments with springs between them only, beams with cubic shape functions.
SEGMENT_ORDER, LITERAL_ORDER, BEAM_ORDER = 2.0, 1.0, 4.0
STATIC: tuple[StaticModel, ...] = get_args(StaticModel)
OF_ELEMENTS: tuple[ElementModel, ...] = get_args(ElementModel)


class ModelProperties(NamedTuple):
    """Properties of a model.

    `options`: options of the command line that affect it. Any other option is a fault. `words`:
    name of the model in tables and sentences. `order`: formal order of convergence of its
    frequencies in 1/elements, for `OF_ELEMENTS` only.
    """

    options: tuple[str, ...]
    words: str
    order: float = 0.0


MODELS: Mapping[ModelName, ModelProperties] = {
    "simplified": ModelProperties((), "simplified"),
    "vjm": ModelProperties(("legs", "theory", "equivalent"), "VJM"),
    "links": ModelProperties(("legs", "theory", "equivalent"), "links"),
    "segments": ModelProperties(
        ("theory", "elements", "release", "layout", "equivalent", "parts"),
        "segments",
        SEGMENT_ORDER,
    ),
    "beam": ModelProperties(("theory", "elements", "equivalent", "parts"), "Beam FE", BEAM_ORDER),
    "solid": ModelProperties(("ends", "divisions", "equivalent", "reduction"), "solid"),
}
