"""Names of the models, and the record of the options that select their variants.

Input: none. Output: `ModelOptions`, with the defaults of the command line and of Python.
"""

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
# Models without mass, and therefore without frequencies.
STATIC: tuple[ModelName, ...] = ("vjm", "links")
