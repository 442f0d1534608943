"""Cost of a model, estimated before it is built: unknowns, memory and time.

Input: legs, divisions or elements, and the number of modes. Output: `Cost`, or InputError if it
exceeds memory or the time limit. The unknowns of a solid follow from the blocks of its section; the
cost of its factorisation was measured on legs of all shapes. Times are for one ordinary core,
within a factor of three.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

from fem.machine import available_memory
from lumped.errors import InputError
from lumped.legs import SectionedLeg
from validation.models.options import OF_ELEMENTS
from validation.solids.solid_size import solid_unknowns
from validation.solve.question import Question

# Solid leg with n unknowns: entries of the factorised matrix in n^(4/3), measured as 9 to 14 for
# legs of all shapes with 3000 to 120 000 unknowns; bytes per entry at the peak of a factorisation,
# copies included; flops of a factorisation in entries²/n.
_ENTRIES, _BYTES_PER_ENTRY, _FLOPS = 12.0, 23.0, 1.7
# Memory (bytes) of stiffness and mass at the peak of assembly, and time (s), per unknown of a
# solid.
_BYTES_PER_UNKNOWN, _SECONDS_PER_UNKNOWN = 10_000.0, 8e-5
_FLOPS_PER_SECOND = 5e9
# Right-hand sides solved for modes: a fixed number of Lanczos vectors, and more for each mode.
_SOLVES, _SOLVES_PER_MODE = 100, 10
# Dense models with n unknowns: n×n matrices in memory at once; flops of all eigenvalues in n³.
_DENSE_COPIES, _DENSE_FLOPS = 6.0, 12.0
# Limits (s) on the estimated time of one answer, and of one more mesh for --accuracy.
LONGEST, LONGEST_REFINEMENT = 3600.0, 600.0
_HOUR = 3600.0
# Time (s) for a CAD part that is not in the cache.
PER_PART = 15.0


@dataclass(frozen=True)
class Cost:
    """Estimated cost: `unknowns` of the largest system, peak `memory` (bytes), total `seconds`."""

    unknowns: float
    memory: float
    seconds: float

    @property
    def size(self) -> str:
        """Size of the computation as text, such as "about 22 000 unknowns, 0.3 GB"."""
        return f"about {self.unknowns:.2g} unknowns, {self.memory / 1e9:.2g} GB"

    def __str__(self) -> str:
        """Size and time of the computation, such as "about 22 000 unknowns, 0.3 GB and 12 s"."""
        hours = self.seconds / _HOUR
        time = f"{self.seconds:.2g} s" if self.seconds < _HOUR else f"{hours:.3g} h"
        return f"{self.size} and {time}"


def solid_cost(legs: Sequence[SectionedLeg], divisions: int, modes: int) -> Cost:
    """Cost of the compliance and the first `modes` modes of each solid leg.

    All legs are in memory at the same time.
    """
    sizes = [solid_unknowns(leg, divisions) for leg in legs]
    entries = [_ENTRIES * n ** (4.0 / 3.0) for n in sizes]
    memory = sum(
        _BYTES_PER_ENTRY * L + (_BYTES_PER_UNKNOWN + 24.0 * modes) * n
        for n, L in zip(sizes, entries, strict=True)
    )
    solves = (_SOLVES + _SOLVES_PER_MODE * modes) if modes else 12
    flops = sum(_FLOPS * L**2 / n + 4.0 * solves * L for n, L in zip(sizes, entries, strict=True))
    seconds = _SECONDS_PER_UNKNOWN * sum(sizes) + flops / _FLOPS_PER_SECOND
    return Cost(sum(sizes), memory, seconds)


def dense_cost(unknowns: int, legs: int) -> Cost:
    """Cost of compliance and modes of each of several `legs`, with dense matrices."""
    n = float(unknowns)
    seconds = legs * _DENSE_FLOPS * n**3 / _FLOPS_PER_SECOND
    return Cost(n, 8.0 * _DENSE_COPIES * n**2, seconds)


def require_affordable(cost: Cost, subject: str, longest: float = LONGEST) -> None:
    """Raise InputError if a cost exceeds the available memory or the time `longest` (s).

    The message contains the estimated cost. `subject`: beginning of the message.
    """
    available = available_memory() or inf
    if cost.memory > available:
        raise InputError(
            f"{subject}: needs {cost}, but {available / 1e9:.2g} GB of memory are "
            "available; choose a coarser mesh"
        )
    if cost.seconds > longest:
        minutes = longest / 60.0
        raise InputError(
            f"{subject}: needs {cost}, more than the allowed {minutes:g} minutes; choose a "
            "coarser mesh"
        )


def question_cost(question: Question, longest: float = LONGEST) -> Cost:
    """Cost of the answer to a question: of its distinct legs and of the CAD parts.

    Raises InputError if that of the legs exceeds the available memory or `longest` (s).
    """
    model, options = question.model, question.options
    seconds = PER_PART * len(question.mechanism.parts)
    if model == "solid":
        option = "divisions"
        cost = solid_cost(question.legs, options.divisions, question.count)
    elif model in OF_ELEMENTS:
        option = "elements"
        # Legs are reduced one by one and are small then.
        cost = dense_cost(6 * (options.elements + 1), len(question.legs))
    else:
        return Cost(0.0, 0.0, seconds)
    require_affordable(cost, f"--{option} {getattr(options, option)}", longest)
    return replace(cost, seconds=cost.seconds + seconds)


def is_affordable(question: Question, divisions: int) -> bool:
    """True if the question could be solved with these `divisions` at an acceptable cost."""
    try:
        question_cost(question.with_divisions(divisions))
    except InputError:
        return False
    return True


def first_affordable(questions: Sequence[Question]) -> Question:
    """First question with an affordable mesh. Raises the first InputError if there is none."""
    refused = []
    for question in questions:
        try:
            question_cost(question, LONGEST_REFINEMENT)
        except InputError as error:
            refused.append(error)
        else:
            return question
    raise refused[0]
