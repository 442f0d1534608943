"""Refinement of meshes until the half-widths of all numbers reach a requested accuracy.

Input: a mesh, functions that solve and refine it, and the requested relative half-width. Output:
the last solution, and the accuracy that was reached. Rule: refinement ends when the accuracy is
reached or a finer mesh is too large; if a finer mesh is too large, the request is reported as
missed, with the reason. The size of meshes decides, never the computing time, so results do not
depend on the load of the machine.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from lumped.errors import ComputationError, InputError

# Range of accuracies that can be requested: from round-off to no accuracy at all.
_FINEST, _COARSEST = 1e-6, 0.5

M = TypeVar("M")
A = TypeVar("A")


@dataclass(frozen=True)
class Accuracy:
    """Requested and reached accuracy, as relative half-widths of 95 % intervals.

    `missed`: reason why no finer mesh was computed. "" if the request is met.
    """

    requested: float
    reached: float
    missed: str = ""

    @property
    def text(self) -> str:
        """Line of the report with the requested and the reached accuracy."""
        summary = (
            f"accuracy ±{100.0 * self.reached:.2g} %, requested ±{100.0 * self.requested:.2g} %"
        )
        return f"{summary}; {self.missed}" if self.missed else summary


def refined(
    mesh: M,
    compute: Callable[[M], A],
    largest_half_width: Callable[[A], float],
    finer: Callable[[M, float], M],
    requested: float,
) -> tuple[A, Accuracy]:
    """Solution on the first mesh whose largest half-width is at most `requested`.

    `largest_half_width` returns the largest relative half-width of a solution. `finer` returns the
    next mesh, given the ratio of that half-width to `requested`. If `finer` or `compute` raises
    InputError or ComputationError, because no finer mesh exists or it is too large, the last
    solution is returned.
    """
    solution = compute(mesh)
    while (reached := largest_half_width(solution)) > requested:
        try:
            mesh = finer(mesh, reached / requested)
            solution = compute(mesh)
        except (ComputationError, InputError) as error:
            return solution, Accuracy(requested, reached, str(error))
    return solution, Accuracy(requested, reached)


def accuracy_faults(requested: float) -> list[str]:
    """Error message (one line) for an invalid accuracy. [] if it is valid."""
    if _FINEST <= requested <= _COARSEST:
        return []
    return [
        f"--accuracy = {requested:g}: must be from {_FINEST:g} to {_COARSEST:g} (0.002 is 0.2 %)"
    ]
