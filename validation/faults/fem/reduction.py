"""Mistakes in legs reduced to their ends, in robots of them, and in their postures."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from fem.reduction.held import FreeBody
from fem.reduction.superelement import ENDS, HeldLeg, Superelement
from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import Outside, System
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
def _cut_low(sound: Faulty, held: HeldLeg, cutoff: float, *search: int) -> Modes:
    found: Modes = sound(held, cutoff / 5.0, *search)
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
    "fem.reduction.residual_modes.residual_modes",
)
def _none_residual(found: tuple[Modes, Array]) -> tuple[Modes, Array]:
    modes, truncated = found
    return Modes(modes.frequencies[:0], modes.shapes[:, :0]), truncated


@fault_in_value(
    "reduction.bound",
    "Bound of the reduction's error without the dropped modes",
    "fem.reduction.residual_modes.residual_modes",
)
def _nothing_dropped(found: tuple[Modes, Array]) -> tuple[Modes, Array]:
    modes, truncated = found
    return modes, 0.0 * truncated


@fault_in_value(
    "free-reduction.hertz",
    "Modes of a free body, held at its interfaces: ω² in Hz²",
    "fem.reduction.free_interface._held",
)
def _in_hertz(found: tuple[Array, Array]) -> tuple[Array, Array]:
    amplitudes, squared = found
    return amplitudes, squared / (2.0 * np.pi) ** 2


@fault(
    "free-reduction.no-relief",
    "Flexibility of a free body without the inertia of its rigid motions",
    "fem.reduction.held.FreeBody.flexibility",
)
def _held_at_its_root(body: FreeBody, forces: Array) -> Array:
    return body.rooted.flexibility(forces)


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
    "Sweep: all postures taken for the first",
    "lumped.system.assembly.Assembly.outside",
)
def _first_for_all(sound: Faulty, self: Any, postures: Sequence[Posture]) -> Any:
    return sound(self, [postures[0]] * len(postures))


@fault_around(
    "sweep.coupling-not-turned",
    "Sweep: coupling of the ends with the inside not turned with the leg",
    "lumped.system.sweep._frequencies",
)
def _coupling_not_turned(sound: Faulty, outside: Outside, *rest: Any) -> Any:
    twists, structure = outside.motions.twists, outside.motions.structure
    ends = {}
    for name, rows in outside.ends.items():
        first = structure.node(name, next(iter(structure.mechanism.bodies[name].interfaces)))
        nodes = slice(first, first + rows.shape[1] // 6)
        ends[name] = twists[:, nodes].reshape(rows.shape)
    return sound(replace(outside, ends=ends), *rest)


@fault_in_value(
    "sweep.angular-frequency",
    "Sweep: frequencies in rad/s for Hz",
    "lumped.system.sweep._frequencies",
)
def _swept_angular(frequencies: Array) -> Array:
    return 2.0 * np.pi * frequencies


@fault_in_value(
    "robot-solid.angular-frequency",
    "Robot of solids: frequencies in rad/s for Hz",
    "fem.solvers.sparse_system.modes",
)
def _angular(modes: Modes) -> Modes:
    return replace(modes, frequencies=2.0 * np.pi * modes.frequencies)


@fault_in_value(
    "robot-solid.diagonal",
    "Robot of solids: coupling terms of the compliance lost",
    "fem.solvers.sparse_system.compliance",
)
def _diagonal(compliance: Array) -> Array:
    return np.diag(np.diag(compliance))


@fault_around(
    "robot-solid.lumped-mass",
    "Robot of solids: row sums for the consistent mass",
    "fem.solvers.sparse_system.factorised",
)
def _row_sums(sound: Faulty, system: System) -> Any:
    """Mass of the interiors in row sums."""
    mass = csr_array(system.mass).tolil()
    sums = np.asarray(csr_array(system.mass).sum(axis=1)).ravel()
    first = system.outer
    mass[first:, first:] = 0.0
    mass.setdiag(np.where(np.arange(mass.shape[0]) < first, mass.diagonal(), np.abs(sums)))
    return sound(replace(system, mass=csr_array(mass)))


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
