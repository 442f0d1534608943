"""Names of the models, and their options."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from lumped.equivalent_leg import EquivalentBy
from lumped.legs import Theory
from lumped.models.segments import Layout, Release

ModelName: TypeAlias = Literal["simplified", "vjm", "links", "segments", "beam", "solid"]
LegSprings: TypeAlias = Literal["given", "equivalent"]
Ends: TypeAlias = Literal["rigid", "free"]
PartLegs: TypeAlias = Literal["equivalent", "stepped", "condensed"]
ReductionBy: TypeAlias = Literal["fixed", "free"]


@dataclass(frozen=True)
class ModelOptions:
    """Options of the models, as on the command line.

    `legs` (vjm, links): each leg's own 6×6 or that of its equivalent constant-section leg; `theory`
    (segments, beam; vjm and links with equivalent legs); `elements` per leg (segments, beam);
    `release`, `layout` (segments); `ends`, `divisions` (solid); `equivalent`: which diagonal is
    matched; `parts` (segments, beam): CAD parts as equivalent legs, as legs stepped in prismatic
    pieces, or condensed on their interfaces with their mass; `reduction` (solid): CAD parts by
    their modes with all interfaces fixed (Craig and Bampton) or free (MacNeal, Rubin).
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
# Orders in 1/elements with which frequencies converge: segments with half springs at the ends, and
# with springs between them alone; beams of cubic shapes.
SEGMENT_ORDER, LITERAL_ORDER, BEAM_ORDER = 2.0, 1.0, 4.0
# Models that have no mass, so no frequencies.
STATIC: tuple[ModelName, ...] = ("vjm", "links")
