"""Command `selftest` of the command line.

Input: options of the solver. Output: a table of known numbers and those computed on this machine,
and exit code 1 if one differs.
"""

from time import perf_counter
from typing import TYPE_CHECKING

from fem.machine import TO_COMPUTE, require_room
from validation.console.streams import write_results
from validation.console.typed import DEFAULT_SOLVER, SolverChoice

if TYPE_CHECKING:
    from validation.selftest.benchmarks import BenchmarkOutcome

_ROW = "  {:<62} {:>16} {:>13} {:>11} {:>11}  {}"


def selftest(*, solver: SolverChoice = DEFAULT_SOLVER) -> int:
    """Solve published benchmarks on this machine, to test its solvers, meshers and programs.

    Exit code 1 if a number differs or cannot be computed. Reports of runs contain the date and the
    result of the last selftest.
    """
    from fem.solvers.backends.choice import solver_name  # noqa: PLC0415
    from validation.run.provenance import keep_selftest, machine, versions  # noqa: PLC0415
    from validation.selftest.benchmarks import benchmarks, outcome  # noqa: PLC0415

    require_room(TO_COMPUTE)
    solver.request()
    start = perf_counter()
    write_results(_ROW.format("", "known", "here", "difference", "explained", ""))
    outcomes = []
    for benchmark in benchmarks():
        outcomes.append(outcome(benchmark))
        write_results(_text(outcomes[-1]))
    failures = sum(result.verdict in {"differs", "failed"} for result in outcomes)
    keep_selftest(passed=not failures)
    numbers = [number for result in outcomes for number in result.numbers]
    agreeing = sum(number.agrees for number in numbers)
    skipped = [result.benchmark.title for result in outcomes if result.verdict == "skipped"]
    write_results(
        f"\nselftest {'FAILED' if failures else 'passed'}: "
        f"{agreeing} of {len(numbers)} numbers agree"
        + (f"; skipped: {', '.join(skipped)}" if skipped else "")
        + f" ({perf_counter() - start:.0f} s)\n"
        f"flexproof {versions().get('flexproof', '')}, {machine()}, {solver_name()}"
    )
    return int(failures > 0)


def _text(result: "BenchmarkOutcome") -> str:
    """Title and source of a benchmark, and its numbers or the reason why there are none."""
    rows = [
        _ROW.format(
            number.quantity,
            f"{number.known:.6g} {number.unit}".removesuffix(" 1"),
            f"{number.computed:.6g}",
            f"{number.difference:+.1e}",
            f"{number.explained:+.1e}" if number.explained else "",
            "agrees" if number.agrees else "DIFFERS",
        )
        for number in result.numbers
    ]
    rows += [f"  {result.verdict}: {result.message}"] if result.message else []
    return "\n".join([f"\n{result.benchmark.title}\n  {result.benchmark.source}", *rows])
