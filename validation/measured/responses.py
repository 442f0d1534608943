"""Frequency responses of a modal test as measured values: at modes, and far below all modes.

Input: frequency response functions of a test. Output: measured receptances with standard
uncertainties. Rule: near a frequency, the lines of the spectrum are fitted by one damped mode plus
a straight line; the fit interpolates between the lines and yields their scatter.
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

# Range of fitted lines around a frequency: at least this many lines, and this many half-widths of
# the peak, on each side.
_FEWEST_LINES, _FITTED_WIDTHS = 4.5, 2.0
# Fraction of the lowest frequency at which the response far below the modes is read. The response
# is an eighth larger there than the static one.
_LOW_SHARE = 1.0 / 3.0
# Directions, and positions (m), count as equal up to this difference.
_ROUND_OFF = 1e-6


def measured_responses(
    tested: TestedModes,
    test: ModalTest,
    numbers: Mapping[int, int],
    hammer: Hammer,
    robot: Mechanism,
    source: str,
) -> Iterator[Measured]:
    """Measured values from the responses of a test.

    At each mode, and far below all modes, the response with the largest magnitude is used.
    Quantities of [[responses]] are taken from a response of the tool to a force on it. `numbers`:
    number of the robot's mode for each measured mode, by the mode's column in the arrays of the
    test. `hammer`: table [hammer] of the robot file. `source`: name of the test's file.
    """
    located = np.isin(tested.ends[:, :, 0], list(hammer.nodes)).all(axis=1)
    rows = [int(row) for row in np.flatnonzero(located)]
    for row in rows:
        yield from _tool_quantities(tested, test, row, hammer, robot, source)
    if not (rows and numbers):
        return
    frequencies, first = test.frequencies, min(numbers)
    targets = [(size_at_mode(numbers[c]), c, float(frequencies[c]), False) for c in sorted(numbers)]
    if (low := _LOW_SHARE * float(frequencies[first])) >= tested.frequencies[0]:
        targets.append((SIZE_FAR_BELOW, first, low, True))
    largest = [
        max(
            rows,
            key=lambda row: abs(_fitted_value(tested, test, row, column, frequency, hammer)[0]),
        )
        for _, column, frequency, _ in targets
    ]
    used_rows = list(dict.fromkeys(largest))
    test_with_responses = replace(
        test, responses=tuple(_measured_response(tested, row, hammer) for row in used_rows)
    )
    for (quantity, column, frequency, below), row in zip(targets, largest, strict=True):
        number = used_rows.index(row)
        value, uncertainty = _fitted_value(tested, test, row, column, frequency, hammer)
        description = (
            f"{source}, {test_with_responses.responses[number].name} at {frequency:.4g} Hz"
        )
        if not below and not robot.is_damped:
            # Models get the measured damping ratio, so their peaks have its uncertainty.
            ratio = test.ratios[column]
            uncertainty = hypot(uncertainty, abs(value) * tested.scatter[1, column] / ratio)
            description += f", models damped as measured ({100.0 * ratio:.3g} %)"
        size = Measured(
            quantity, abs(value), uncertainty, description, test.pose, test=test_with_responses
        )
        phase = float(np.angle(value))
        prescribed = frequency if below else None
        yield replace(size, column=column, response=number, phase=phase, frequency=prescribed)


def _tool_quantities(
    tested: TestedModes, test: ModalTest, row: int, hammer: Hammer, robot: Mechanism, source: str
) -> Iterator[Measured]:
    """Measured values of [[responses]], from a response of the tool to a force on it.

    Nothing is yielded if response number `row` belongs to another point or direction.
    """
    ends, tool = hammer.freedoms(tested.ends[row]), robot.tool
    offsets = np.abs(ends.places - robot.bodies[tool.body].interfaces[tool.point].position)
    quantities = {
        (quantity.key, quantity.kind): quantity
        for quantity in response_quantities(robot.judged_responses)
    }
    for excitation in robot.excitations:
        if not excitation.is_direct:
            continue
        alignments = np.abs(ends.directions @ excitation.direction)
        if {*ends.bodies} != {tool.body} or max(
            offsets.max(), np.ptp([*alignments, 1.0])
        ) > _ROUND_OFF:
            continue
        sizes, values = test.frequencies, {}
        inside = np.flatnonzero((excitation.first <= sizes) & (sizes <= excitation.last))
        tops = sizes * np.sqrt(1.0 - 2.0 * test.ratios**2)
        heights = {c: _fitted_value(tested, test, row, int(c), tops[c], hammer) for c in inside}
        if heights:
            highest = max(heights, key=lambda c: abs(heights[c][0]))
            values[QuantityKind.PEAK] = heights[highest]
            scatter = hypot(tested.scatter[0, highest], hammer.uncertainty * tops[highest])
            values[QuantityKind.PEAK_FREQUENCY] = tops[highest], scatter
        if (
            excitation.at is not None
            and tested.frequencies[0] <= excitation.at <= tested.frequencies[-1]
        ):
            nearest = int(np.argmin(np.abs(sizes - excitation.at)))
            values[QuantityKind.SIZE] = _fitted_value(
                tested, test, row, nearest, excitation.at, hammer
            )
        for kind, (value, uncertainty) in values.items():
            quantity = quantities[excitation.name, kind]
            yield Measured(quantity, float(abs(value)), uncertainty, source, hammer.pose)


def _fitted_value(
    tested: TestedModes, test: ModalTest, row: int, column: int, frequency: float, hammer: Hammer
) -> tuple[complex, float]:
    """Receptance (m/N, complex) at a frequency (Hz), and its standard uncertainty, by a fit.

    The fit uses the spectral lines of response number `row` near the frequency, and the damped mode
    number `column` of the test. The uncertainty has two independent parts. The first is the larger
    of the scatter about the fit and of √((1 − γ²)/(2γ²N)) of a spectral line due to the coherence
    γ² of N averages (Bendat and Piersol, Random Data, 4th ed., table 9.6). The second is the
    calibration of the hammer.
    """
    natural, ratio, line_frequencies = (
        test.frequencies[column],
        test.ratios[column],
        tested.frequencies,
    )
    near = np.abs(line_frequencies - frequency) <= max(
        _FEWEST_LINES * (line_frequencies[1] - line_frequencies[0]),
        _FITTED_WIDTHS * ratio * frequency,
    )
    line_frequencies, spectral_lines, coherence = (
        line_frequencies[near],
        tested.receptance[row, near],
        tested.coherence[row, near],
    )
    modal = (natural**2 - frequency**2 + 2j * ratio * natural * frequency) / (
        natural**2 - line_frequencies**2 + 2j * ratio * natural * line_frequencies
    )
    columns = np.array(
        [modal, np.ones(len(line_frequencies)), (line_frequencies - frequency) / frequency]
    ).T
    weights = np.array([1.0, 1.0, 0.0]) @ np.linalg.pinv(columns)
    residuals = spectral_lines - columns @ (np.linalg.pinv(columns) @ spectral_lines)
    scatter = 0.5 * np.sum(np.abs(residuals) ** 2) / max(len(line_frequencies) - 3, 1)
    incoherent = np.abs(spectral_lines) ** 2 * (1.0 / np.maximum(coherence, 1e-3) - 1.0)
    random = max(scatter, np.nan_to_num(np.mean(incoherent)) / (2.0 * hammer.averages))
    value = complex(weights @ spectral_lines)
    spread = sqrt(random * np.sum(np.abs(weights) ** 2))
    return value, hypot(spread, hammer.calibration * abs(value))


def _measured_response(tested: TestedModes, row: int, hammer: Hammer) -> MeasuredResponse:
    (response_node, response_axis), (force_node, force_axis) = tested.ends[row]
    name = (
        f"node {response_node} along {'xyz'[response_axis]} "
        f"by a force at node {force_node} along {'xyz'[force_axis]}"
    )
    ends = hammer.freedoms(tested.ends[row])
    return MeasuredResponse(name, ends, tested.frequencies, tested.receptance[row])
