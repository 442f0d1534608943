"""A problem with known answers, and what this program answers on this machine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from fem.calculix.run import CalculixMissing
from fem.multibody import ExudynMissing


@dataclass(frozen=True)
class KnownNumber:
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
    compare: Callable[[], Sequence[KnownNumber]]


@dataclass(frozen=True)
class BenchmarkOutcome:
    """What became of a benchmark; `message` says why nothing was compared."""

    benchmark: Benchmark
    verdict: Literal["agrees", "differs", "failed", "skipped"]
    compared: tuple[KnownNumber, ...] = ()
    message: str = ""


def outcome(benchmark: Benchmark) -> BenchmarkOutcome:
    """Compute a benchmark: whatever goes wrong on this machine is its outcome."""
    try:
        compared = tuple(benchmark.compare())
    except (CalculixMissing, ExudynMissing) as missing:
        return BenchmarkOutcome(benchmark, "skipped", message=str(missing))
    except Exception as error:  # noqa: BLE001  libraries of this machine are on trial
        return BenchmarkOutcome(benchmark, "failed", message=f"{type(error).__name__}: {error}")
    # A benchmark that compared nothing has shown nothing.
    agrees = bool(compared) and all(one.agrees for one in compared)
    return BenchmarkOutcome(benchmark, "agrees" if agrees else "differs", compared)
