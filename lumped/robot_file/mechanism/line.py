"""Centre line of a leg of schema 2 and its sections at stations, or the faults of both.

In the table of a leg, `through` lists the points of the line between `from` and `to`. A point that
is given by its name or coordinates is joined to the point before it by a straight line. A point
`{ arc = POINT }` lies on a circular arc that joins the points before and after it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lumped.arrays import Array
from lumped.centre_line import SMALLEST_SINE, CentreLine, LinePiece, Point, point_of
from lumped.errors import InputError
from lumped.line_sections import TOGETHER
from lumped.mechanism.length_unit import UnitOfLength
from lumped.mechanism.placing import default_up, leg_frame
from lumped.robot_file.rules.tables.bodies import ArcEntry, BodyEntry
from lumped.robot_file.rules.tables.sections import CompositeParts, LaminateWall
from lumped.robot_file.rules.tables.values import Place
from lumped.sections import Polygon, Section, SectionProperties, symmetric_moments
from lumped.text import shown

# Distance (m) below which two points of a line coincide.
_TOGETHER = 1e-6
# Component of a direction below which it is round-off.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class LegLine:
    """Centre line of a leg (leg axes), and the sections at stations along it.

    `stations` are pairs (position in m along the line, section). None if there are `faults` or the
    leg has no section. `line` is None if its points have faults, or if the leg has keys that
    exclude a line.
    """

    line: CentreLine | None
    stations: tuple[tuple[float, Section], ...] | None
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class _Stop:
    """Point on the centre line of a leg at `position` (3, in m, base axes).

    `key` is the location of the point in the robot file. `name` is "" for a point given by
    coordinates. `on_arc` is True for a point inside an arc, given as { arc = POINT }.
    """

    key: str
    name: str
    position: Array
    on_arc: bool = False


def leg_line(
    body: BodyEntry, points: Mapping[str, Array], key: str, unit: UnitOfLength
) -> LegLine | None:
    """Centre line and stations of the leg at `key`, with the keys `through` or `sections`.

    None for a prism, which has neither of these keys. None also if points of the leg or its `up`
    have faults, which are reported elsewhere.
    """
    names = [name for name in ("through", "sections") if getattr(body, name) is not None]
    if not names:
        return None
    if faults := _misplaced_keys(body, names, key):
        return LegLine(None, None, tuple(faults))
    stops = _stops(body, points, key)
    if stops is None:
        return None
    try:
        frame = leg_frame(stops[0].position, stops[-1].position, _up(body))
    except InputError:
        # Reported as a fault of `to` or `up`.
        return None
    positions = [point_of(frame.rotation.T @ (stop.position - frame.position)) for stop in stops]
    chord = float(np.linalg.norm(stops[-1].position - stops[0].position))
    positions[-1] = (chord, 0.0, 0.0)
    faults = _stop_faults(stops, unit)
    if faults:
        return LegLine(None, None, tuple(faults))
    up = _up(body)
    direction = default_up(frame.rotation[:, 0]) if up is None else up
    line = CentreLine(_pieces(stops, positions), point_of(frame.rotation.T @ direction))
    names_on_line = _named_positions(stops, line)
    stations, faults = _stations(body, line, names_on_line, key)
    faults += [*_arc_faults(stops, line, unit), *_up_faults(body, line, frame.rotation, key)]
    if not faults and stations is not None:
        faults += _section_faults(stations, line, key, unit)
    return LegLine(line, None if faults else stations, tuple(faults))


def _misplaced_keys(body: BodyEntry, names: Sequence[str], key: str) -> list[str]:
    """Faults of the keys `names` of a leg at `key`, one for each of them.

    Empty unless the leg has a compliance or several materials, which exclude these keys.
    """
    if body.compliance is not None:
        reason = f"must be left out, because {key}.compliance is that of the whole leg"
        return [f"{key}.{name}: {reason}" for name in names]
    if isinstance(body.section, CompositeParts | LaminateWall):
        reason = (
            f"must be left out beside {key}.section, whose several materials belong to straight "
            "legs of one section"
        )
        return [f"{key}.{name}: {reason}" for name in names]
    return []


def _up(body: BodyEntry) -> Array | None:
    return None if body.up is None else np.array(body.up)


def _stops(body: BodyEntry, points: Mapping[str, Array], key: str) -> list[_Stop] | None:
    """Points of the centre line from root to tip.

    None if a point is missing or a name is unknown. These faults are reported elsewhere.
    """
    through = enumerate(body.through or (), start=1)
    stops = [
        _stop(f"{key}.from", body.from_, points),
        *(_stop(f"{key}.through[{number}]", point, points) for number, point in through),
        _stop(f"{key}.to", body.to, points),
    ]
    known_stops = [stop for stop in stops if stop is not None]
    return known_stops if len(known_stops) == len(stops) else None


def _stop(key: str, entry: Place | ArcEntry | None, points: Mapping[str, Array]) -> _Stop | None:
    """Point of the centre line from the value `entry` at `key`.

    None if `entry` is None or the name of an unknown point.
    """
    if isinstance(entry, ArcEntry):
        stop = _stop(f"{key}.arc", entry.arc, points)
        return None if stop is None else replace(stop, on_arc=True)
    if isinstance(entry, str):
        return _Stop(key, entry, points[entry]) if entry in points else None
    return None if entry is None else _Stop(key, "", np.array(entry))


def _stop_faults(stops: Sequence[_Stop], unit: UnitOfLength) -> list[str]:
    faults = []
    for first, second in pairwise(stops):
        if first.on_arc and second.on_arc:
            faults.append(
                f"{second.key}: follows another arc; must be preceded by the point where it begins"
            )
        distance = float(np.linalg.norm(second.position - first.position))
        if distance < _TOGETHER:
            faults.append(
                f"{second.key}: must be apart from the point before it (they are "
                f"{unit.shown(distance, 3)} apart)"
            )
    if faults:
        return faults
    for before, arc, after in zip(stops, stops[1:], stops[2:], strict=False):
        if not arc.on_arc:
            continue
        chord = after.position - before.position
        if float(np.linalg.norm(chord)) < _TOGETHER:
            faults.append(f"{arc.key}: the arc ends where it begins; must be two arcs for a circle")
            continue
        offset = np.linalg.norm(np.cross(arc.position - before.position, chord))
        if offset / np.linalg.norm(chord) < _TOGETHER:
            faults.append(
                f"{arc.key}: lies in line with its neighbours; must be off their line, or be left "
                "out"
            )
    return faults


def _pieces(stops: Sequence[_Stop], positions: Sequence[Point]) -> tuple[LinePiece, ...]:
    pieces = []
    start, through = positions[0], None
    for stop, position in zip(stops[1:], positions[1:], strict=True):
        if stop.on_arc:
            through = position
            continue
        pieces.append(LinePiece(start, position, through))
        start, through = position, None
    return tuple(pieces)


def _named_positions(stops: Sequence[_Stop], line: CentreLine) -> dict[str, float]:
    """Positions (m along the line) of the line's points, by name.

    Points given by coordinates and points inside an arc are left out.
    """
    ends = [stop for stop in stops if not stop.on_arc]
    return {
        stop.name: float(position)
        for stop, position in zip(ends, line.ends, strict=True)
        if stop.name
    }


def _stations(
    body: BodyEntry, line: CentreLine, names: Mapping[str, float], key: str
) -> tuple[tuple[tuple[float, Section], ...] | None, list[str]]:
    if body.sections is None:
        section = body.section
        if section is None or isinstance(section, CompositeParts | LaminateWall):
            return None, []
        return ((0.0, section), (line.length, section)), []
    faults = []
    positions = []
    for number, (station, _) in enumerate(body.sections, start=1):
        if isinstance(station, str) and station not in names:
            faults.append(
                f"{key}.sections[{number}].at = {shown(station)}: must be a corner or an end of "
                f"the line ({', '.join(names)}), or a share of its length from 0 to 1"
            )
            continue
        positions.append(names[station] if isinstance(station, str) else station * line.length)
    if faults:
        return None, faults
    slack = TOGETHER * line.length
    last = len(positions)
    ends = ((1, 0.0, "0", body.from_, "begins"), (last, line.length, "1", body.to, "ends"))
    for number, expected, fraction, end, verb in ends:
        if abs(positions[number - 1] - expected) > slack:
            faults.append(
                f"{key}.sections[{number}].at = {shown(body.sections[number - 1].at)}: must be "
                f'{fraction} or "{end}", where the line {verb}'
            )
    faults += [
        f"{key}.sections[{number}].at = {shown(body.sections[number - 1].at)}: must not come "
        "before the section above it; stations go from root to tip"
        for number, (first, second) in enumerate(pairwise(positions), start=2)
        if second < first - slack
    ]
    faults += [
        f"{key}.sections[{number}]: the third section at one position; must be two at a step"
        for number, (first, _, third) in enumerate(
            zip(positions, positions[1:], positions[2:], strict=False), start=3
        )
        if third - first <= slack
    ]
    if faults:
        return None, faults
    positions[0], positions[-1] = 0.0, line.length
    sections = [section for _, section in body.sections]
    return tuple(zip(positions, sections, strict=True)), []


def _arc_faults(stops: Sequence[_Stop], line: CentreLine, unit: UnitOfLength) -> list[str]:
    """Faults of arcs of more than three quarters of a turn."""
    arcs = [stop for stop in stops if stop.on_arc]
    pieces = [piece for piece in line.pieces if piece.through is not None]
    return [
        f"{stop.key}: makes an arc of {unit.shown(piece.radius)} radius and "
        f"{np.degrees(piece.length / piece.radius):.0f}°; must be at most 270°; divide it"
        for stop, piece in zip(arcs, pieces, strict=True)
        if piece.length / piece.radius > 1.5 * np.pi + _ROUNDING
    ]


def _up_faults(body: BodyEntry, line: CentreLine, rotation: Array, key: str) -> list[str]:
    if line.smallest_sine >= SMALLEST_SINE:
        return []
    points = np.concatenate([piece.at(np.linspace(0.0, 1.0, 9))[0] for piece in line.pieces])
    normal = rotation @ np.linalg.svd(points - points.mean(axis=0))[2][-1]
    normal *= np.sign(normal[np.argmax(np.abs(normal))])
    example = [float(f"{x:.4g}") for x in np.where(np.abs(normal) < _ROUNDING, 0.0, normal)]
    reason = (
        "missing; the default, [0, 0, 1], lies along the line somewhere"
        if body.up is None
        else "lies along the line somewhere"
    )
    value = "" if body.up is None else f" = {list(body.up)}"
    return [
        f"{key}.up{value}: {reason}; must be a direction along which the line does not run, "
        f"for example {example}"
    ]


def _section_faults(
    stations: Sequence[tuple[float, Section]], line: CentreLine, key: str, unit: UnitOfLength
) -> list[str]:
    faults = []
    slack = TOGETHER * line.length
    for number, ((start, first), (end, last)) in enumerate(pairwise(stations), start=2):
        location = f"{key}.sections[{number}]"
        if end - start <= slack or first == last:
            continue
        if type(first) is not type(last):
            faults.append(
                f'{location}.shape = "{last.shape}": must be "{first.shape}" as before it, or '
                f"follow a section of its own shape at the same position (a step)"
            )
        elif isinstance(last, Polygon | SectionProperties):
            faults.append(
                f"{location}: a {last.shape} has no sizes that could vary linearly; must equal the "
                "section before it, or follow an equal one at the same position (a step)"
            )
    arcs = [
        (piece, start, end)
        for piece, (start, end) in zip(line.pieces, pairwise(line.ends.tolist()), strict=True)
        if piece.through is not None
    ]
    constant = stations[0][1] == stations[-1][1] and len(stations) == 2
    for piece, start, end in arcs:
        for number, (_, section) in enumerate(stations, start=1):
            location = f"{key}.section" if constant else f"{key}.sections[{number}]"
            following = stations[min(number, len(stations) - 1)][0]
            before = stations[max(number - 2, 0)][0]
            if following < start + slack or before > end - slack:
                continue
            if symmetric_moments(section) is None:
                faults.append(
                    f'{location}.shape = "{section.shape}": must have two axes of symmetry on an '
                    "arc; use straight pieces, or another shape"
                )
            elif max(section.extent) >= 2.0 * piece.radius:
                faults.append(
                    f"{location}: {unit.shown(max(section.extent))} across; must be below the "
                    f"diameter of its arc, {unit.shown(2.0 * piece.radius)}"
                )
    largest = max(range(len(stations)), key=lambda k: max(stations[k][1].extent))
    if not constant and max(stations[largest][1].extent) >= line.length:
        faults.append(
            f"{key}.sections[{largest + 1}]: {unit.shown(max(stations[largest][1].extent))} "
            f"across; must be below the line's length, {unit.shown(line.length)}"
        )
    return list(dict.fromkeys(faults))
