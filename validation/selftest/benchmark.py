"""A problem with known answers, and what this program answers on this machine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from fem.calculix.run import CalculixMissing
from fem.multibody import ExudynMissing

Verdict: TypeAlias = Literal["agrees", "differs", "failed", "skipped"]


@dataclass(frozen=True)
class Compared:
    """One known number in `unit` and ours: the same within `tolerance` (relative).

    `explained` is the part of the relative difference that the two theories are known to have.
    """

    quantity: str
    unit: str
    known: float
    ours: float
    tolerance: float
    explained: float = 0.0

    @property
    def difference(self) -> float:
        """Ours less the known number, relative."""
        return self.ours / self.known - 1.0

    @property
    def agrees(self) -> bool:
        """Whether what is not explained is within the tolerance; never for what is no number."""
        return abs(self.difference - self.explained) <= self.tolerance


@dataclass(frozen=True)
class Benchmark:
    """A problem, where its numbers are from, why they may differ so far, and what compares them."""

    title: str
    problem: str
    source: str
    tolerance_reason: str
    compare: Callable[[], Sequence[Compared]]


@dataclass(frozen=True)
class Outcome:
    """What became of a benchmark; `message` says why nothing was compared."""

    benchmark: Benchmark
    compared: tuple[Compared, ...] = ()
    message: str = ""
    skipped: bool = False

    @property
    def verdict(self) -> Verdict:
        """Whether all its numbers agree, or why there are none."""
        if self.skipped:
            return "skipped"
        if self.message:
            return "failed"
        return "agrees" if all(one.agrees for one in self.compared) else "differs"


def outcome(benchmark: Benchmark) -> Outcome:
    """Compute a benchmark: whatever goes wrong on this machine is its outcome."""
    try:
        return Outcome(benchmark, tuple(benchmark.compare()))
    except (CalculixMissing, ExudynMissing) as missing:
        return Outcome(benchmark, message=str(missing), skipped=True)
    except Exception as error:  # noqa: BLE001  libraries of this machine are on trial
        return Outcome(benchmark, message=f"{type(error).__name__}: {error}")
