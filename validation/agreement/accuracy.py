"""Accuracy on demand: finer and finer meshes, until what they leave open is little enough.

What is stated is never more than was shown: an accuracy that memory or time do not allow is
reported as missed, with what was reached and why it ended there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

from lumped.errors import ComputationError, InputError

# Seconds after which nothing finer is begun that would take as long again.
PATIENCE = 600.0
# Between two meshes a solid has some eight times as many elements.
_GROWTH = 8.0

# Beyond these nothing is refined, or nothing could be.
_FINEST, _COARSEST = 1e-6, 0.5

M = TypeVar("M")
A = TypeVar("A")


@dataclass(frozen=True)
class Accuracy:
    """What was asked for and reached, relative half-widths of 95 % intervals.

    `missed` says why it ended before, "" where it did not.
    """

    asked: float
    reached: float
    missed: str = ""

    @property
    def text(self) -> str:
        """A line for people."""
        said = f"accuracy ±{100.0 * self.reached:.2g} %, asked for ±{100.0 * self.asked:.2g} %"
        return f"{said}; {self.missed}" if self.missed else said


def refined(
    mesh: M,
    compute: Callable[[M], A],
    left_open: Callable[[A], float],
    finer: Callable[[M, float], M],
    asked: float,
    patience: float = PATIENCE,
) -> tuple[A, Accuracy]:
    """What `compute` gives on the first mesh whose answer leaves at most `asked` open.

    `left_open` is the largest relative half-width in an answer, `finer` the next mesh where that is
    so many times what was asked; it raises InputError, as `compute` may, where there is none or not
    memory enough: the last answer then stands.
    """
    begun = perf_counter()
    answer = compute(mesh)
    while (reached := left_open(answer)) > asked:
        took = perf_counter() - begun
        if took * _GROWTH > patience:
            return answer, Accuracy(asked, reached, f"a finer mesh would take over {patience:g} s")
        try:
            mesh = finer(mesh, reached / asked)
            begun = perf_counter()
            answer = compute(mesh)
        except (ComputationError, InputError) as error:
            return answer, Accuracy(asked, reached, str(error))
    return answer, Accuracy(asked, reached)


def accuracy_faults(asked: float) -> list[str]:
    """What is wrong with an accuracy that is asked for, a line or none."""
    if _FINEST <= asked <= _COARSEST:
        return []
    return [f"--accuracy = {asked:g}: must be from {_FINEST:g} to {_COARSEST:g} (0.002 is 0.2 %)"]
