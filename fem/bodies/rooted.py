"""A solid with any number of interfaces, held at its first: what statics, modes and reduction need.

The rigid motions are taken off by the first interface's twist, P = I − R̂B₀ᵀ: six springs on single
unknowns make K̂ positive definite, and loads in equilibrium leave them without force. With the unit
wrenches B at the other interfaces, U = P(K̂ + springs)⁻¹Pᵀ B and C = BᵀU: their compliance. Then
Ψ = U C⁻¹ are the displacements for unit twists with the first held, and what all twists held leave
of the flexibility G is G − U C⁻¹Uᵀ for any number of them.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, qr

from fem.couplings.coupled_solid import CoupledSolid
from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.certificate import Pencil, count_below, pencil
from fem.solvers.factor import Inertia, RenewableFactor
from fem.solvers.modes import CertifiedModes, lowest_modes, searched_modes
from fem.solvers.spaces import space_of
from lumped.arrays import Array, IntArray, fix_signs
from lumped.dense.statics import balanced_flexibility
from lumped.errors import ComputationError
from lumped.screws import shift


@dataclass(frozen=True, eq=False)
class _Rooting:
    """Projection P on what moves with the first interface held, in one memory.

    `motions` R̂ (n×6), `rows` of the unknowns that wrenches at the interface act on, and `wrenches`
    B₀ there.
    """

    motions: Any
    rows: Any
    wrenches: Any

    def expanded(self, x: Any) -> Any:
        """P x."""
        return x - self.motions @ (self.wrenches.T @ x[self.rows])

    def equilibrated(self, forces: Any) -> Any:
        """Pᵀf."""
        balanced = forces.copy()
        balanced[self.rows] -= self.wrenches @ (self.motions.T @ forces)
        return balanced

    def copy_to(self, space: Space) -> "_Rooting":
        """Copy of the projection in another memory."""
        return _Rooting(*map(space.put, (self.motions, self.rows, self.wrenches)))


@dataclass(frozen=True, eq=False)
class RootedBody:
    """A coupled solid held at its first interface, factorised; `name` in errors.

    `pencil`: its stiffness and mass, with springs on six unknowns; `factor` of the former. Forces
    and displacements are in the host's memory, or in that of a graphics card which has the factor.
    """

    name: str
    solid: CoupledSolid
    pencil: Pencil
    factor: RenewableFactor

    @property
    def root(self) -> Array:
        """B₀ (n×6)."""
        return self.solid.twists[:, :6]

    @property
    def loads(self) -> Array:
        """B (n×6(m−1)): unit wrenches at the other interfaces."""
        return self.solid.twists[:, 6:]

    @property
    def space(self) -> Space:
        """Memory in which forces need no transfer."""
        return self.pencil.symbolic.space

    def expanded(self, x: Any) -> Any:
        """P x: the same deformation with the first interface where it was."""
        return self._rooting(x).expanded(x)

    def equilibrated(self, forces: Any) -> Any:
        """Pᵀf: forces together with the reaction of the first interface."""
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
        """Displacement x (n×k) under forces (n×k) with the first interface held."""
        flat = forces.reshape(len(forces), -1)
        return self.expanded(self.factor.solve(self.equilibrated(flat))).reshape(forces.shape)

    @cached_property
    def response(self) -> Array:
        """U (n×6(m−1)) under unit wrenches at the other interfaces."""
        return np.asarray(self.flexibility(self.loads))

    @cached_property
    def compliance(self) -> Array:
        """C (6(m−1) × 6(m−1), SI, body axes) of the other interfaces, the first clamped.

        Raises ComputationError where rounding leaves too little of it.
        """
        forces = self.solid.stiffness @ self.response
        return balanced_flexibility(self.equilibrated(self.loads), self.response, forces, self.name)

    @cached_property
    def relative(self) -> Array:
        """Twists of the other interfaces less the rigid motion of the first: [−X I]."""
        points = self.solid.points
        carried = [shift(point - points[0]) for point in points[1:]]
        X = np.vstack(carried) if carried else np.zeros((0, 6))
        return np.hstack([-X, np.eye(len(X))])

    @property
    def stiffness(self) -> Array:
        """6m×6m stiffness between the interfaces: exact rigid motions, symmetric."""
        if not len(self.compliance):
            return np.zeros((6, 6))
        inner = cho_solve(cho_factor(self.compliance), self.relative)
        K = self.relative.T @ inner
        return np.asarray((K + K.T) / 2.0)

    @cached_property
    def constraint_modes(self) -> Array:
        """Ψ (n×6m): x for unit twists of all interfaces."""
        if not len(self.compliance):
            return self.solid.motions
        tips = cho_solve(cho_factor(self.compliance), self.response.T).T
        return np.hstack([self.solid.motions + tips @ self.relative[:, :6], tips])

    @property
    def condensed_mass(self) -> Array:
        """6m×6m mass ΨᵀMΨ (Guyan, 1965)."""
        modes = self.constraint_modes
        M = modes.T @ (self.solid.mass @ modes)
        return np.asarray((M + M.T) / 2.0)

    def held_flexibility(self, forces: Any) -> Any:
        """Displacement x (n×k) under forces (n×k) with the twists of all interfaces held."""
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
        """The lowest `count` modes with the first interface clamped, the others free; on u.

        The count by fem.solvers.certificate proves that none is missing. The factor is released
        for it until it is needed again. Raises errors like `fem.solvers.modes.lowest_modes`.
        """

        def counted(sigma: float) -> Inertia:
            self.factor.give_up()
            return self.rooted_inertia(sigma)

        mass, space = self.solid.mass, self.space
        modes = lowest_modes(self.flexibility, mass, count, counted, self.name, space)
        shapes = self.solid.transformation @ modes.shapes
        return replace(modes, shapes=fix_signs(shapes))

    def uncounted_frequencies(self, count: int) -> Array:
        """Frequencies (Hz) of `modes` from the search, without proof that none is missing."""
        mass, space = self.solid.mass, self.space
        return searched_modes(self.flexibility, mass, count, self.name, space).frequencies

    def held_inertia(self, sigma: float) -> Inertia:
        """Inertia of K − σM (σ in rad²/s²) on motions with all interfaces held."""
        return self._inertia(sigma, self.solid.twists)

    def free_inertia(self, sigma: float) -> Inertia:
        """Inertia of K − σM (σ in rad²/s²) of the free body, including the six rigid motions."""
        return self._inertia(sigma, None)

    def rooted_inertia(self, sigma: float) -> Inertia:
        """Inertia of K − σM (σ in rad²/s²) on motions with the first interface clamped."""
        return self._inertia(sigma, self.root)

    def _inertia(self, sigma: float, held: Array | None) -> Inertia:
        """Inertia of K − σM on x with Bᵀx = 0, B (n×6k) wrenches of held interfaces, or all x."""
        solid, constraints = self.solid, None
        if held is not None:
            # Forces and moments of one size, so that no twist looks like rounding beside another.
            size = float(np.ptp(solid.places, axis=0).max())
            constraints = held * np.tile([1.0, 1.0, 1.0, size, size, size], held.shape[1] // 6)
        return count_below(self.pencil, sigma, constraints, self.factor)


def rooted_body(solid: CoupledSolid, name: str) -> RootedBody:
    """Hold a coupled solid at its first interface and factorise it.

    Raises ComputationError where it cannot be held or memory will not suffice.
    """
    held = _statically_determinate(solid, name)
    springs = np.zeros(solid.size)
    # Of the size of a node's own stiffness, so that the matrix is no worse conditioned for them.
    springs[held] = solid.stiffness.diagonal()[held]
    sprung = pencil(solid.stiffness, solid.mass, springs)
    factor = RenewableFactor(sprung.symbolic, name)
    # At once, so that a part which cannot be held is refused here.
    _ = factor.numeric
    return RootedBody(name, solid, sprung, factor)


def _statically_determinate(solid: CoupledSolid, name: str) -> IntArray:
    """Six unknowns of nodes that hold every rigid motion, as far apart as can be.

    Springs at a rigid root itself would leave a digit less of a leg 87 diameters long.
    """
    first_node_unknown = solid.size - 3 * len(solid.places)
    size = float(np.ptp(solid.places, axis=0).max())
    scaled = solid.motions[first_node_unknown:] * np.repeat([1.0, 1.0 / size], [3, 3])
    _, triangle, order = qr(scaled.T, mode="economic", pivoting=True)
    if abs(triangle[5, 5]) <= 1e-9 * abs(triangle[0, 0]):
        raise ComputationError(f"{name}: its nodes lie on one line")
    return np.sort(first_node_unknown + order[:6])
