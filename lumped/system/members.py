"""Forces and moments in the sections of the legs of a loaded mechanism (member forces).

The forces in the section at x are those that the part of the leg beyond x exerts on the part before
x. They follow from the equilibrium of the part before x and do not depend on the leg's stiffness. N
is the component along x, positive in tension. Qy and Qz are shear forces. T, My and Mz are the
moments about the leg's axes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, distinct
from lumped.legs import LineLeg
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.mechanism.load import LineLoad, Loading
from lumped.mechanism.mechanism import Posture
from lumped.screws import shift, turn
from lumped.system.line_loads import linear_load
from lumped.system.reactions import InternalForces

# Number of equally spaced stations along a leg.
_STATIONS = 21
# Fraction of the length of the mechanism, or of a unit wrench, below which a component is zero.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class MemberForces:
    """Forces and moments in s sections of a leg.

    `forces` (s×6) are N, Qy, Qz, T, My and Mz (N and N m, leg axes). Components that statics does
    not determine are NaN. `stations` (s, in m) are the distances of the sections from the root.
    `half_width` (6) is the half-width of the numerical uncertainty of each component.
    """

    leg: str
    stations: Array
    forces: Array
    half_width: Array


def member_forces(
    posture: Posture, name: str, forces: InternalForces, load: Loading
) -> MemberForces:
    """Forces and moments in the sections of the leg `name` under a load.

    The stations include the ends of loads along the leg, steps and corners of the leg, and the
    zeros of both shear forces, where bending moments have their extremes. The loads along the leg
    may not balance the wrenches on its ends exactly, if they are computed with another mass than
    that of the model. The difference is then distributed linearly along the leg and added to the
    half-width.
    """
    root, tip = posture.mechanism.bodies[name].interfaces
    length = float(posture.mechanism.bodies[name].interfaces[tip].position[0])
    loads = list(load.line_loads.get(name, ()))
    if name in forces.bodies and (inertia := forces.bodies[name].inertia).any():
        loads.append(linear_load(-inertia[:6], -inertia[6:], length))
    at_root, at_tip = (_end_wrench(posture, name, point, forces, load) for point in (root, tip))
    shape = posture.mechanism.bodies[name].shape
    spans = shape.spans if isinstance(shape, LineLeg) else ()
    ends = [end for part in loads for end in (part.start, part.stop)]
    ends += [end for span in spans for end in (span.start, span.end)]
    stations = distinct(np.union1d(np.linspace(0.0, length, _STATIONS), ends), _ROUNDING * length)
    coarse = section_forces(at_root[:, 0], loads, stations)
    zeros = list(_zeros(stations, coarse[:, 1:3]))
    stations = distinct(np.union1d(stations, zeros), _ROUNDING * length)
    values = section_forces(at_root[:, 0], loads, stations)
    missing = at_tip[:, 0] - values[-1]
    values += missing * (stations / length)[:, None]
    for free in at_root[:, 1:].T:
        open_forces = np.abs(section_forces(free, (), stations)) > _ROUNDING
        values[open_forces] = np.nan
    rounding = max((joint.rounding for joint in forces.joints), default=0.0)
    return MemberForces(
        name, stations, values, np.abs(missing) + rounding * np.repeat([1.0, length], 3)
    )


def section_forces(root: Array, loads: Sequence[LineLoad], stations: Array) -> Array:
    """Forces and moments (s×6: N, Qy, Qz, T, My, Mz) in the sections at s `stations` (m) of a leg.

    `root` (6, leg axes) is the wrench on the root of the leg. `loads` are the loads along it.
    """
    x = stations[:, None]
    total, lever = np.zeros((len(x), 6)), np.zeros((len(x), 3))
    for load in loads:
        inside = np.clip(x - load.start, 0.0, load.stop - load.start)
        slope = (load.last - load.first) / (load.stop - load.start)
        resultant = load.first * inside + slope * inside**2 / 2.0
        moment = load.first * inside**2 / 2.0 + slope * inside**3 / 3.0
        total += resultant
        lever += ((x - load.start) * resultant - moment)[:, :3]
    moments = -root[3:] - total[:, 3:] + np.cross([1.0, 0.0, 0.0], root[:3] * x + lever)
    return np.hstack([-root[:3] - total[:, :3], moments])


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


def _zeros(stations: Array, shear: Array) -> Iterator[float]:
    """Positions (m) at which one of the two shear forces changes its sign.

    `shear` (s×2) are the shear forces at the s `stations`. Between stations they are interpolated
    by parabolas, which is exact for loads that vary linearly.
    """
    for values in shear.T:
        for number in np.flatnonzero(values[:-1] * values[1:] < 0.0):
            start = min(int(number), len(stations) - 3)
            three = slice(start, start + 3)
            roots = np.roots(np.polyfit(stations[three] - stations[number], values[three], 2))
            step = stations[number + 1] - stations[number]
            yield from (stations[number] + root.real for root in roots if 0.0 <= root.real <= step)
