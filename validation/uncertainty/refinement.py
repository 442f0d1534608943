"""Refinement on demand: finer meshes until the half-widths of all numbers are small enough.

The result states the accuracy that was reached. If a finer mesh is too large, the requested
accuracy is reported as missed, with the reason. The size of the meshes decides, never the
computing time: results do not depend on the load of the machine.
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
        """One line for the user."""
        summary = f"accuracy ±{100.0 * self.reached:.2g} %, asked for ±{100.0 * self.asked:.2g} %"
        return f"{summary}; {self.missed}" if self.missed else summary


def refined(
    mesh: M,
    compute: Callable[[M], A],
    largest_half_width: Callable[[A], float],
    finer: Callable[[M, float], M],
    requested: float,
) -> tuple[A, Accuracy]:
    """Answer on the first mesh whose largest half-width is at most `requested`.

    `largest_half_width` returns the largest relative half-width in an answer, `finer` the next mesh
    if that half-width is a given multiple of `requested`. If `finer` or `compute` raises InputError
    or ComputationError, because there is no finer mesh or it is too large, the last answer stands.
    """
    answer = compute(mesh)
    while (reached := largest_half_width(answer)) > requested:
        try:
            mesh = finer(mesh, reached / requested)
            answer = compute(mesh)
        except (ComputationError, InputError) as error:
            return answer, Accuracy(requested, reached, str(error))
    return answer, Accuracy(requested, reached)


def accuracy_faults(requested: float) -> list[str]:
    """Fault of a requested accuracy as one line. Empty if it is valid."""
    if _FINEST <= requested <= _COARSEST:
        return []
    return [
        f"--accuracy = {requested:g}: must be from {_FINEST:g} to {_COARSEST:g} (0.002 is 0.2 %)"
    ]
