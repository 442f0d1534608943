"""Mistakes in legs reduced to their ends, in robots of them, and in their postures."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from fem.reduction.superelement import ENDS, HeldLeg, Superelement
from fem.sweep import PostureModel
from lumped.arrays import Array
from lumped.biglide_assembly import Mechanism
from lumped.modes import Modes
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_in_value(
    "superelement.inner-sign",
    "Constraint modes with the wrong sign inside: +K_ii⁻¹ K_ie",
    "fem.reduction.superelement.held_leg",
)
def _other_sign_inside(held: HeldLeg) -> HeldLeg:
    modes = held.constraint_modes.copy()
    modes[ENDS:] *= -1.0
    return replace(held, constraint_modes=modes)


@fault_around(
    "superelement.lever-arm",
    "Condensed leg: lever arm from tip to root with the wrong sign",
    "fem.reduction.superelement.ends_stiffness",
)
def _lever_to_root(sound: Faulty, tip_stiffness: Array, length: float) -> Array:
    found: Array = sound(tip_stiffness, -length)
    return found


@fault(
    "superelement.recovery",
    "Displacements recovered from the ends alone, modal amplitudes forgotten",
    "fem.reduction.superelement.Superelement.recover",
)
def _ends_alone(leg: Superelement, unknowns: Array) -> Array:
    return np.asarray(leg.recovery[:, :ENDS] @ unknowns[:ENDS])


def _reduced_with(change: Any) -> Any:
    def changed(
        sound: Faulty, held: HeldLeg, recovery: Array, stiffness: Array, mass: Array
    ) -> Any:
        return sound(held, recovery, *change(stiffness.copy(), mass.copy()))

    return changed


def _uncoupled(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    mass[:ENDS, ENDS:] = mass[ENDS:, :ENDS] = 0.0
    return stiffness, mass


def _ends_uncoupled(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    mass[:6, 6:ENDS] = mass[6:ENDS, :6] = 0.0
    return stiffness, mass


def _squared_hertz(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    stiffness[ENDS:, ENDS:] /= (2.0 * np.pi) ** 2
    return stiffness, mass


@fault_around(
    "reduction.cutoff",
    "Fixed-interface modes cut off at a fifth of the frequency",
    "fem.reduction.interface_modes.interface_modes",
)
def _cut_low(sound: Faulty, held: HeldLeg, cutoff: float) -> Modes:
    found: Modes = sound(held, cutoff / 5.0)
    return found


@fault_in_value(
    "reduction.modes-missing",
    "Every second fixed-interface mode left out (one of two alike planes)",
    "fem.reduction.interface_modes.interface_modes",
)
def _every_second(modes: Modes) -> Modes:
    return Modes(modes.frequencies[::2], modes.shapes[:, ::2])


@fault_in_value(
    "reduction.mode-norm",
    "Fixed-interface modes of unit displacement instead of unit mass",
    "fem.reduction.interface_modes.interface_modes",
)
def _unit_displacement(modes: Modes) -> Modes:
    return Modes(modes.frequencies, modes.shapes / np.abs(modes.shapes).max(axis=0))


@fault_in_value(
    "reduction.no-residual",
    "Static response of the dropped modes left out",
    "fem.reduction.craig_bampton._residual_modes",
)
def _none_residual(found: tuple[Modes, Array]) -> tuple[Modes, Array]:
    modes, truncated = found
    return Modes(modes.frequencies[:0], modes.shapes[:, :0]), truncated


@fault_in_value(
    "reduction.bound",
    "Bound of the reduction's error without the dropped modes",
    "fem.reduction.craig_bampton._residual_modes",
)
def _nothing_dropped(found: tuple[Modes, Array]) -> tuple[Modes, Array]:
    modes, truncated = found
    return modes, 0.0 * truncated


@fault_in_value(
    "free-superelement.wrong-face",
    "Free ends: constraint modes of root and tip exchanged",
    "fem.reduction.free_superelement.held_free_leg",
)
def _wrong_face(held: HeldLeg) -> HeldLeg:
    modes = held.constraint_modes
    return replace(held, constraint_modes=np.hstack([modes[:, 6:], modes[:, :6]]))


@fault_in_value(
    "free-superelement.root-rigid",
    "Free ends: the root moves, the tip goes along as a rigid body",
    "fem.reduction.free_superelement.held_free_leg",
)
def _root_without_tip(held: HeldLeg) -> HeldLeg:
    """Constraint modes of the root: rigid motions, the tip not held."""
    modes = held.constraint_modes.copy()
    to_tip = np.eye(6)
    to_tip[1, 5], to_tip[2, 4] = held.length, -held.length
    modes[:, :6] += modes[:, 6:] @ to_tip
    return replace(held, constraint_modes=modes)


@fault_in_value(
    "free-superelement.tip-loose",
    "Free ends: modes of the inside with the root held alone",
    "fem.reduction.free_superelement.held_free_leg",
)
def _tip_loose(held: HeldLeg) -> HeldLeg:
    """Response to forces with the root held alone."""
    tip = held.constraint_modes[:, 6:]
    compliance = np.linalg.inv(held.stiffness[6:, 6:])

    def flexibility(forces: Array) -> Array:
        found: Array = held.flexibility(forces) + tip @ (compliance @ (tip.T @ forces))
        return found

    return replace(held, flexibility=flexibility)


@fault_around(
    "sweep.not-turned",
    "Sweep: legs left in the posture of the centre",
    "fem.sweep.PostureModel.matrices",
)
def _always_centre(sound: Faulty, model: PostureModel, _x: float) -> Any:
    return sound(model, model.robot.centre)


@fault_around(
    "sweep.rotation-transposed",
    "Sweep: rotation of the ends transposed",
    "fem.sweep._TurningLeg.add",
)
def _turned_back(sound: Faulty, leg: Any, rotation: Array, totals: Any) -> None:
    sound(leg, rotation.T, totals)


@fault_around(
    "sweep.coupling-not-turned",
    "Sweep: coupling of the ends with the inside not turned with the leg",
    "fem.sweep._TurningLeg.add",
)
def _coupling_not_turned(sound: Faulty, leg: Any, rotation: Array, totals: Any) -> None:
    own = tuple((ends, np.zeros_like(coupling)) for ends, coupling in leg.matrices)
    sound(replace(leg, matrices=own), rotation, totals)
    for (_, coupling), total in zip(leg.matrices, totals, strict=True):
        border = coupling[leg.free]
        total[np.ix_(leg.ends, leg.inner)] += border
        total[np.ix_(leg.inner, leg.ends)] += border.T


@fault_in_value(
    "sweep.platform-missing", "Sweep: mass of the platform forgotten", "fem.sweep.posture_model"
)
def _without_platform(model: PostureModel) -> PostureModel:
    platform = np.diag([model.robot.platform_mass] * 3 + [0.0] * 3)
    return replace(model, mass=model.mass - model.loaded.T @ platform @ model.loaded)


@fault_around(
    "sweep.leg-one-twice", "Sweep: matrices of leg 1 used for leg 2", "fem.sweep.posture_model"
)
def _same_leg(sound: Faulty, robot: Any, leg1: Any, _leg2: Any, *rest: Any) -> Any:
    return sound(robot, leg1, leg1, *rest)


@fault_in_value("sweep.angular-frequency", "Sweep: frequencies in rad/s for Hz", "fem.sweep._modes")
@fault_in_value(
    "robot-solid.angular-frequency",
    "Robot of solids: frequencies in rad/s for Hz",
    "fem.robot_solid.modes",
)
def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


@fault_in_value(
    "robot-solid.diagonal",
    "Robot of solids: coupling terms of the compliance lost",
    "fem.robot_solid.compliance",
)
def _diagonal(compliance: Array) -> Array:
    return np.diag(np.diag(compliance))


@fault_around(
    "robot-solid.lumped-mass",
    "Robot of solids: row sums for the consistent mass",
    "fem.robot_solid.factorised_robot",
)
def _row_sums(sound: Faulty, mechanism: Mechanism) -> Any:
    """Mass of the interiors in row sums."""
    mass = csr_array(mechanism.mass).tolil()
    sums = np.asarray(csr_array(mechanism.mass).sum(axis=1)).ravel()
    inner = sum(to_leg.shape[0] - ENDS for to_leg in mechanism.legs)
    first = mass.shape[0] - inner
    mass[first:, first:] = 0.0
    mass.setdiag(np.where(np.arange(mass.shape[0]) < first, mass.diagonal(), np.abs(sums)))
    return sound(replace(mechanism, mass=csr_array(mass)))


fault_around(
    "reduction.coupling-mass",
    "Craig–Bampton: mass that couples the ends with the modes forgotten",
    "fem.reduction.superelement.reduced",
)(_reduced_with(_uncoupled))
fault_around(
    "reduction.ends-uncoupled",
    "Craig–Bampton: mass that couples root and tip forgotten",
    "fem.reduction.superelement.reduced",
)(_reduced_with(_ends_uncoupled))
fault_around(
    "reduction.squared-hertz",
    "Craig–Bampton: f² for ω² as stiffness of the modes",
    "fem.reduction.superelement.reduced",
)(_reduced_with(_squared_hertz))
