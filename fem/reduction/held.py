"""Data of a held or free body for its reduction, and residual modes of the dropped ones.

Residual modes are the static response of the dropped modes to forces F: Z = A F minus its share of
the retained modes is Σ φ_k pᵀ/λ_k over the dropped ones, p = Fᵀφ_k. The bound on their effect,
W = (MZ)ᵀ A (MZ) = Σ p pᵀ/λ_k³, is known without them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from fem.bodies.rooted import RootedBody
from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.factor import Inertia
from fem.solvers.spaces import space_of
from lumped.arrays import Array, SparseMatrix, fix_signs
from lumped.dense.modes import Modes

# Residual modes with less than this of the forces' work are rounding error.
_NO_RESIDUAL = 1e-11


@dataclass(frozen=True, eq=False, kw_only=True)
class Swinging:
    """A body of n unknowns u that swings, held or free of everything.

    `state`: what errors call it, and how it is held; `flexibility`: displacement (n×k) under
    forces (n×k), symmetric and positive semidefinite; `mass` (n×n). `inertia`: from σ (rad²/s²) to
    the signs of the eigenvalues of K − σM, those of rigid motions left out; None where these are
    not counted. `space`: the memory in which forces need no transfer.
    """

    state: str
    flexibility: Callable[[Any], Any]
    mass: SparseMatrix
    inertia: Callable[[float], Inertia] | None = None
    space: Callable[[], Space] = lambda: HOST

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.mass.shape[0])


@dataclass(frozen=True, eq=False, kw_only=True)
class Held(Swinging):
    """A body with the twists of its interfaces held, and what these twists do themselves.

    `constraint_modes` Ψ (n×6m): static displacement for unit twists of the m interfaces;
    `stiffness` (6m×6m, SI) the condensed one, ΨᵀKΨ.
    """

    constraint_modes: Array
    stiffness: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeBody(Swinging):
    """A body free of everything: its modes are the elastic ones.

    `rigid` (n×6): its rigid motions, mass-normalised.
    """

    rigid: Array


def held_body(rooted: RootedBody) -> Held:
    """A solid with the twists of all its interfaces held."""
    return Held(
        state=f"{rooted.name}, all interfaces held",
        flexibility=rooted.held_flexibility,
        mass=rooted.solid.mass,
        inertia=rooted.held_inertia,
        space=lambda: rooted.space,
        constraint_modes=rooted.constraint_modes,
        stiffness=rooted.stiffness,
    )


def free_body(rooted: RootedBody) -> FreeBody:
    """A solid with nothing held.

    Forces are taken together with the inertia of the rigid body that they move, displacements
    without the share of its motions (inertia relief), so that the flexibility has all other modes
    and these alone.
    """
    mass, motions = rooted.solid.mass, rooted.solid.motions
    mass_factor = cholesky(motions.T @ (mass @ motions))
    rigid = np.asarray(solve_triangular(mass_factor, motions.T, trans="T").T)
    momenta = np.asarray(mass @ rigid)

    def flexibility(forces: Any) -> Any:
        motions, impulses = map(space_of(forces).put, (rigid, momenta))
        displacements = rooted.flexibility(forces - impulses @ (motions.T @ forces))
        return displacements - motions @ (impulses.T @ displacements)

    def inertia(sigma: float) -> Inertia:
        # Rigid motions lie below every σ.
        signs = rooted.free_inertia(sigma)
        return signs._replace(negative=signs.negative - rigid.shape[1])

    return FreeBody(
        state=f"{rooted.name}, free",
        flexibility=flexibility,
        mass=mass,
        inertia=inertia,
        space=lambda: rooted.space,
        rigid=rigid,
    )


def residual_modes(body: Swinging, forces: Array, modes: Modes) -> tuple[Modes, Array]:
    """Ritz modes of the dropped modes' static response to `forces` F (n×k), and W (k×k).

    `modes` are those that are kept.
    """
    mass_shapes = body.mass @ modes.shapes
    loads = forces - mass_shapes @ (modes.shapes.T @ forces)
    response = _less_kept(modes, mass_shapes, body.flexibility(loads))
    inertia = body.mass @ response
    truncated = inertia.T @ _less_kept(modes, mass_shapes, body.flexibility(inertia))
    stiffness, mass = loads.T @ response, response.T @ inertia
    scale = 1.0 / np.sqrt(np.einsum("ij,ij->j", forces, body.flexibility(forces)))
    values, vectors = eigh(_symmetric(stiffness) * scale[:, None] * scale)
    significant = values > _NO_RESIDUAL
    basis = scale[:, None] * vectors[:, significant] / np.sqrt(values[significant])
    inverse_squares, amplitudes = eigh(basis.T @ _symmetric(mass) @ basis)
    inverse_squares, amplitudes = inverse_squares[::-1], amplitudes[:, ::-1]
    shapes = fix_signs(response @ (basis @ amplitudes) / np.sqrt(inverse_squares))
    frequencies = 1.0 / (2.0 * np.pi * np.sqrt(inverse_squares))
    return Modes(frequencies, shapes), _symmetric(truncated)


def _less_kept(modes: Modes, mass_shapes: Array, displacement: Array) -> Array:
    rest: Array = displacement - modes.shapes @ (mass_shapes.T @ displacement)
    return rest


def _symmetric(matrix: Array) -> Array:
    return np.asarray(0.5 * (matrix + matrix.T))
