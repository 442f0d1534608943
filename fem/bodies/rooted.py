"""A solid with any number of interfaces, clamped at its first one.

The module provides the data for statics, modes and reduction. The matrix P = I − R̂B₀ᵀ subtracts
from displacements the rigid motion of the first interface, with the rigid motions R̂ of the solid
and the unit wrenches B₀ at this interface. Six springs on single unknowns make K̂ positive
definite; loads in equilibrium cause no force in these springs. The flexibility of the clamped solid
is G = P(K̂ + springs)⁻¹Pᵀ. With the unit wrenches B at the other interfaces, U = G B are the
displacements and C = BᵀU is the compliance. Then Ψ = U C⁻¹ are the displacements for unit twists of
the other interfaces with the first clamped. If all interfaces are fixed, the flexibility is G − U
C⁻¹Uᵀ.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, qr

from fem.couplings.coupled_solid import CoupledSolid
from fem.solvers.backends.cudss import space_of
from fem.solvers.backends.factor_checks import require_memory
from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.certificate import Pencil, count_below, pencil
from fem.solvers.factor import Inertia, RenewableFactor
from fem.solvers.inverse import RenewableIteration, inverse
from fem.solvers.modes import (
    CertifiedModes,
    lowest_modes,
    preconditioned_modes,
    searched_modes,
)
from lumped.arrays import Array, IntArray, fix_signs
from lumped.dense.statics import balanced_flexibility
from lumped.errors import ComputationError
from lumped.screws import shift


@dataclass(frozen=True, eq=False)
class _Rooting:
    """Projection P to displacements with the first interface clamped.

    `motions` are the rigid motions R̂ (n×6), `rows` the indices of the unknowns on which wrenches
    at the first interface act, and `wrenches` the rows of the unit wrenches B₀ for these unknowns.
    All arrays are in the memory of the host or all on a graphics card.
    """

    motions: Any
    rows: Any
    wrenches: Any

    def expanded(self, x: Any) -> Any:
        """Displacements P x: those of `x` (n×k) minus the rigid motion of the first interface."""
        return x - self.motions @ (self.wrenches.T @ x[self.rows])

    def equilibrated(self, forces: Any) -> Any:
        """Sum of the forces (n×k) and of the reaction at the first interface that balances them."""
        balanced = forces.copy()
        balanced[self.rows] -= self.wrenches @ (self.motions.T @ forces)
        return balanced

    def copy_to(self, space: Space) -> "_Rooting":
        """Copy of the projection in the memory `space`."""
        return _Rooting(*map(space.put, (self.motions, self.rows, self.wrenches)))


@dataclass(frozen=True, eq=False)
class RootedBody:
    """A solid coupled to its interfaces, clamped at the first one, with factorised stiffness.

    `name` is used in messages. `pencil` contains stiffness and mass, with springs on six unknowns.
    `factor` is the factor of the stiffness, or an iterative solver if the factor does not fit the
    memory. Forces and displacements are in the memory of the host, or of a graphics card if the
    factor is stored there.
    """

    name: str
    solid: CoupledSolid
    pencil: Pencil
    factor: RenewableFactor

    @property
    def root(self) -> Array:
        """Forces (n×6) on the n unknowns for unit wrenches at the first interface."""
        return self.solid.twists[:, :6]

    @property
    def loads(self) -> Array:
        """Forces (n×6(m−1)) for unit wrenches at all m interfaces but the first."""
        return self.solid.twists[:, 6:]

    @property
    def space(self) -> Space:
        """Memory (host or graphics card) in which forces are used without a copy."""
        return self.factor.space

    @property
    def countable(self) -> bool:
        """True if eigenvalues can be counted: a factor of K − σM fits in memory."""
        return self.factor.countable

    def require_count(self) -> None:
        """Raise ComputationError if no factor fits the memory: modes cannot be counted then."""
        if not self.countable:
            require_memory(self.pencil.symbolic.peak_bytes, self.solid.size, self.name)

    def expanded(self, x: Any) -> Any:
        """Displacements `x` (n×k) minus the rigid motion of the first interface in them."""
        return self._rooting(x).expanded(x)

    def equilibrated(self, forces: Any) -> Any:
        """Sum of the forces (n×k) and of the reaction at the first interface that balances them."""
        return self._rooting(forces).equilibrated(forces)

    def _rooting(self, array: Any) -> _Rooting:
        return self._rooting_on_host if space_of(array) is HOST else self._rooting_on_device

    @cached_property
    def _rooting_on_host(self) -> _Rooting:
        rows = np.flatnonzero(self.root.any(axis=1))
        return _Rooting(self.solid.motions, rows, self.root[rows])

    @cached_property
    def _rooting_on_device(self) -> _Rooting:
        return self._rooting_on_host.copy_to(self.space)

    def flexibility(self, forces: Any) -> Any:
        """Displacements (n×k) under `forces` (n×k) with the first interface clamped."""
        flat = forces.reshape(len(forces), -1)
        return self.expanded(self.factor.solve(self.equilibrated(flat))).reshape(forces.shape)

    @cached_property
    def response(self) -> Array:
        """Displacements (n×6(m−1)) under unit wrenches at all m interfaces but the first."""
        return np.asarray(self.flexibility(self.loads))

    @cached_property
    def compliance(self) -> Array:
        """Compliance C (6(m−1) × 6(m−1), SI, body axes) of m interfaces.

        The first interface is clamped and has no compliance. Raises ComputationError if round-off
        dominates.
        """
        forces = self.solid.stiffness @ self.response
        return balanced_flexibility(self.equilibrated(self.loads), self.response, forces, self.name)

    @cached_property
    def relative(self) -> Array:
        """Matrix [−X I] (6(m−1) × 6m) from the twists of the m interfaces to m − 1 relative twists.

        The relative twists are the twists of all interfaces but the first, minus their twists in
        the rigid motion of the body with the first interface.
        """
        points = self.solid.points
        carried = [shift(point - points[0]) for point in points[1:]]
        X = np.vstack(carried) if carried else np.zeros((0, 6))
        return np.hstack([-X, np.eye(len(X))])

    @property
    def stiffness(self) -> Array:
        """Stiffness (6m×6m, SI, body axes) between the interfaces, with exact rigid motions."""
        if not len(self.compliance):
            return np.zeros((6, 6))
        inner = cho_solve(cho_factor(self.compliance), self.relative)
        K = self.relative.T @ inner
        return np.asarray((K + K.T) / 2.0)

    @cached_property
    def constraint_modes(self) -> Array:
        """Static displacements (n×6m) for unit twists of the m interfaces."""
        if not len(self.compliance):
            return self.solid.motions
        tips = cho_solve(cho_factor(self.compliance), self.response.T).T
        return np.hstack([self.solid.motions + tips @ self.relative[:, :6], tips])

    @property
    def condensed_mass(self) -> Array:
        """Mass matrix ΨᵀMΨ (6m×6m, SI, body axes) on the twists of the interfaces (Guyan, 1965)."""
        modes = self.constraint_modes
        M = modes.T @ (self.solid.mass @ modes)
        return np.asarray((M + M.T) / 2.0)

    def held_flexibility(self, forces: Any) -> Any:
        """Displacements (n×k) under `forces` (n×k) with all interfaces fixed."""
        free = self.flexibility(forces)
        if not len(self.compliance):
            return free
        space = space_of(forces)
        response = self.response if space is HOST else self._response_on_device
        twists = space.get(response.T @ forces)
        return free - response @ space.put(cho_solve(cho_factor(self.compliance), twists))

    @cached_property
    def _response_on_device(self) -> Any:
        return self.space.put(self.response)

    def modes(self, count: int) -> CertifiedModes:
        """The lowest `count` modes with the first interface clamped and the other interfaces free.

        Shapes are displacements u of the nodes. A count of eigenvalues (`fem.solvers.certificate`)
        proves that none is missing. For the count the factor is released and recomputed later.
        Raises ComputationError if no factor for the count fits the memory, and errors as
        `fem.solvers.modes.lowest_modes` does.
        """

        def counted(sigma: float) -> Inertia:
            self.factor.give_up()
            return self.rooted_inertia(sigma)

        mass, space = self.solid.mass, self.space
        self.require_count()
        modes = lowest_modes(self.flexibility, mass, count, counted, self.name, space)
        shapes = self.solid.transformation @ modes.shapes
        return replace(modes, shapes=fix_signs(shapes))

    def uncounted_frequencies(self, count: int) -> Array:
        """Frequencies (Hz) of the lowest `count` modes, without the proof that none is missing.

        The first interface is clamped, the other interfaces are free.
        """
        mass, factor = self.solid.mass, self.factor
        if isinstance(factor, RenewableIteration):

            def precondition(forces: Array) -> Array:
                return np.asarray(self.expanded(factor.precondition(self.equilibrated(forces))))

            K, solve = self.solid.stiffness, self.flexibility
            modes = preconditioned_modes(K, mass, precondition, solve, count, self.name)
            return modes.frequencies
        return searched_modes(self.flexibility, mass, count, self.name, self.space).frequencies

    def held_inertia(self, sigma: float) -> Inertia:
        """Numbers of negative, zero and positive eigenvalues of K − σM, with all interfaces fixed.

        `sigma` is σ in rad²/s².
        """
        return self._inertia(sigma, self.solid.twists)

    def free_inertia(self, sigma: float) -> Inertia:
        """Numbers of negative, zero and positive eigenvalues of K − σM, for the free body.

        Its six rigid motions are included. `sigma` is σ in rad²/s².
        """
        return self._inertia(sigma, None)

    def rooted_inertia(self, sigma: float) -> Inertia:
        """Numbers of negative, zero and positive eigenvalues of K − σM.

        The first interface is clamped, and the other interfaces are free. `sigma` is σ in rad²/s².
        """
        return self._inertia(sigma, self.root)

    def _inertia(self, sigma: float, held: Array | None) -> Inertia:
        """Numbers of negative, zero and positive eigenvalues of K − σM.

        `sigma` is σ (rad²/s²). Only displacements x with Bᵀx = 0 are admissible. `held` (n×6k) is
        B, the unit wrenches at k fixed interfaces. None if all displacements are admissible.
        """
        solid, constraints = self.solid, None
        if held is not None:
            # Scaled so that forces and moments are comparable, and none is lost in round-off.
            size = float(np.ptp(solid.places, axis=0).max())
            constraints = held * np.tile([1.0, 1.0, 1.0, size, size, size], held.shape[1] // 6)
        return count_below(self.pencil, sigma, constraints, self.factor)


def rooted_body(solid: CoupledSolid, name: str) -> RootedBody:
    """Clamp a coupled solid at its first interface and factorise its stiffness.

    `name` is used in messages. Raises ComputationError if the solid cannot be clamped or the memory
    is insufficient.
    """
    supported = _statically_determinate(solid, name)
    springs = np.zeros(solid.size)
    # The springs are as stiff as the node to which they are attached, so that the condition of the
    # matrix does not deteriorate.
    springs[supported] = solid.stiffness.diagonal()[supported]
    sprung = pencil(solid.stiffness, solid.mass, springs)
    # The factor is computed at once, so that a part that cannot be clamped is refused here.
    factor = inverse(sprung.symbolic, solid.motions, _places(solid), name)
    return RootedBody(name, solid, sprung, factor)


def _places(solid: CoupledSolid) -> Array:
    """Positions (n×3, in m) of the unknowns: first those of interfaces, then those of nodes."""
    count = solid.size - 3 * len(solid.places)
    shares = np.abs(solid.twists[:count]).reshape(count, solid.twists.shape[1] // 6, 6).sum(axis=2)
    return np.vstack([solid.points[shares.argmax(axis=1)], np.repeat(solid.places, 3, axis=0)])


def _statically_determinate(solid: CoupledSolid, name: str) -> IntArray:
    """Indices of six unknowns of nodes that prevent all rigid motions, as far apart as possible.

    Springs act on these unknowns. With springs at a rigid root instead, the results for a leg 87
    diameters long would lose one digit. Raises ComputationError, with `name` in its message, if all
    nodes lie on a straight line.
    """
    first_node_unknown = solid.size - 3 * len(solid.places)
    size = float(np.ptp(solid.places, axis=0).max())
    scaled = solid.motions[first_node_unknown:] * np.repeat([1.0, 1.0 / size], [3, 3])
    _, triangle, order = qr(scaled.T, mode="economic", pivoting=True)
    if abs(triangle[5, 5]) <= 1e-9 * abs(triangle[0, 0]):
        raise ComputationError(f"{name}: all nodes of the mesh lie on a straight line")
    return np.sort(first_node_unknown + order[:6])
