"""Bodies to be reduced, with fixed or free interfaces, and the residual modes of a reduction.

The static response of a body to forces F is A F with its flexibility A. Residual modes Z are this
response without its part in the kept modes, that is, the sum Σ φ_k pᵀ/λ_k over the dropped modes
with p = Fᵀφ_k. The kept modes and Z are the basis of a reduced body. Its dynamic flexibility is an
approximation to Fᵀ(K − λM)⁻¹F, with λ = ω². For λ below λ_c, the smallest λ_k of a dropped mode,
the approximation is too small by at most λ²/(1 − λ/λ_c) W, with W = (MZ)ᵀ A (MZ) = Σ p pᵀ/λ_k³. W
is known without computing the dropped modes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from fem.bodies.rooted import RootedBody
from fem.solvers.backends.cudss import space_of
from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.factor import Inertia
from lumped.arrays import Array, SparseMatrix, fix_signs, symmetric
from lumped.dense.modes import Modes

# Residual modes with less than this fraction of the work of the forces are round-off.
_NO_RESIDUAL = 1e-11


@dataclass(frozen=True, eq=False, kw_only=True)
class VibratingBody:
    """A body whose vibration modes are computed, either with fixed interfaces or unsupported.

    It has n unknowns u. `state` is its name and support in messages. `flexibility` is a function
    that computes displacements (n×k) under forces (n×k). It is symmetric and positive semidefinite.
    `mass` is n×n. `inertia` is a function of σ (rad²/s²) that returns the numbers of negative, zero
    and positive eigenvalues of K − σM, without rigid motions. None if eigenvalues cannot be
    counted. `require_count` raises ComputationError if no factor for the count fits the memory.
    `space` returns the memory (host or graphics card) in which forces are used without a copy.
    """

    state: str
    flexibility: Callable[[Any], Any]
    mass: SparseMatrix
    inertia: Callable[[float], Inertia] | None = None
    require_count: Callable[[], None] = lambda: None
    space: Callable[[], Space] = lambda: HOST

    @property
    def size(self) -> int:
        """Number n of unknowns of the body."""
        return int(self.mass.shape[0])


@dataclass(frozen=True, eq=False, kw_only=True)
class Held(VibratingBody):
    """A body with the twists of its interfaces fixed, and its response to these twists.

    `constraint_modes` Ψ (n×6m) are the static displacements for unit twists of the m interfaces,
    `stiffness` (6m×6m, SI, body axes) is the condensed stiffness ΨᵀKΨ.
    """

    constraint_modes: Array
    stiffness: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeBody(VibratingBody):
    """An unsupported body. Its modes are the elastic ones.

    `rigid` (n×6) are its rigid motions with unit modal mass. Its eigenvalues can be counted.
    """

    inertia: Callable[[float], Inertia]
    rigid: Array


def held_body(rooted: RootedBody) -> Held:
    """Solid with the twists of all its interfaces fixed."""
    return Held(
        state=f"{rooted.name}, all interfaces held",
        flexibility=rooted.held_flexibility,
        mass=rooted.solid.mass,
        inertia=rooted.held_inertia,
        require_count=rooted.require_count,
        space=lambda: rooted.space,
        constraint_modes=rooted.constraint_modes,
        stiffness=rooted.stiffness,
    )


def free_body(rooted: RootedBody) -> FreeBody:
    """Solid without any support.

    Its flexibility is that of inertia relief: forces are balanced by the inertia of the rigid
    motions that they cause, and the rigid motion is removed from the displacements. It thus
    contains only the elastic modes.
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
        # The eigenvalues of rigid motions are below any σ.
        signs = rooted.free_inertia(sigma)
        return signs._replace(negative=signs.negative - rigid.shape[1])

    return FreeBody(
        state=f"{rooted.name}, free",
        flexibility=flexibility,
        mass=mass,
        inertia=inertia,
        require_count=rooted.require_count,
        space=lambda: rooted.space,
        rigid=rigid,
    )


def residual_modes(body: VibratingBody, forces: Array, modes: Modes) -> tuple[Modes, Array]:
    """Residual modes of a body for `forces` F (n×k), and the matrix W (k×k) of their error bound.

    The residual modes are Ritz modes of the static response of the dropped modes. `modes` are the
    kept modes. The bound is that of the module docstring.
    """
    mass_shapes = body.mass @ modes.shapes
    loads = forces - mass_shapes @ (modes.shapes.T @ forces)
    response = _less_kept(modes, mass_shapes, body.flexibility(loads))
    inertia = body.mass @ response
    truncated = inertia.T @ _less_kept(modes, mass_shapes, body.flexibility(inertia))
    stiffness, mass = loads.T @ response, response.T @ inertia
    scale = 1.0 / np.sqrt(np.einsum("ij,ij->j", forces, body.flexibility(forces)))
    values, vectors = eigh(symmetric(stiffness) * scale[:, None] * scale)
    significant = values > _NO_RESIDUAL
    basis = scale[:, None] * vectors[:, significant] / np.sqrt(values[significant])
    inverse_squares, amplitudes = eigh(basis.T @ symmetric(mass) @ basis)
    inverse_squares, amplitudes = inverse_squares[::-1], amplitudes[:, ::-1]
    shapes = fix_signs(response @ (basis @ amplitudes) / np.sqrt(inverse_squares))
    frequencies = 1.0 / (2.0 * np.pi * np.sqrt(inverse_squares))
    return Modes(frequencies, shapes), symmetric(truncated)


def _less_kept(modes: Modes, mass_shapes: Array, displacement: Array) -> Array:
    rest: Array = displacement - modes.shapes @ (mass_shapes.T @ displacement)
    return rest
