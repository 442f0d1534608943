"""A leg reduced to its two ends: constraint modes, static condensation, recovery.

Between postures a leg only rotates. It is therefore reduced once, in leg axes. All models and both
end conditions provide the same data for a reduction: displacements for unit twists of the ends (Ψ),
the response to forces with both ends fixed (A), and the mass (M).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from fem.bodies.rooted import RootedBody
from fem.bodies.solid import centreline_of, line_of
from fem.reduction.held import Held, held_body
from fem.solvers.factor import Factor, analyse
from lumped.arrays import Array, SparseMatrix, symmetric
from lumped.centre_line import CentreLine
from lumped.dense.statics import ELIMINATION, balanced_flexibility, rounding_of_flexibility
from lumped.errors import ComputationError
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import shift
from meshes.solid_mesh import SolidMesh

ENDS = 12

# Largest force that a rigid motion of an unsupported leg causes, relative to its stiffness.
# Round-off causes 1e-10 to 1e-6, depending on mesh and slenderness. A support that changes the
# fourth digit of results causes more than this.
_GROUNDED = 1e-4


@dataclass(frozen=True, eq=False, kw_only=True)
class HeldLeg(Held):
    """A leg whose two ends are fixed, with the response to twists of these ends. Leg axes.

    The leg has n unknowns u. `model` is the name of its model, `length` (m) its length.
    `centreline`, `line` and `parts` are explained in `LegMatrices` and refer to u. Modes are not
    counted: legs are slender, and their modes are those of beams.
    """

    model: str
    length: float
    centreline: Callable[[Array], SparseMatrix]
    parts: Mapping[str, SparseMatrix] = field(default_factory=dict)
    line: CentreLine | None = None


@dataclass(frozen=True, eq=False)
class Superelement:
    """A reduced leg: `matrices` on unknowns q (r), and the matrix `recovery` to all displacements.

    The unknowns are the twists of root (6) and tip (6), then modal amplitudes. The displacements of
    the n unknowns before the reduction are u = `recovery` q (n×r).
    """

    matrices: LegMatrices
    recovery: Array

    def recover(self, unknowns: Array) -> Array:
        """Displacements (n or n×k) of the unreduced leg from `unknowns` q (r or r×k)."""
        return np.asarray(self.recovery @ unknowns)


def end_motions(length: float) -> Array:
    """Twists of root and tip (12×6, leg axes) in six rigid motions of a leg of `length` (m)."""
    return np.vstack([np.eye(6), shift(np.array([length, 0.0, 0.0]))])


def ends_stiffness(tip_stiffness: Array, length: float) -> Array:
    """Stiffness Bᵀ S B (12×12) of both ends, from the tip stiffness S (6×6) with clamped root.

    `length` (m) is that of the leg. B = [−X I] gives the twist of the tip relative to the rigid
    motion of the leg with its root. With B, equilibrium and the six rigid motions are exact to
    round-off for any mesh.
    """
    relative = np.hstack([-shift(np.array([length, 0.0, 0.0])), np.eye(6)])
    return symmetric(relative.T @ tip_stiffness @ relative)


def held_leg(leg: LegMatrices) -> HeldLeg:
    """Fix both ends of a leg of any model, by one sparse factorisation and twelve solutions.

    Raises ComputationError if a part of the leg is not connected to its ends, or if the leg is
    supported anywhere else.
    """
    stiffness, mass = csr_array(leg.stiffness), csr_array(leg.mass)
    coupling = stiffness[ENDS:, :ENDS].toarray()
    modes = np.vstack([np.eye(ENDS), np.zeros((leg.size - ENDS, ENDS))])
    factor = _interior_factor(leg.model, stiffness[ENDS:, ENDS:])
    if factor is not None:
        modes[ENDS:] = -factor.solve(coupling)
        _refuse_unbalanced(leg, stiffness, modes)
    condensed = stiffness[:ENDS, :ENDS].toarray() + coupling.T @ modes[ENDS:]
    _refuse_grounded(leg, condensed, stiffness, modes)

    def flexibility(forces: Array) -> Array:
        displacement = np.zeros_like(forces)
        if factor is not None:
            displacement[ENDS:] = factor.solve(forces[ENDS:])
        return displacement

    return HeldLeg(
        state=f"{leg.model} leg, both ends held",
        model=leg.model,
        length=leg.length,
        constraint_modes=modes,
        stiffness=ends_stiffness(condensed[6:, 6:], leg.length),
        flexibility=flexibility,
        mass=mass,
        centreline=leg.centreline,
        parts=leg.parts,
        line=leg.line,
    )


def held_solid_leg(clamped: RootedBody, mesh: SolidMesh) -> HeldLeg:
    """Fix both ends of a solid leg, for any end condition, on the unknowns of the solid.

    The motions of the centreline are means over sections. At free ends these differ from the twists
    of the ends because of warping.
    """
    fixed_body = held_body(clamped)
    return HeldLeg(
        state=fixed_body.state,
        model="solid",
        length=mesh.length,
        constraint_modes=fixed_body.constraint_modes,
        stiffness=fixed_body.stiffness,
        flexibility=fixed_body.flexibility,
        space=fixed_body.space,
        mass=fixed_body.mass,
        centreline=centreline_of(mesh, clamped.solid),
        line=line_of(mesh),
    )


def static_superelement(held: HeldLeg) -> Superelement:
    """Leg condensed to its two ends, with the mass ΨᵀMΨ (Guyan, 1965). Its statics are exact."""
    modes = held.constraint_modes
    return reduced(held, modes, held.stiffness, modes.T @ (held.mass @ modes))


def reduced(held: HeldLeg, recovery: Array, stiffness: Array, mass: Array) -> Superelement:
    """Superelement with u = `recovery` q (n×r) and given `stiffness` and `mass` (r×r)."""
    # The superelement must not refer to `held`, whose factor is many times as large.
    unreduced_centreline = held.centreline

    def centreline(stations: Array) -> SparseMatrix:
        return csr_array(unreduced_centreline(stations) @ recovery)

    parts = {
        kind: csr_array(symmetric(recovery.T @ (part @ recovery)))
        for kind, part in held.parts.items()
    }
    matrices = LegMatrices(
        model=f"{held.model}, reduced",
        length=held.length,
        line=held.line,
        stiffness=csr_array(symmetric(stiffness)),
        mass=csr_array(symmetric(mass)),
        centreline=centreline,
        parts=parts,
    )
    return Superelement(matrices, recovery)


def _interior_factor(model: str, stiffness: SparseMatrix) -> Factor | None:
    if stiffness.shape[0] == 0:
        return None
    return analyse(stiffness).factorise(f"{model} leg, both ends held")


def _refuse_unbalanced(leg: LegMatrices, stiffness: SparseMatrix, modes: Array) -> None:
    """Raise ComputationError if round-off dominates the stiffness between the ends.

    `modes` (n×12) are the static displacements for unit twists of the ends. The displacements under
    unit wrenches at the tip, with the root fixed, must have the strain energy given by the
    compliance of the tip.
    """
    tip = modes[:, 6:]
    of_tip = tip.T @ (stiffness @ tip)
    compliance = np.linalg.inv(of_tip)
    displacements = tip @ compliance
    loads = np.zeros_like(tip)
    loads[6:ENDS] = np.eye(6)
    forces = stiffness @ displacements
    # Forces at the root do no work, because the root is fixed.
    forces[:6] = 0.0
    balanced_flexibility(loads, displacements, forces, f"{leg.model} leg")


def _refuse_grounded(
    leg: LegMatrices, condensed: Array, stiffness: SparseMatrix, modes: Array
) -> None:
    # Rotations are multiplied by the length of the leg, so that all entries are N/m.
    unit = np.array([1.0, 1.0, 1.0, *[1.0 / leg.length] * 3])
    scale = np.tile(unit, 2)
    motions = end_motions(leg.length) * unit
    forces = np.abs(scale[:, None] * (condensed @ motions))
    sizes = np.sqrt(np.diag(scale[:, None] * condensed * scale))
    if (forces <= _GROUNDED * np.outer(sizes, sizes[:6])).all():
        return
    # Round-off may exceed `_GROUNDED` for long thin legs, and for legs with stiff next to soft
    # parts.
    rounding = rounding_of_flexibility(stiffness, modes * scale)
    if (forces > ELIMINATION * (rounding @ np.abs(motions / scale[:, None]))).any():
        raise ComputationError(
            f"{leg.model} leg: a rigid-body motion of the leg needs a force, so the leg is "
            "supported somewhere other than at its ends"
        )
