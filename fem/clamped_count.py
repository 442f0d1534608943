"""How many modes of a clamped leg lie below a frequency: the certificate of fem.modes."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array

from fem.end_coupling import RigidEnds
from fem.factor import Backend, upper_triangle
from fem.sturm import Inertia, count_below
from fem.supported_count import supported_count

if TYPE_CHECKING:
    from fem.solid import ClampedLeg


def count_name(backend: Backend) -> str:
    """What a report calls the count."""
    return {"cholmod": "sturm (supported Cholesky)", "mkl": "sturm (MKL PARDISO)"}[backend]


def clamped_count(clamped: "ClampedLeg", backend: Backend) -> Callable[[float], Inertia]:
    """Inertia of K − σM of a clamped leg, its ends rigid or free, as a function of σ (rad²/s²).

    Free ends: that of K − σM on the displacements with B_rootᵀu = 0. CHOLMOD counts with supports
    (fem.supported_count), and where these give no sign by LDLᵀ (fem.sturm).
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
