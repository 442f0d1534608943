"""Curves of all models over a number of the robot file, from units kept in a journal."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.adequacy.mechanism.compared import (
    Compared,
)
from validation.context import Preset
from validation.sweeps.journal import Journal
from validation.sweeps.runner import Executor, computed, in_turn
from validation.variations.robots import VariedModels, varied_robots


@dataclass(frozen=True, eq=False)
class VariedCurves:
    """All models over the values of a variation: compliances (SI) and frequencies (Hz)."""

    variation: Variation
    pose: tuple[float, ...]
    statics: Compared
    dynamics: Compared


def variation_study(
    robot_file: RobotFile,
    variation: Variation,
    preset: Preset,
    journal: Journal,
    executor: Executor = in_turn,
) -> VariedCurves:
    """All models of every robot of the variation, from the journal as far as it goes."""
    units = varied_robots(robot_file, variation, preset)
    found = computed(units, VariedModels, executor, journal, f"varying {variation.key}")
    return VariedCurves(
        variation,
        units[0].pose,
        _stacked(
            [(one.static, one.compliances, one.static_differences) for one in found],
            found[0].static_against,
        ),
        _stacked(
            [(one.dynamic, one.frequencies, one.dynamic_differences) for one in found],
            found[0].dynamic_against,
        ),
    )


def _stacked(rows: Sequence[tuple[Array, Array, Array]], against: int) -> Compared:
    """Curves over the values, of as many quantities as all robots have."""
    names = [str(name) for name in rows[0][0]]
    least = min(values.shape[1] for _, values, _ in rows)

    def curves(place: int) -> dict[str, Array]:
        return {
            name: np.array([row[place][number, :least] for row in rows])
            for number, name in enumerate(names)
        }

    differences = curves(2)
    reference = names[against]
    del differences[reference]
    return Compared(curves(1), differences, reference)
