"""Forces and moments in the sections of the legs of a loaded mechanism (member forces).

The forces in a section are those that the part of the leg beyond it exerts on the part before it.
They follow from the equilibrium of the part before it and do not depend on the leg's stiffness. N
is the component along the leg's centre line, positive in tension. Qy and Qz are shear forces. T, My
and Mz are the moments about the axes of the section, which follow the line: x along the tangent, z
as close to one direction as possible. In a straight leg they are the leg's axes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial, chebyshev

from lumped.arrays import Array, IntArray, distinct
from lumped.centre_line import CentreLine
from lumped.legs import Leg, LineLeg, NoBeamTheoryError, centre_line
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.load import DistributedLoad, Loading
from lumped.mechanism.mechanism import Posture
from lumped.screws import shift, turn
from lumped.system.line_loads import linear_load, section_wrenches, spread_load
from lumped.system.reactions import InternalForces

# Number of equal intervals between stations along a leg, and the fewest between two corners.
_INTERVALS, _FEWEST = 20, 3
# Fraction of the length of the mechanism, or of a unit wrench, below which a component is zero.
_ROUNDING = 1e-9
# Fractions of an interval at which components are interpolated, and the matrix of derivatives of
# the interpolation there.
_SHARES = 0.5 * (1.0 + chebyshev.chebpts2(5))
_RATES = np.array([Polynomial.fit(_SHARES, unit, 4).deriv()(_SHARES) for unit in np.eye(5)]).T


@dataclass(frozen=True, eq=False)
class MemberForces:
    """Forces and moments in s sections of a leg.

    `forces` (s×6) are N, Qy, Qz, T, My and Mz (N and N m, axes of the sections). Components that
    statics does not determine are NaN. `stations` (s, in m) are the distances of the sections from
    the root along the centre line. `half_width` (6) is the half-width of the numerical uncertainty
    of each component. `runs` (s) are the indices of the parts of the line between corners to which
    the sections belong. At a corner there are two sections with one station, one on each side.
    """

    leg: str
    stations: Array
    forces: Array
    half_width: Array
    runs: IntArray


def member_forces(
    posture: Posture, name: str, leg: Leg, forces: InternalForces, load: Loading
) -> MemberForces:
    """Forces and moments in the sections of the `leg` with the name `name` under a load.

    The stations include the ends of loads along the leg, steps and corners of the leg, and the
    positions at which a component has an extreme value. The loads along the leg may not balance the
    wrenches on its ends exactly, if they are computed with another mass than that of the model. The
    difference is then distributed linearly along the leg and added to the half-width.
    """
    root, tip = posture.mechanism.bodies[name].interfaces
    line = centre_line(leg)
    loads = list(load.line_loads.get(name, ()))
    if name in forces.bodies and (inertia := forces.bodies[name].inertia).any():
        loads.append(_distributed(leg, -inertia))
    at_root, at_tip = (_end_wrench(posture, name, point, forces, load) for point in (root, tip))
    tip_axes = turn(line.frames(np.array([line.length]))[1][0])
    spans = leg.spans if isinstance(leg, LineLeg) else ()
    ends = [end for part in loads for end in (part.start, part.stop)]
    ends += [end for span in spans for end in (span.start, span.end)]
    stations, runs = _equal_stations(line, np.array(ends))
    stations, runs = _with_extremes(
        line, stations, runs, partial(_section_forces, line, at_root[:, 0], loads)
    )
    values = _section_forces(line, at_root[:, 0], loads, stations, runs)
    missing = at_tip[:, 0] - tip_axes @ values[-1]
    axes = line.frames(stations, line.pieces_in_runs(stations, runs))[1]
    added = missing @ turn(axes)
    values += added * (stations / line.length)[:, None]
    for free in at_root[:, 1:].T:
        open_forces = np.abs(_section_forces(line, free, (), stations, runs)) > _ROUNDING
        values[open_forces] = np.nan
    rounding = max((joint.rounding for joint in forces.joints), default=0.0)
    half_width = np.abs(added).max(axis=0) + rounding * np.repeat([1.0, line.length], 3)
    return MemberForces(name, stations, values, half_width, runs)


def _distributed(leg: Leg, at_ends: Array) -> DistributedLoad:
    """Load along a leg from the wrenches `at_ends` (12, leg axes) on its root and tip."""
    if not isinstance(leg, LineLeg):
        return linear_load(at_ends[:6], at_ends[6:], leg.length)
    try:
        return spread_load(leg.sections("timoshenko"), at_ends)
    except NoBeamTheoryError:
        return spread_load(leg.sections("euler-bernoulli"), at_ends)


def _section_forces(
    line: CentreLine,
    root: Array,
    loads: Sequence[DistributedLoad],
    stations: Array,
    runs: IntArray,
) -> Array:
    """Forces and moments (s×6: N, Qy, Qz, T, My, Mz) in the sections at s `stations` (m).

    `root` (6, leg axes) is the wrench on the root of the leg, `loads` are the loads along it.
    `runs` (s) are the parts of the line between corners to which the stations belong.
    """
    points, axes = line.frames(stations, line.pieces_in_runs(stations, runs))
    wrenches = section_wrenches(line, root, loads, stations, points)
    return np.asarray(np.einsum("sji,sj->si", turn(axes), wrenches))


def _equal_stations(line: CentreLine, ends: Array) -> tuple[Array, IntArray]:
    """Equally spaced stations (s, in m) along a line with `ends` added, and their runs (s).

    Each run, a part of the line between corners, has stations at both of its ends.
    """
    slack = _ROUNDING * line.length
    stations = []
    for start, stop in pairwise(line.run_ends.tolist()):
        count = max(int(np.ceil(_INTERVALS * (stop - start) / line.length - _ROUNDING)), _FEWEST)
        inside = ends[(ends > start - slack) & (ends < stop + slack)]
        equal = np.linspace(start, stop, count + 1)
        stations.append(distinct(np.union1d(equal, np.clip(inside, start, stop)), slack))
    runs = np.repeat(np.arange(len(stations)), [len(part) for part in stations])
    return np.concatenate(stations), runs


def _with_extremes(
    line: CentreLine,
    stations: Array,
    runs: IntArray,
    section_forces: Callable[[Array, IntArray], Array],
) -> tuple[Array, IntArray]:
    """Stations (m) and their runs, with the extremes of all components between them added.

    `section_forces` is a function that returns the forces (n×6) at n positions in n runs. Between
    two stations they are interpolated by polynomials of degree 4, which is exact on straight
    pieces for loads that vary linearly.
    """
    before = np.flatnonzero(runs[:-1] == runs[1:])
    starts, lengths = stations[before], np.diff(stations)[before]
    positions = starts[:, None] + lengths[:, None] * _SHARES
    repeated = np.repeat(runs[before], len(_SHARES))
    values = section_forces(positions.ravel(), repeated).reshape(*positions.shape, 6)
    force = np.abs(values[..., :3]).max()
    moment = np.abs(values[..., 3:]).max() + force * line.length
    slack = _ROUNDING * np.repeat([force, moment], 3)
    ends = values[:, [0, -1]]
    low, high = ends.min(axis=1) - slack, ends.max(axis=1) + slack
    rates = np.einsum("pq,kqc->kpc", _RATES, values)
    turns = (rates[:, 1:] * rates[:, :-1] < 0.0).any(axis=1)
    extremes: list[list[float]] = [[] for _ in line.run_ends[1:]]
    for interval, column in np.argwhere(turns):
        component = Polynomial.fit(_SHARES, values[interval, :, column], len(_SHARES) - 1)
        roots = component.deriv().roots()
        shares = roots.real[(np.abs(roots.imag) < _ROUNDING) & (roots.real > 0) & (roots.real < 1)]
        peaks = component(shares)
        beyond = (peaks < low[interval, column]) | (peaks > high[interval, column])
        extremes[runs[before[interval]]] += (
            starts[interval] + lengths[interval] * shares[beyond]
        ).tolist()
    all_stations = [
        distinct(np.union1d(stations[runs == run], positions), _ROUNDING * line.length)
        for run, positions in enumerate(extremes)
    ]
    all_runs = np.repeat(np.arange(len(all_stations)), [len(part) for part in all_stations])
    return np.concatenate(all_stations), all_runs


def _end_wrench(
    posture: Posture, name: str, point: str, forces: InternalForces, load: Loading
) -> Array:
    """Wrench (6, leg axes) of joints and loads on the interface `point` of leg `name`.

    It is the first column of the result (6×(1 + k)). The other k columns are self-balanced wrenches
    that could be added, because statics does not determine them.
    """
    position = interface_position(posture, Side(name, point))
    count = forces.joints[0].undetermined.shape[1] if forces.joints else 0
    total = np.zeros((6, 1 + count))
    for transmitted in forces.joints:
        joint = transmitted.joint
        for side, sign in ((joint.first, -1.0), (joint.second, 1.0)):
            if side == Side(name, point):
                offset = interface_position(posture, joint.first) - position
                wrenches = np.column_stack([transmitted.wrench, transmitted.undetermined])
                total += sign * shift(offset).T @ wrenches
    for applied in load.point_wrenches:
        if (applied.body, applied.point) == (name, point):
            total[:, 0] += shift(applied.position - position).T @ applied.wrench
    return np.asarray(turn(posture.frames[name].rotation).T @ total)
