"""How many modes of a clamped leg lie below a frequency: the certificate of fem.modes."""

from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array

from fem.cholesky import Backend, CholmodFactor, default_backend
from fem.cholmod_library import elimination
from fem.end_coupling import RigidEnds
from fem.sturm import Inertia, count_below
from fem.supported_count import supported_count

if TYPE_CHECKING:
    from fem.solid import ClampedLeg


def counting_backend() -> Backend:
    """PARDISO where it is installed: at 800k unknowns it alone counts in a minute."""
    return "mkl" if find_spec("pypardiso") else default_backend()


def count_name(backend: Backend) -> str:
    """What a report calls the count."""
    return {"cholmod": "sturm (supported Cholesky)", "mkl": "sturm (MKL PARDISO)"}[backend]


def clamped_count(clamped: "ClampedLeg", backend: Backend) -> Callable[[float], Inertia]:
    """Inertia of K − σM of a clamped leg, its ends rigid or free, as a function of σ (rad²/s²).

    Free ends: that of K − σM on the displacements with B_rootᵀu = 0. CHOLMOD counts with supports
    (fem.supported_count), and where these give no sign by LDLᵀ (fem.sturm).
    """
    mesh, ends = clamped.solid.mesh, clamped.ends
    if isinstance(ends, RigidEnds):
        K, M, constraints = clamped.stiffness, csr_array(clamped.mass), None
        points, leading = mesh.nodes[ends.interior], ends.leading_blocks
    else:
        K, M, points, leading = clamped.solid.stiffness, clamped.solid.mass, mesh.nodes, ()
        # Forces and moments of one size, so that no twist looks like rounding beside another.
        constraints = ends.root_loads * np.repeat([1.0, mesh.length], [3, 3])

    kept = None
    if backend == "cholmod" and isinstance(clamped.factor.numeric, CholmodFactor):
        kept = elimination(clamped.factor.numeric.handle)

    def count(sigma: float) -> Inertia:
        clamped.factor.make_room()
        if kept is not None:
            found = supported_count(kept, csr_array(K - sigma * M), points, constraints)
            if found is not None and not found.zero:
                return found
        return count_below(K, M, sigma, leading, backend, constraints)

    return count
