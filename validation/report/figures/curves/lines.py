"""A line per model: its look, what it computes, and curves in words.

A further model joins every figure by its entry in `STATIC_LINES` or `DYNAMIC_LINES`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from validation.drawing.chart import Series
from validation.drawing.style import BLUE, LOOKS, PURPLE, Look
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions

ALPHA_LABEL = "relative leg length α"
PLACES = {"centre": "centre of the stroke", "left": "left end", "right": "right end"}
T = TypeVar("T")


@dataclass(frozen=True)
class Line:
    """One model in a figure; `width` (pt) shrinks from the bottom of a stack to its top.

    `fill` is the colour inside its markers.
    """

    label: str
    model: ModelName
    look: Look
    options: ModelOptions = DEFAULT_OPTIONS
    width: float = 1.6
    fill: str = "white"

    def series(self, x: Array, y: Array, quantity: str) -> Series:
        """Its curve of a quantity."""
        return Series(self.label, x, y, self.look, self.width, quantity, self.fill)


SIMPLIFIED = Line("simplified", "simplified", LOOKS["simplified"])
VJM_GIVEN = Line("VJM, legs as given", "vjm", LOOKS["vjm"], fill=BLUE)
VJM_EQUIVALENT = Line(
    "VJM, equivalent legs",
    "vjm",
    LOOKS["vjm-equivalent"],
    ModelOptions(legs="equivalent"),
    width=3.6,
)
SEGMENTS = Line("segments", "segments", LOOKS["segments"], width=2.4)
SEGMENTS_PRINTED = Line(
    "segments, eq. (25) as printed",
    "segments",
    LOOKS["segments-printed"],
    ModelOptions(release="printed"),
    fill=PURPLE,
)
BEAM = Line("beam FE", "beam", LOOKS["beam"], width=1.2)

# From the bottom of the stack to its top.
STATIC_LINES = (SIMPLIFIED, VJM_GIVEN, VJM_EQUIVALENT, SEGMENTS, BEAM)
DYNAMIC_LINES = (SIMPLIFIED, SEGMENTS, BEAM)


@dataclass(frozen=True)
class Gathered(Generic[T]):
    """What each line's model computed; `notes` name the models that could not."""

    values: Mapping[Line, T]
    notes: tuple[str, ...] = ()


def gather(lines: Sequence[Line], compute: Callable[[Line], T]) -> Gathered[T]:
    """`compute(line)` of every line; a model that fails is left out with a note.

    Raises ComputationError where every model fails.
    """
    values, notes = {}, []
    for line in lines:
        try:
            values[line] = compute(line)
        except ComputationError as error:
            notes.append(f"Left out: {line.label} ({error}).")
    if not values:
        raise ComputationError(" ".join(notes))
    return Gathered(values, tuple(notes))


def as_in_paper(*numbers: int) -> str:
    """The end of a title: the curves of this robot that the paper draws of its own."""
    figures = " and ".join(str(number) for number in numbers)
    return f"(as the paper's {'Fig.' if len(numbers) == 1 else 'Figs'} {figures})"


def course(curve: Array) -> str:
    """What a curve does throughout: "rises", "falls", or without a fixed direction "goes"."""
    steps = np.diff(curve)
    if np.all(steps > 0.0):
        return "rises"
    return "falls" if np.all(steps < 0.0) else "goes"


def spread(curves: Sequence[Array]) -> float:
    """Largest difference between curves on the same points, relative to the largest value."""
    stacked = np.array(curves)
    return float(np.max(np.ptp(stacked, axis=0)) / np.max(np.abs(stacked)))


def accuracy(difference: float) -> str:
    """A relative difference in words: percent, or its power of ten below 0.01 %."""
    if difference >= 1e-4:
        return f"{100.0 * difference:.2g} %"
    if difference < 1e-8:
        return "less than 1e-8"
    return f"{difference:.0e}"
