"""The command `selftest`: known numbers beside those of this machine, as a table."""

from time import perf_counter
from typing import TYPE_CHECKING

from fem.machine import TO_COMPUTE, require_room
from fem.solvers.backends.choice import request_solver
from validation.console.streams import write_results
from validation.console.typed import SolverName

if TYPE_CHECKING:
    from validation.selftest.benchmarks import BenchmarkOutcome

_ROW = "  {:<62} {:>16} {:>13} {:>11} {:>11}  {}"


def selftest(*, solver: SolverName = None) -> int:
    """Solve published benchmarks here: solvers, meshers and programs beside flexproof.

    Exit code 1 where a number differs or cannot be computed. Reports of runs say when it passed.
    """
    from fem.solvers.backends.choice import solver_name  # noqa: PLC0415
    from validation.run.provenance import keep_selftest, machine, versions  # noqa: PLC0415
    from validation.selftest.benchmarks import benchmarks, outcome  # noqa: PLC0415

    require_room(TO_COMPUTE)
    request_solver(solver)
    begun = perf_counter()
    write_results(_ROW.format("", "known", "here", "difference", "explained", ""))
    outcomes = []
    for benchmark in benchmarks():
        outcomes.append(outcome(benchmark))
        write_results(_text(outcomes[-1]))
    bad = sum(one.verdict in {"differs", "failed"} for one in outcomes)
    keep_selftest(passed=not bad)
    numbers = [compared for one in outcomes for compared in one.compared]
    agreeing = sum(one.agrees for one in numbers)
    skipped = [one.benchmark.title for one in outcomes if one.verdict == "skipped"]
    write_results(
        f"\nselftest {'FAILED' if bad else 'passed'}: {agreeing} of {len(numbers)} numbers agree"
        + (f"; skipped: {', '.join(skipped)}" if skipped else "")
        + f" ({perf_counter() - begun:.0f} s)\n"
        f"flexproof {versions().get('flexproof', '')}, {machine()}, {solver_name()}"
    )
    return int(bad > 0)


def _text(found: "BenchmarkOutcome") -> str:
    """The benchmark, its source, and its numbers or why there are none."""
    rows = [
        _ROW.format(
            one.quantity,
            f"{one.known:.6g} {one.unit}".removesuffix(" 1"),
            f"{one.ours:.6g}",
            f"{one.difference:+.1e}",
            f"{one.explained:+.1e}" if one.explained else "",
            "agrees" if one.agrees else "DIFFERS",
        )
        for one in found.compared
    ]
    rows += [f"  {found.verdict}: {found.message}"] if found.message else []
    return "\n".join([f"\n{found.benchmark.title}\n  {found.benchmark.source}", *rows])
