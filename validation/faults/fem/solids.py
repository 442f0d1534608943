"""Mistakes in end couplings, solid legs, condensation and section constants."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from fem.bodies.solid import ClampedLeg, SolidLeg
from lumped.arrays import Array
from lumped.dense.modes import Modes
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_in_value(
    "ends.node-left-out",
    "A face node left out of the rigid coupling",
    "fem.couplings.end_coupling.rigid_ends",
)
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


@fault_in_value(
    "ends.rotation-sign",
    "Rigid end faces: φy with the wrong sign",
    "fem.couplings.end_coupling.rigid_motions",
)
def _motion_sign(motions: Array) -> Array:
    sign = np.array([1.0, 1.0, 1.0, 1.0, -1.0, 1.0])
    return np.asarray(motions * sign)


@fault_around(
    "ends.reference-point",
    "Rigid motions about half the lever arm to the reference point",
    "fem.couplings.end_coupling.rigid_motions",
)
def _no_lever(sound: Faulty, points: Array, reference: Array) -> Array:
    found: Array = sound(points, reference * 0.5)
    return found


@fault_in_value(
    "ends.moment-twice",
    "Saint-Venant's moments twice as large as unit wrenches",
    "fem.couplings.end_coupling.saint_venant_loads",
)
def _bending_twice(loads: Array) -> Array:
    return np.asarray(loads * np.array([1.0, 1.0, 1.0, 1.0, 2.0, 2.0]))


@fault_in_value(
    "solid.angular-frequency", "Solid: frequencies in rad/s for Hz", "fem.bodies.leg_modes.modes"
)
def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


@fault(
    "ends.no-reaction",
    "Free ends: the root's reaction left out",
    "fem.couplings.end_coupling.FreeEnds.equilibrated",
)
@fault(
    "ends.loose-root",
    "Free ends: rigid motion of the root not taken off",
    "fem.couplings.end_coupling.FreeEnds.expanded",
)
def _unchanged(_ends: Any, field: Array) -> Array:
    return np.asarray(field)


@fault_around(
    "doubling.half-of-slices",
    "Doubling: half of the slices left out",
    "fem.bodies.doubling.condensed_leg",
)
def _half_slices(sound: Faulty, leg: Any, section: Any, slices: int) -> Any:
    shorter = replace(leg, length=leg.length * (slices // 2) / slices)
    return sound(shorter, section, slices // 2)


@fault_around(
    "doubling.lever-forgotten",
    "Doubling: compliances added without moving them to the common middle",
    "fem.bodies.doubling.doubled",
)
def _unmoved(sound: Faulty, piece: Any) -> Any:
    found = sound(piece)
    return replace(found, compliance=2.0 * piece.compliance)


@fault_around(
    "doubling.mirror-sign",
    "Doubling: signs of mirrored deformations exchanged",
    "fem.bodies.doubling.doubled",
)
def _wrong_mirror(sound: Faulty, piece: Any) -> Any:
    return sound(replace(piece, mirror=-piece.mirror))


def _swapped(name: str) -> Any:
    def change(constants: Any) -> Any:
        return replace(constants, **{name: getattr(constants, name)[::-1]})

    return change


@fault_in_value(
    "constants.polar-torsion",
    "Section mesh: torsion without warping, J = Ip",
    "fem.sections.section_constants.constants_of",
)
def _polar(constants: Any) -> Any:
    return replace(
        constants, torsion_constant=constants.second_moment_y + constants.second_moment_z
    )


@fault_around(
    "doubling.ends-held",
    "Doubling: free ends computed with rigid ends",
    "fem.bodies.doubling.tip_compliance",
)
def _free_as_rigid(sound: Faulty, condensed: Any, _ends: str = "rigid") -> Array:
    found: Array = sound(condensed, "rigid")
    return found


@fault_in_value(
    "solid.coupling-halved",
    "Solid: coupling terms of the compliance halved",
    "fem.bodies.solid.tip_compliance",
)
def _half_tip(compliance: Array) -> Array:
    return 0.5 * (compliance + np.diag(np.diag(compliance)))


@fault_around("solid.half-mass", "Solid: half the mass", "fem.bodies.solid.clamped_leg")
def _massless_tip(sound: Faulty, solid: SolidLeg, ends: Any = "rigid") -> ClampedLeg:
    found: ClampedLeg = sound(replace(solid, mass=csr_array(0.5 * solid.mass)), ends)
    return found


fault_in_value(
    "constants.shear-swapped",
    "Shear coefficients of the section mesh along the wrong axes",
    "fem.sections.section_constants.constants_of",
)(_swapped("shear_coefficients"))
fault(
    "constants.poisson-ratio",
    "ν for νG/E in Saint-Venant's flexure",
    "fem.sections.section_constants.poisson_shear_ratio",
)(lambda nu, _shear_to_young=None: nu)
