"""A leg made longer and longer, its section kept: solids with both ends beside beam theory."""

from dataclasses import dataclass, replace

import numpy as np

from fem.beams.beam import beam_leg
from fem.bodies import doubling
from lumped.arrays import Array
from lumped.legs import BeamProperties, ConstantLeg, tip_compliance
from lumped.models.cantilever import kind_frequencies
from lumped.sections import Circle, Rectangle, Tube
from meshes.prism.hexahedra import slice_count
from meshes.section.section_mesh import section_mesh
from validation.context import Preset
from validation.solids.legs import (
    decay_of_warping,
    face_mesh,
    own_properties,
    section_counts,
)

# Unknowns of a rectangle's section mesh at most, elements across the smaller side of the others. A
# round rim needs eight for its flexure (ν > 0) to reach 1e-4.
RECTANGLE: dict[Preset, int] = {"quick": 300, "standard": 600, "fine": 1000}
WALLS: dict[Preset, int] = {"quick": 4, "standard": 4, "fine": 8}
ROUND: dict[Preset, int] = {"quick": 8, "standard": 8, "fine": 12}
# Exponents are from the three longest lengths, their uncertainty from the three before the longest
# and falls fourfold with each doubling: a box's torsion needs the fourth.
DOUBLINGS = 4
# Depths over which an end effect decays that the shortest leg of an exponent must have: e⁻³ and
# less then reach from end to end.
_DEPTHS = 3.0
_RECTANGLE_LADDER = (8, 6, 4, 3, 2)
_BEAM_ELEMENTS = 20


@dataclass(frozen=True)
class Lengthened:
    """Diagonals of tip compliances (m×6, SI) of a leg at m `lengths` (m), each twice the last.

    Solids with `rigid` and with `free` ends, Timoshenko's `beam` and Euler–Bernoulli's
    (`slender`), both with the section's own constants.
    """

    lengths: Array
    rigid: Array
    free: Array
    beam: Array
    slender: Array


def lengthened(leg: ConstantLeg, divisions: int, doublings: int) -> Lengthened:
    """The leg, its length doubled so many times: each costs one dense step."""
    counts = section_counts(leg, divisions)
    mesh = section_mesh(leg.section, counts)
    beam = own_properties(leg, divisions)
    condensed = doubling.condensed_leg(leg, mesh, slice_count(leg.section, leg.length, counts))
    pieces = [condensed]
    for _ in range(doublings):
        pieces.append(doubling.doubled(pieces[-1]))
    lengths = [leg.length * 2.0**k for k in range(len(pieces))]
    slender = beam.as_euler_bernoulli()
    return Lengthened(
        lengths=np.array(lengths),
        rigid=np.array([np.diag(doubling.tip_compliance(p, "rigid")) for p in pieces]),
        free=np.array([np.diag(doubling.tip_compliance(p, "free")) for p in pieces]),
        beam=np.array([np.diag(tip_compliance(beam, length)) for length in lengths]),
        slender=np.array([np.diag(tip_compliance(slender, length)) for length in lengths]),
    )


def limit_exponent(lengths: Array, amounts: Array) -> float:
    """Exponent −p of amounts = C s⁻ᵖ (1 + D/s + …): local ones of the three longest, extrapolated.

    Local exponents differ from −p by a term in 1/s, halved with each doubling.
    """
    before, last = np.diff(np.log(amounts[-3:])) / np.diff(np.log(lengths[-3:]))
    return float(2.0 * last - before)


def fundamental_ratio(properties: BeamProperties, length: float) -> float:
    """First frequency of bending y without rotary inertia over that with it, no shear."""
    slender = properties.as_euler_bernoulli()
    rayleigh = replace(slender, rho_Iy=properties.rho_Iy)
    legs = (beam_leg(beam, length, _BEAM_ELEMENTS) for beam in (slender, rayleigh))
    (without,), (with_inertia,) = (kind_frequencies(leg, "bending y", 1) for leg in legs)
    return float(without / with_inertia)


def affordable_divisions(leg: ConstantLeg, preset: Preset) -> int:
    """Elements across the smaller side that a preset affords."""
    match leg.section:
        case Rectangle():
            sizes = ((n, 3 * len(face_mesh(leg, n).nodes)) for n in _RECTANGLE_LADDER)
            return next((n for n, unknowns in sizes if unknowns <= RECTANGLE[preset]), 1)
        case Circle() | Tube():
            return ROUND[preset]
        case _:
            return WALLS[preset]


def doublings_needed(leg: ConstantLeg, divisions: int) -> int:
    """Doublings after which the last five lengths are free of effects from end to end.

    The depth of an end effect is the larger side, or √(EΓ/GJ) of an open section (Vlasov).
    """
    shortest = _DEPTHS * max(*leg.section.extent, decay_of_warping(leg, divisions))
    return DOUBLINGS + max(0, int(np.ceil(np.log2(shortest / leg.length))))
