"""A mechanism under a load: how near to buckling, and what is left of its stiffness.

Under λ times the load its stiffness is K + λ G (`lumped.system.prestress`), singular where 1/λ is
minus an eigenvalue of L⁻¹ G L⁻ᵀ, K = L Lᵀ. All of these are there: no factor is missed.
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

# Loads that must grow as much are none.
_NEVER = 1e6


@dataclass(frozen=True, eq=False)
class Stability:
    """A mechanism under one of its loads, linear about its posture.

    It buckles at `factor` times the load, `reversed` times it the other way round (below zero);
    None where there is no factor below a million. `shares`: of strain energy as it buckles, by body
    or joint, the largest first. `lost`: shares of the tool's stiffness (6, along and about each
    axis alone) that the load takes, negative where it adds to it; `farther`: how much farther the
    tool moves than linear models say, relative, negative if it moves less far; `frequencies` (Hz)
    under the load. NaN and none where it has buckled.
    """

    factor: float | None
    reversed: float | None
    shares: dict[str, float]
    lost: Array = field(default_factory=lambda: np.full(6, np.nan))
    farther: float = np.nan
    frequencies: Array = field(default_factory=lambda: np.zeros(0))


def stability(solution: Solved, geometric: Array, load: Loading, count: int = 0) -> Stability:
    """Under a load, whose geometric stiffness (n×n) is given; `count` frequencies.

    Raises as `compliance` does.
    """
    factors, shape = _buckling(solution, geometric)
    shares: dict[str, float] = defaultdict(float)
    if factors[0] is not None:
        for part, share in strain_shares(solution.system, shape[:, None]).items():
            shares[part.of] += float(share[0])
    found = Stability(*factors, dict(sorted(shares.items(), key=lambda one: -one[1])))
    loaded = _under_load(solution, geometric)
    if loaded is None:
        return found
    before, after = (np.diag(compliance(one)) for one in (solution, loaded))
    here, there = (tool_displacements(one, [load])[0, :3] for one in (solution, loaded))
    whole, off = float(np.linalg.norm(here)), there - here
    return replace(
        found,
        lost=1.0 - np.divide(before, after, out=np.ones(6), where=before > 0.0),
        farther=float(np.copysign(np.linalg.norm(off), off @ here)) / whole if whole else 0.0,
        frequencies=modes_with_mass(loaded, count).frequencies,
    )


def _buckling(
    solution: Solved, geometric: Array
) -> tuple[tuple[float | None, float | None], Array]:
    """Factors above and below zero that are nearest to it, and the shape (n) of the former.

    A mechanism in which nothing moves has none.
    """
    if not len(solution.kept):
        return (None, None), np.zeros(solution.system.size)
    kept = solution.scale[:, None] * geometric[np.ix_(solution.kept, solution.kept)]
    half = solve_triangular(solution.lower, kept * solution.scale, lower=True)
    standard = solve_triangular(solution.lower, half.T, lower=True)
    last = len(standard) - 1
    (low, vector), (high, _) = (
        eigh(0.5 * (standard + standard.T), subset_by_index=[k, k], driver="evr") for k in (0, last)
    )
    shape = np.zeros(solution.system.size)
    still = solve_triangular(solution.lower, vector[:, 0], trans="T", lower=True)
    shape[solution.kept] = solution.scale * still
    reverse = _factor(high[0])
    return (_factor(-low[0]), None if reverse is None else -reverse), shape


def _factor(inverse: float) -> float | None:
    return float(1.0 / inverse) if inverse * _NEVER > 1.0 else None


def _under_load(solution: Solved, geometric: Array) -> Solved | None:
    """The system as stiff as the load leaves it; None where it has buckled."""
    system = solution.system
    stiffness = dense(system.stiffness) + geometric
    factor = factorised(stiffness[np.ix_(solution.kept, solution.kept)])
    if factor is None:
        return None
    loaded = replace(system, stiffness=stiffness, mass=dense(system.mass))
    return replace(solution, system=loaded, lower=factor[0], scale=factor[1])
