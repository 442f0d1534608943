"""Postures on the grid of a path, values in them, and a search for the worst posture.

Input: a mechanism whose path is a grid, and a function that returns a number for a posture. Output:
values at the grid points, and the pose with the worst value. Rule: the search (Nelder and Mead)
starts at the worst local extrema of the grid. Each value is computed in a posture with closed
loops; no value is interpolated.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from math import prod
from typing import NamedTuple, TypeAlias

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError, InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture

# Function that returns one number for each posture. Raises ComputationError if a posture cannot be
# solved.
Solve: TypeAlias = Callable[[Sequence[Posture]], Array]
# Indices of a grid point along each axis, or indices of coordinates of a pose.
Indices: TypeAlias = tuple[int, ...]

# Number of searches, each from one of the worst local extrema of the grid; largest number of
# postures in one search; length of the last steps, in grid spacings.
_STARTS, _EVALUATIONS, _SPACINGS_AT_END = 2, 40, 1e-2
# First step of a search, in grid spacings, if the parabola through three grid points has no
# minimum; smallest first step otherwise.
_DEFAULT_STEP, _SMALLEST_STEP = 0.3, 0.1


@dataclass(frozen=True, eq=False)
class Workspace:
    """Postures on a grid of poses.

    `varied`: indices of the pose coordinates that vary. `axes`: grid values of each varied
    coordinate (m or rad). `postures`: posture by the indices of its grid point; poses out of reach
    are missing.
    """

    mechanism: Mechanism
    varied: Indices
    axes: Sequence[Array]
    postures: dict[Indices, Posture] = field(default_factory=dict)

    @property
    def shape(self) -> Indices:
        """Number of grid values along each axis."""
        return tuple(map(len, self.axes))

    def pose(self, indices: Sequence[float] | Array) -> Array:
        """Pose at the indices of a grid point.

        Fractional indices give a pose between grid points.
        """
        pose = np.array([values[0] for values in self.mechanism.grid])
        for move, values, index in zip(self.varied, self.axes, indices, strict=True):
            pose[move] = np.interp(index, np.arange(len(values)), values)
        return pose


class WorstPosture(NamedTuple):
    """Pose of the worst posture of a search, and the value there."""

    pose: Array
    value: float


def directions(mechanism: Mechanism) -> Indices:
    """Indices of pose coordinates that vary on the path's grid. () unless two or three vary."""
    varied = tuple(move for move, values in enumerate(mechanism.grid) if np.ptp(values) > 0.0)
    return varied if len(varied) in (2, 3) else ()


def workspace(mechanism: Mechanism, max_poses: int) -> Workspace:
    """Workspace of a mechanism whose path is a grid, reduced to at most `max_poses` poses."""
    moves = directions(mechanism)
    axes = [mechanism.grid[move] for move in moves]
    share = min(1.0, (max_poses / prod(map(len, axes))) ** (1.0 / len(axes)))
    axes = [values[evenly(len(values), max(2, int(share * len(values))))] for values in axes]
    space = Workspace(mechanism, moves, axes)
    for indices in np.ndindex(*space.shape):
        with suppress(InputError):
            space.postures[indices] = posture(mechanism, space.pose(indices))
    return space


def grid_values(space: Workspace, solve: Solve) -> Array:
    """Values at all points of the grid, as an array with an axis for each varied coordinate.

    NaN for poses that are out of reach or cannot be solved.
    """
    values = np.full(space.shape, np.nan)
    postures = list(space.postures.values())
    try:
        solved = solve(postures)
    except ComputationError:
        # Solved one by one, so that one singular posture does not prevent the others.
        solved = np.array([_value(solve, posture) for posture in postures])
    for indices, value in zip(space.postures, solved, strict=True):
        values[indices] = value if np.isfinite(value) else np.nan
    return values


def worst_posture(
    space: Workspace, values: Array, solve: Solve, *, largest: bool = False
) -> WorstPosture | None:
    """Posture with the smallest (or `largest`) value, on the grid or between its points.

    `values` are the result of `grid_values`. None if all of them are NaN.
    """
    sign = -1.0 if largest else 1.0
    cost = np.where(np.isnan(values), np.inf, sign * values)
    local_minima = np.isfinite(cost) & (
        cost == scipy.ndimage.minimum_filter(cost, size=3, mode="nearest")
    )
    starts = sorted((tuple(point) for point in np.argwhere(local_minima)), key=cost.__getitem__)
    candidates = []
    for start in starts[:_STARTS]:
        candidates += [(cost[start], space.pose(start)), _minimum(space, cost, start, solve, sign)]
    if not candidates:
        return None
    value, pose = min(candidates, key=lambda candidate: candidate[0])
    return WorstPosture(pose, sign * float(value))


def _minimum(
    space: Workspace, cost: Array, start: Indices, solve: Solve, sign: float
) -> tuple[float, Array]:
    """Lowest cost near a grid point, and its pose, by the simplex method of Nelder and Mead.

    `cost` is `sign` times the values at the grid points. The first simplex consists of the grid
    point `start` and of the minima of parabolas along the grid axes.
    """
    nearest = space.postures[start]
    first = np.array(start, dtype=float)
    steps = _first_steps(np.pad(cost, 1, constant_values=np.inf), tuple(k + 1 for k in start))
    last = np.array(space.shape) - 1.0

    def cost_at(indices: Array) -> float:
        with suppress(InputError):
            value = _value(solve, posture(space.mechanism, space.pose(indices), nearest))
            return np.inf if np.isnan(value) else sign * value
        return np.inf

    minimum = scipy.optimize.minimize(
        cost_at,
        first,
        method="Nelder-Mead",
        bounds=list(zip(np.maximum(first - 1.0, 0.0), np.minimum(first + 1.0, last), strict=True)),
        options={
            "initial_simplex": np.vstack([first, first + np.diag(steps)]),
            "maxfev": _EVALUATIONS,
            "xatol": _SPACINGS_AT_END,
            "fatol": np.inf,
        },
    )
    return float(minimum.fun), space.pose(minimum.x)


def _first_steps(cost: Array, indices: Indices) -> list[float]:
    """First step along each axis from a local minimum of the grid, in grid spacings."""
    steps = []
    for axis in range(cost.ndim):
        before, after = (
            cost[(*indices[:axis], indices[axis] + step, *indices[axis + 1 :])] for step in (-1, 1)
        )
        step = _DEFAULT_STEP if after <= before else -_DEFAULT_STEP
        curvature = before + after - 2.0 * cost[indices]
        if np.isfinite(curvature) and curvature > 0.0:
            to_minimum = 0.5 * (before - after) / curvature
            step = np.copysign(max(abs(to_minimum), _SMALLEST_STEP), to_minimum)
        steps.append(float(step))
    return steps


def _value(solve: Solve, posture: Posture) -> float:
    """Value in one posture. NaN if the model cannot be solved there."""
    try:
        return float(solve([posture])[0])
    except ComputationError:
        return np.nan


def evenly(count: int, largest_count: int) -> IntArray:
    """At most `largest_count` evenly spaced integers from 0 to `count` − 1, both included."""
    return np.unique(np.linspace(0, count - 1, min(count, largest_count)).round().astype(int))
