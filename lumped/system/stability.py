"""Stability of a mechanism under a load: buckling factors and remaining stiffness.

Under λ times the load the stiffness is K + λ G with the geometric stiffness G
(`lumped.system.prestress`). With K = L Lᵀ it is singular if −1/λ is an eigenvalue of L⁻¹ G L⁻ᵀ. The
smallest and the largest eigenvalue of this dense matrix are computed directly, so that no lower
buckling factor is missed.
"""

from collections import defaultdict
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import eigh, solve_triangular

from lumped.arrays import Array, dense
from lumped.mechanism.load import Loading
from lumped.system.loads import tool_displacements
from lumped.system.solution import (
    Solved,
    compliance,
    factorised,
    modes_with_mass,
    strain_shares,
)

# Buckling factor above which buckling counts as impossible.
_LARGEST_FACTOR = 1e6


@dataclass(frozen=True, eq=False)
class Stability:
    """Behaviour of a mechanism under one of its loads, linearised about its posture.

    It buckles at `factor` times the load, and at `reversed` times the load, a negative number for a
    load in the opposite direction. Each is None if its magnitude would exceed a million. `shares`
    are the fractions of the strain energy of the buckling mode at `factor`, by body or joint, the
    largest first. It is empty if `factor` is None.

    `stiffness_losses` (6) are the relative reductions of the tool's stiffness along and about each
    base axis due to the load, negative if the stiffness increases. `extra_displacement` is the
    relative increase of the tool's displacement over that without geometric stiffness, negative if
    it decreases. `frequencies` (Hz) are natural frequencies under the load. If the mechanism
    buckles below the load, `stiffness_losses` and `extra_displacement` are NaN and `frequencies` is
    empty.
    """

    factor: float | None
    reversed: float | None
    shares: dict[str, float]
    stiffness_losses: Array = field(default_factory=lambda: np.full(6, np.nan))
    extra_displacement: float = np.nan
    frequencies: Array = field(default_factory=lambda: np.zeros(0))


def stability(solution: Solved, geometric: Array, load: Loading, count: int = 0) -> Stability:
    """Stability and `count` natural frequencies under a load with `geometric` stiffness (n×n).

    Raises ComputationError if round-off dominates the compliance.
    """
    factors, shape = _buckling(solution, geometric)
    shares: dict[str, float] = defaultdict(float)
    if factors[0] is not None:
        for part, share in strain_shares(solution.system, shape[:, None]).items():
            shares[part.of] += float(share[0])
    result = Stability(*factors, dict(sorted(shares.items(), key=lambda entry: -entry[1])))
    loaded = _under_load(solution, geometric)
    if loaded is None:
        return result
    before, after = (np.diag(compliance(entry)) for entry in (solution, loaded))
    linear, nonlinear = (tool_displacements(entry, [load])[0, :3] for entry in (solution, loaded))
    size, increase = float(np.linalg.norm(linear)), nonlinear - linear
    extra = float(np.copysign(np.linalg.norm(increase), increase @ linear)) / size if size else 0.0
    return replace(
        result,
        stiffness_losses=1.0 - np.divide(before, after, out=np.ones(6), where=before > 0.0),
        extra_displacement=extra,
        frequencies=modes_with_mass(loaded, count).frequencies,
    )


def _buckling(
    solution: Solved, geometric: Array
) -> tuple[tuple[float | None, float | None], Array]:
    """Buckling factors closest to zero, one positive and one negative, and a mode shape (n).

    The mode shape is that of the positive factor. A factor is None if its magnitude would exceed a
    million. Both are None for a mechanism without elastic parts.
    """
    if not len(solution.retained):
        return (None, None), np.zeros(solution.system.size)
    scaled_geometric = (
        solution.scale[:, None] * geometric[np.ix_(solution.retained, solution.retained)]
    )
    half_product = solve_triangular(solution.lower, scaled_geometric * solution.scale, lower=True)
    standard = solve_triangular(solution.lower, half_product.T, lower=True)
    last = len(standard) - 1
    (low, vector), (high, _) = (
        eigh(0.5 * (standard + standard.T), subset_by_index=[k, k], driver="evr") for k in (0, last)
    )
    shape = np.zeros(solution.system.size)
    retained_shape = solve_triangular(solution.lower, vector[:, 0], trans="T", lower=True)
    shape[solution.retained] = solution.scale * retained_shape
    reverse = _factor(high[0])
    return (_factor(-low[0]), None if reverse is None else -reverse), shape


def _factor(inverse: float) -> float | None:
    return float(1.0 / inverse) if inverse * _LARGEST_FACTOR > 1.0 else None


def _under_load(solution: Solved, geometric: Array) -> Solved | None:
    """System with the stiffness K + G, factorised, for G = `geometric` (n×n).

    None if the mechanism has buckled: K + G is then not positive definite.
    """
    system = solution.system
    stiffness = dense(system.stiffness) + geometric
    factor = factorised(stiffness[np.ix_(solution.retained, solution.retained)])
    if factor is None:
        return None
    loaded = replace(system, stiffness=stiffness, mass=dense(system.mass))
    return replace(solution, system=loaded, lower=factor[0], scale=factor[1])
