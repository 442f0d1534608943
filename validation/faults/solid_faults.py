"""Mistakes in end couplings, solid legs, condensation and section constants."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from fem.bodies.solid import ClampedLeg, SolidLeg
from lumped.arrays import Array
from lumped.modes import Modes
from validation.faults.fault import Fault, Faulty, around, instead, result


def _node_left_out(ends: Any) -> Any:
    middle = len(ends.tip) // 2
    rows = slice(3 * middle, 3 * middle + 3)
    loose = ends.tip[middle]
    return replace(
        ends,
        tip=np.delete(ends.tip, middle),
        interior=np.sort(np.append(ends.interior, loose)),
        tip_motion=np.delete(ends.tip_motion, np.r_[rows], axis=0),
    )


def _motion_sign(motions: Array) -> Array:
    sign = np.array([1.0, 1.0, 1.0, 1.0, -1.0, 1.0])
    return np.asarray(motions * sign)


def _no_lever(sound: Faulty, points: Array, reference: Array) -> Array:
    found: Array = sound(points, reference * 0.5)
    return found


def _bending_twice(loads: Array) -> Array:
    return np.asarray(loads * np.array([1.0, 1.0, 1.0, 1.0, 2.0, 2.0]))


def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


def _unchanged(_ends: Any, field: Array) -> Array:
    return np.asarray(field)


def _half_slices(sound: Faulty, leg: Any, section: Any, slices: int) -> Any:
    shorter = replace(leg, length=leg.length * (slices // 2) / slices)
    return sound(shorter, section, slices // 2)


def _unmoved(sound: Faulty, piece: Any) -> Any:
    found = sound(piece)
    return replace(found, compliance=2.0 * piece.compliance)


def _wrong_mirror(sound: Faulty, piece: Any) -> Any:
    return sound(replace(piece, mirror=-piece.mirror))


def _swapped(name: str) -> Any:
    def change(constants: Any) -> Any:
        return replace(constants, **{name: getattr(constants, name)[::-1]})

    return result(change)


def _polar(constants: Any) -> Any:
    return replace(
        constants, torsion_constant=constants.second_moment_y + constants.second_moment_z
    )


def _free_as_rigid(sound: Faulty, condensed: Any, _ends: str = "rigid") -> Array:
    found: Array = sound(condensed, "rigid")
    return found


def _half_tip(compliance: Array) -> Array:
    return 0.5 * (compliance + np.diag(np.diag(compliance)))


def _massless_tip(sound: Faulty, solid: SolidLeg, ends: Any = "rigid") -> ClampedLeg:
    found: ClampedLeg = sound(replace(solid, mass=csr_array(0.5 * solid.mass)), ends)
    return found


FAULTS = (
    Fault(
        "ends.node-left-out",
        "A face node left out of the rigid coupling",
        "fem.couplings.end_coupling:rigid_ends",
        "numerics",
        result(_node_left_out),
    ),
    Fault(
        "ends.rotation-sign",
        "Rigid end faces: φy with the wrong sign",
        "fem.couplings.end_coupling:rigid_motions",
        "physics",
        result(_motion_sign),
    ),
    Fault(
        "ends.reference-point",
        "Rigid motions about half the lever arm to the reference point",
        "fem.couplings.end_coupling:rigid_motions",
        "physics",
        around(_no_lever),
    ),
    Fault(
        "ends.moment-twice",
        "Saint-Venant's moments twice as large as unit wrenches",
        "fem.couplings.end_coupling:saint_venant_loads",
        "physics",
        result(_bending_twice),
    ),
    Fault(
        "ends.no-reaction",
        "Free ends: the root's reaction left out",
        "fem.couplings.end_coupling:FreeEnds.equilibrated",
        "physics",
        instead(_unchanged),
    ),
    Fault(
        "ends.loose-root",
        "Free ends: rigid motion of the root not taken off",
        "fem.couplings.end_coupling:FreeEnds.expanded",
        "physics",
        instead(_unchanged),
    ),
    Fault(
        "solid.angular-frequency",
        "Solid: frequencies in rad/s for Hz",
        "fem.bodies.leg_modes:modes",
        "physics",
        result(_angular),
    ),
    Fault(
        "solid.coupling-halved",
        "Solid: coupling terms of the compliance halved",
        "fem.bodies.solid:tip_compliance",
        "physics",
        result(_half_tip),
    ),
    Fault(
        "solid.half-mass",
        "Solid: half the mass",
        "fem.bodies.solid:clamped_leg",
        "physics",
        around(_massless_tip),
    ),
    Fault(
        "doubling.half-of-slices",
        "Doubling: half of the slices left out",
        "fem.bodies.doubling:condensed_leg",
        "numerics",
        around(_half_slices),
    ),
    Fault(
        "doubling.lever-forgotten",
        "Doubling: compliances added without moving them to the common middle",
        "fem.bodies.doubling:doubled",
        "physics",
        around(_unmoved),
    ),
    Fault(
        "doubling.mirror-sign",
        "Doubling: signs of mirrored deformations exchanged",
        "fem.bodies.doubling:doubled",
        "numerics",
        around(_wrong_mirror),
    ),
    Fault(
        "doubling.ends-held",
        "Doubling: free ends computed with rigid ends",
        "fem.bodies.doubling:tip_compliance",
        "physics",
        around(_free_as_rigid),
    ),
    Fault(
        "constants.shear-swapped",
        "Shear coefficients of the section mesh along the wrong axes",
        "fem.sections.section_constants:constants_of",
        "physics",
        _swapped("shear_coefficients"),
    ),
    Fault(
        "constants.polar-torsion",
        "Section mesh: torsion without warping, J = Ip",
        "fem.sections.section_constants:constants_of",
        "physics",
        result(_polar),
    ),
    Fault(
        "constants.poisson-ratio",
        "ν for νG/E in Saint-Venant's flexure",
        "fem.sections.section_constants:poisson_shear_ratio",
        "physics",
        instead(lambda nu, _shear_to_young=None: nu),
    ),
)
