"""Curves of `solve --vary` over the first number, one for each combination of what else varies."""

from collections.abc import Sequence

import numpy as np

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from lumped.robot_file.places import unit_of
from lumped.robot_file.variation import Variation, told
from validation.drawing.charts.chart import Chart, Panel, Series
from validation.drawing.charts.plot import chart_png
from validation.drawing.charts.scales import few_ticks, from_zero
from validation.drawing.style import OTHERS
from validation.solve.answer import Answer
from validation.solve.variations.robots import VariedAnswers, quantities

_DOTS = 150  # per inch
# Curves that can still be told apart.
_MOST = len(OTHERS)


def require_few_curves(variations: Sequence[Variation], places: int) -> None:
    """Raise InputError where there would be more curves than can be told apart."""
    count = places
    for one in variations[1:]:
        count *= len(one.values)
    if count > _MOST:
        raise InputError(
            f"--picture: {count} curves over {variations[0].key}; must be at most {_MOST} (fewer "
            "values of the other numbers, or fewer poses)"
        )


def png(robot_file: RobotFile, found: VariedAnswers) -> bytes:
    """PNG of deflections and frequencies, a panel each."""
    first, *others = found.variations
    rows = [
        (values, answer)
        for values, solution in zip(found.values, found.solutions, strict=True)
        for answer in solution.answers
    ]
    several = len(found.solutions[0].answers) > 1
    names = [
        _curve(others, values[1:], answer if several else None) or found.solutions[0].model
        for values, answer in rows
    ]
    own = {name: [place for place, one in enumerate(names) if one == name] for name in names}
    x = np.array(first.values)
    panels = [
        Panel(
            [Series(name, x, np.array(numbers)[places]) for name, places in own.items()],
            heading,
            scale=from_zero,
        )
        for heading, numbers in quantities([answer for _, answer in rows]).items()
    ]
    unit = unit_of(robot_file.tables, first.keys[0])
    label = f"{first.key} ({unit})" if unit else first.key
    return chart_png(Chart(panels, label, x_scale=few_ticks), _DOTS)


def _curve(others: Sequence[Variation], values: Sequence[float], answer: Answer | None) -> str:
    """What tells a curve from the others: the values of the other numbers, and the place."""
    said = [told(others, values)] if others else []
    if answer is not None:
        ((name, place),) = answer.place.items()
        numbers = place if isinstance(place, list) else [place]
        said.append(f"{name} {', '.join(f'{value:.4g}' for value in numbers)}")
    return "; ".join(said)
