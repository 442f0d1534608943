"""A workspace: postures on the grid of a path, values in them, and the worst posture between them.

The search knows nothing of what it looks for: whatever it looks at is computed in a posture whose
loops are closed, nothing is interpolated.
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

# A number for each of the postures; raises ComputationError where one cannot be solved.
Solve: TypeAlias = Callable[[Sequence[Posture]], Array]
Place: TypeAlias = tuple[int, ...]

# A search begins at so many of the grid's local extrema, the worst ones, and looks at so many
# postures at most, until its steps are this part of the distance between points of the grid.
_STARTS, _LOOKS, _CLOSE = 2, 40, 1e-2
# First steps of a search, in distances of grid points: where a parabola through three of them does
# not say where it is lowest, and at least.
_STEP, _LEAST = 0.3, 0.1


@dataclass(frozen=True, eq=False)
class Workspace:
    """Postures on a grid of poses.

    `axes` are the values (m or rad) along those of the tool's moves, by number `moves`, that vary;
    `postures` by their place on the grid, without those that cannot be reached.
    """

    mechanism: Mechanism
    moves: Place
    axes: Sequence[Array]
    postures: dict[Place, Posture] = field(default_factory=dict)

    @property
    def shape(self) -> Place:
        """How many values there are along each axis."""
        return tuple(map(len, self.axes))

    def pose(self, place: Sequence[float] | Array) -> Array:
        """The pose at a place of the grid, or between its points."""
        pose = np.array([values[0] for values in self.mechanism.grid])
        for move, values, at in zip(self.moves, self.axes, place, strict=True):
            pose[move] = np.interp(at, np.arange(len(values)), values)
        return pose


class WorstPosture(NamedTuple):
    """The worst posture that was found, by its pose, and its value."""

    pose: Array
    value: float


def directions(mechanism: Mechanism) -> Place:
    """The tool's moves, by number, that vary on the grid of the path; () unless two or three."""
    varied = tuple(move for move, values in enumerate(mechanism.grid) if np.ptp(values) > 0.0)
    return varied if len(varied) in (2, 3) else ()


def workspace(mechanism: Mechanism, most: int) -> Workspace:
    """The workspace of a path that is a grid; of one of more than `most` poses fewer, as evenly."""
    moves = directions(mechanism)
    axes = [mechanism.grid[move] for move in moves]
    share = min(1.0, (most / prod(map(len, axes))) ** (1.0 / len(axes)))
    axes = [values[evenly(len(values), max(2, int(share * len(values))))] for values in axes]
    space = Workspace(mechanism, moves, axes)
    for place in np.ndindex(*space.shape):
        with suppress(InputError):
            space.postures[place] = posture(mechanism, space.pose(place))
    return space


def values_on(space: Workspace, solve: Solve) -> Array:
    """The value in every posture, over the grid; NaN where there is none."""
    found = np.full(space.shape, np.nan)
    postures = list(space.postures.values())
    try:
        solved = solve(postures)
    except ComputationError:
        # One that is singular must not cost the others.
        solved = np.array([_value(solve, one) for one in postures])
    for place, value in zip(space.postures, solved, strict=True):
        found[place] = value if np.isfinite(value) else np.nan
    return found


def worst_posture(
    space: Workspace, values: Array, solve: Solve, *, largest: bool = False
) -> WorstPosture | None:
    """The posture of the smallest value, or the `largest`: between the grid's points, too.

    `values` as `values_on` gives them. None where there is none.
    """
    sign = -1.0 if largest else 1.0
    cost = np.where(np.isnan(values), np.inf, sign * values)
    lowest = np.isfinite(cost) & (
        cost == scipy.ndimage.minimum_filter(cost, size=3, mode="nearest")
    )
    starts = sorted((tuple(place) for place in np.argwhere(lowest)), key=cost.__getitem__)
    found = []
    for start in starts[:_STARTS]:
        found += [(cost[start], space.pose(start)), _searched(space, cost, start, solve, sign)]
    if not found:
        return None
    value, pose = min(found, key=lambda one: one[0])
    return WorstPosture(pose, sign * float(value))


def _searched(
    space: Workspace, cost: Array, start: Place, solve: Solve, sign: float
) -> tuple[float, Array]:
    """The lowest cost that is found around a place of the grid, and its pose.

    Nelder and Mead's simplex from the place and from where parabolas along the grid are lowest.
    """
    near = space.postures[start]
    begin = np.array(start, dtype=float)
    steps = _steps(np.pad(cost, 1, constant_values=np.inf), tuple(one + 1 for one in start))
    last = np.array(space.shape) - 1.0

    def looked_at(place: Array) -> float:
        with suppress(InputError):
            value = _value(solve, posture(space.mechanism, space.pose(place), near))
            return np.inf if np.isnan(value) else sign * value
        return np.inf

    found = scipy.optimize.minimize(
        looked_at,
        begin,
        method="Nelder-Mead",
        bounds=list(zip(np.maximum(begin - 1.0, 0.0), np.minimum(begin + 1.0, last), strict=True)),
        options={
            "initial_simplex": np.vstack([begin, begin + np.diag(steps)]),
            "maxfev": _LOOKS,
            "xatol": _CLOSE,
            "fatol": np.inf,
        },
    )
    return float(found.fun), space.pose(found.x)


def _steps(cost: Array, place: Place) -> list[float]:
    """First steps along each axis from a place that is lower than its neighbours."""
    steps = []
    for axis in range(cost.ndim):
        before, after = (
            cost[(*place[:axis], place[axis] + step, *place[axis + 1 :])] for step in (-1, 1)
        )
        step = _STEP if after <= before else -_STEP
        bend = before + after - 2.0 * cost[place]
        if np.isfinite(bend) and bend > 0.0:
            to_lowest = 0.5 * (before - after) / bend
            step = np.copysign(max(abs(to_lowest), _LEAST), to_lowest)
        steps.append(float(step))
    return steps


def _value(solve: Solve, at: Posture) -> float:
    """NaN where the model cannot be solved."""
    try:
        return float(solve([at])[0])
    except ComputationError:
        return np.nan


def evenly(count: int, wanted: int) -> IntArray:
    """At most `wanted` of the numbers from 0 to `count` − 1, first and last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, wanted)).round().astype(int))
