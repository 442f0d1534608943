"""Frequency responses of a test as measured values: their sizes at modes and far below them.

The lines of a spectrum near a frequency are fitted by what one damped mode gives and a straight
line: what lies between them counts, and what scatters is known.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import hypot, sqrt

import numpy as np

from lumped.acceptance.measured import Measured, MeasuredResponse, ModalTest
from lumped.acceptance.quantities import (
    SIZE_FAR_BELOW,
    QuantityKind,
    response_quantities,
    size_at_mode,
)
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.hammer import Hammer
from validation.measured.tested import TestedModes

# Lines on each side at least, and within so many half-widths of the peak.
_LINES, _WIDTHS = 4.5, 2.0
# Of the lowest mode: there the robot moves by an eighth more than at rest.
_LOW = 1.0 / 3.0
# Directions and places that are one.
_SAME = 1e-6


def responses_of(
    found: TestedModes,
    test: ModalTest,
    numbers: Mapping[int, int],
    hammer: Hammer,
    robot: Mechanism,
    source: str,
) -> Iterator[Measured]:
    """Responses of a test whose modes, by column, have such `numbers` in the robot.

    At each mode and far below all of them the response is read that is largest there; [[responses]]
    from that of the tool to a force at it.
    """
    known = np.isin(found.ends[:, :, 0], list(hammer.nodes)).all(axis=1)
    rows = [int(row) for row in np.flatnonzero(known)]
    for row in rows:
        yield from _of_tool(found, test, row, hammer, robot, source)
    if not (rows and numbers):
        return
    own, first = test.frequencies, min(numbers)
    asked = [(size_at_mode(numbers[c]), c, float(own[c]), False) for c in sorted(numbers)]
    if (low := _LOW * float(own[first])) >= found.frequencies[0]:
        asked.append((SIZE_FAR_BELOW, first, low, True))
    largest = [
        max(rows, key=lambda row: abs(_read(found, test, row, column, at, hammer)[0]))
        for _, column, at, _ in asked
    ]
    chosen = list(dict.fromkeys(largest))
    held = replace(test, responses=tuple(_response(found, row, hammer) for row in chosen))
    for (quantity, column, at, below), row in zip(asked, largest, strict=True):
        number = chosen.index(row)
        value, uncertainty = _read(found, test, row, column, at, hammer)
        told = f"{source}, {held.responses[number].name} at {at:.4g} Hz"
        if not below and not robot.is_damped:
            # How well the damping is known is in the peaks of the models.
            ratio = test.ratios[column]
            uncertainty = hypot(uncertainty, abs(value) * found.scatter[1, column] / ratio)
            told += f", models damped as measured ({100.0 * ratio:.3g} %)"
        plain = Measured(quantity, abs(value), uncertainty, told, test.pose, test=held)
        phase = float(np.angle(value))
        frequency = at if below else None
        yield replace(plain, column=column, response=number, phase=phase, frequency=frequency)


def _of_tool(
    found: TestedModes, test: ModalTest, row: int, hammer: Hammer, robot: Mechanism, source: str
) -> Iterator[Measured]:
    """What a response says of [[responses]], if it is the tool's to a force at it along theirs."""
    ends, tool = hammer.freedoms(found.ends[row]), robot.tool
    apart = np.abs(ends.places - robot.bodies[tool.body].interfaces[tool.point].position)
    quantities = {
        (quantity.key, quantity.kind): quantity
        for quantity in response_quantities(robot.judged_responses)
    }
    for asked in robot.excitations:
        along = np.abs(ends.directions @ asked.direction)
        if {*ends.bodies} != {tool.body} or max(apart.max(), np.ptp([*along, 1.0])) > _SAME:
            continue
        sizes, told = test.frequencies, {}
        inside = np.flatnonzero((asked.first <= sizes) & (sizes <= asked.last))
        tops = sizes * np.sqrt(1.0 - 2.0 * test.ratios**2)
        heights = {c: _read(found, test, row, int(c), tops[c], hammer) for c in inside}
        if heights:
            highest = max(heights, key=lambda c: abs(heights[c][0]))
            told[QuantityKind.PEAK] = heights[highest]
            scatter = hypot(found.scatter[0, highest], hammer.uncertainty * tops[highest])
            told[QuantityKind.PEAK_FREQUENCY] = tops[highest], scatter
        if asked.at is not None and found.frequencies[0] <= asked.at <= found.frequencies[-1]:
            nearest = int(np.argmin(np.abs(sizes - asked.at)))
            told[QuantityKind.SIZE] = _read(found, test, row, nearest, asked.at, hammer)
        for kind, (value, uncertainty) in told.items():
            quantity = quantities[asked.name, kind]
            yield Measured(quantity, float(abs(value)), uncertainty, source, hammer.pose)


def _read(
    found: TestedModes, test: ModalTest, row: int, column: int, at: float, hammer: Hammer
) -> tuple[complex, float]:
    """A response (m/N) at a frequency (Hz) and its standard uncertainty, by the mode of a column.

    That is by what scatters about the fit, or by the coherence γ² of N averages, which leaves
    √((1 − γ²)/2γ²N) of a line (Bendat and Piersol, Random Data, 4th ed., table 9.6).
    """
    own, ratio, x = test.frequencies[column], test.ratios[column], found.frequencies
    near = np.abs(x - at) <= max(_LINES * (x[1] - x[0]), _WIDTHS * ratio * at)
    x, lines, coherence = x[near], found.receptance[row, near], found.coherence[row, near]
    swing = (own**2 - at**2 + 2j * ratio * own * at) / (own**2 - x**2 + 2j * ratio * own * x)
    columns = np.array([swing, np.ones(len(x)), (x - at) / at]).T
    weights = np.array([1.0, 1.0, 0.0]) @ np.linalg.pinv(columns)
    left = lines - columns @ (np.linalg.pinv(columns) @ lines)
    scatter = 0.5 * np.sum(np.abs(left) ** 2) / max(len(x) - 3, 1)
    incoherent = np.abs(lines) ** 2 * (1.0 / np.maximum(coherence, 1e-3) - 1.0)
    random = max(scatter, np.nan_to_num(np.mean(incoherent)) / (2.0 * hammer.averages))
    value = complex(weights @ lines)
    spread = sqrt(random * np.sum(np.abs(weights) ** 2))
    return value, hypot(spread, hammer.calibration * abs(value))


def _response(found: TestedModes, row: int, hammer: Hammer) -> MeasuredResponse:
    (moved, along), (struck, by) = found.ends[row]
    name = f"node {moved} along {'xyz'[along]} by a force at node {struck} along {'xyz'[by]}"
    ends = hammer.freedoms(found.ends[row])
    return MeasuredResponse(name, ends, found.frequencies, found.receptance[row])
