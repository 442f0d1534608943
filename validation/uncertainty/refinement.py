"""Refinement on demand: finer meshes until the half-widths of all numbers are small enough.

The result states the accuracy that was reached. If a finer mesh is too large, the requested
accuracy is reported as missed, with the reason. The size of the meshes decides, never the time
that they took: results do not depend on how busy a machine is.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from lumped.errors import ComputationError, InputError

# Finest and coarsest accuracy that can be requested: round-off, and no accuracy at all.
_FINEST, _COARSEST = 1e-6, 0.5

M = TypeVar("M")
A = TypeVar("A")


@dataclass(frozen=True)
class Accuracy:
    """Requested and reached accuracy, relative half-widths of 95 % intervals.

    `missed`: the reason why no finer mesh was computed. "" if the request is met.
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
) -> tuple[A, Accuracy]:
    """Answer on the first mesh whose largest half-width is at most `asked`.

    `left_open` returns the largest relative half-width in an answer, `finer` the next mesh if that
    half-width is a given multiple of `asked`. If `finer` or `compute` raises InputError or
    ComputationError, because there is no finer mesh or it is too large, the last answer stands.
    """
    answer = compute(mesh)
    while (reached := left_open(answer)) > asked:
        try:
            mesh = finer(mesh, reached / asked)
            answer = compute(mesh)
        except (ComputationError, InputError) as error:
            return answer, Accuracy(asked, reached, str(error))
    return answer, Accuracy(asked, reached)


def accuracy_faults(asked: float) -> list[str]:
    """What is wrong with an accuracy that is asked for, a line or none."""
    if _FINEST <= asked <= _COARSEST:
        return []
    return [f"--accuracy = {asked:g}: must be from {_FINEST:g} to {_COARSEST:g} (0.002 is 0.2 %)"]
