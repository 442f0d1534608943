"""Modes of a clamped solid leg, with the count that proves that none is missing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from fem.bodies.solid import ClampedLeg
from fem.couplings.end_coupling import RigidEnds
from fem.solvers.certificate.sturm import Inertia, count_below
from fem.solvers.certificate.supported_count import supported_count
from fem.solvers.factor import Backend, upper_triangle
from fem.solvers.modes import CertifiedModes, lowest_modes
from lumped.arrays import Array
from lumped.dense.modes import fix_signs


def count_name(backend: Backend) -> str:
    """What a report calls the count."""
    return {"cholmod": "sturm (supported Cholesky)", "mkl": "sturm (MKL PARDISO)"}[backend]


def clamped_count(clamped: ClampedLeg, backend: Backend) -> Callable[[float], Inertia]:
    """Inertia of K − σM of a clamped leg, its ends rigid or free, as a function of σ (rad²/s²).

    Free ends: that of K − σM on the displacements with B_rootᵀu = 0. CHOLMOD counts with supports
    (fem.solvers.certificate.supported_count), and where these give no sign by LDLᵀ
    (fem.solvers.certificate.sturm).
    """
    mesh, ends, factor = clamped.mesh, clamped.ends, clamped.factor
    K, M, constraints = factor.triangle, clamped.mass, None
    points, leading = mesh.nodes, ends.leading_blocks
    if isinstance(ends, RigidEnds):
        points = points[ends.interior]
    elif clamped.solid is not None:
        K, M = clamped.solid.stiffness, clamped.solid.mass
        # Forces and moments of one size, so that no twist looks like rounding beside another.
        constraints = ends.root_loads * np.repeat([1.0, mesh.length], [3, 3])
    K, M = upper_triangle(K), upper_triangle(csr_array(M))

    def count(sigma: float) -> Inertia:
        if backend == "cholmod":
            found = supported_count(factor, K, M, sigma, points, constraints)
            if found is not None and not found.zero:
                return found
        factor.make_room()
        return count_below(K, M, sigma, leading, backend, constraints)

    return count


def modes(clamped: ClampedLeg, count: int, start: Array | None = None) -> CertifiedModes:
    """The lowest `count` modes of a leg held at its root: shapes 3N×count, leg axes.

    `start` as in `fem.solvers.modes.lowest_modes`, on the unknowns of the held leg. Raises as that
    does.
    """
    backend = clamped.factor.symbolic.backend
    found = lowest_modes(
        clamped.factor,
        clamped.mass,
        count,
        clamped_count(clamped, backend),
        "solid leg",
        count_name(backend),
        start,
    )
    return replace(found, shapes=fix_signs(clamped.ends.expanded(found.shapes)))
