"""How many eigenvalues of K x = λ M x lie below σ, by the cheaper count that gives their signs."""

from scipy.sparse import csr_array

from fem.solvers.certificate.sturm import Inertia, count_below
from fem.solvers.certificate.supported_count import supported_count
from fem.solvers.factor import Backend, upper_triangle
from fem.solvers.renewable_factor import RenewableFactor
from lumped.arrays import Array, SparseMatrix


def count_name(backend: Backend) -> str:
    """What a report calls the count."""
    return {"cholmod": "sturm (supported Cholesky)", "mkl": "sturm (MKL PARDISO)"}[backend]


def inertia_below(
    factor: RenewableFactor,
    K: SparseMatrix,
    M: SparseMatrix,
    sigma: float,
    points: Array,
    leading: tuple[int, ...] = (),
    constraints: Array | None = None,
) -> Inertia:
    """Inertia of K − σM (csr n×n, σ in rad²/s²), on Bᵀx = 0 where `constraints` B (n×c) are given.

    `factor` is of K or of K with springs, of one pattern with both; `points` (N×3, m) are the nodes
    of the last 3N unknowns, `leading` the blocks before them (fem.solvers.ordering). CHOLMOD counts
    with supports on the separators of the factor (fem.solvers.certificate.supported_count), and
    where these give no sign by LDLᵀ (fem.solvers.certificate.sturm). `zero` above zero: move σ.
    """
    K, M = upper_triangle(K), upper_triangle(csr_array(M))
    backend = factor.symbolic.backend
    if backend == "cholmod":
        found = supported_count(factor, K, M, sigma, points, constraints)
        if found is not None and not found.zero:
            return found
    factor.make_room()
    return count_below(K, M, sigma, leading, backend, constraints)
