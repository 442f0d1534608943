"""A comparison of two runs as text: plain tables that any terminal, pager and mail can show."""

from collections.abc import Sequence

from validation.results.compare import AdequacyChange, RunComparison, Timing
from validation.results.records import AdequacyRecord, RunRecord

# How many cases the text lists by the change of their time; --json has all of them.
_SLOWEST = 10


def as_text(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    """What changed, the gravest first."""
    blocks = [_heads(before, after, comparison), sentence(comparison)]
    if comparison.inputs and not comparison.robots:
        blocks.append(
            "The input differs: numbers are of two robots, and their differences no drift."
        )
        blocks += _block(
            "Input",
            ["key", "before", "after"],
            [[c.key, _given(c.before), _given(c.after)] for c in comparison.inputs],
        )
    blocks += _block(
        "Adequacy",
        ["model", "quantity", "before", "", "after", ""],
        [
            [c.model, c.quantity, *_judged(c.before), *_judged(c.after)]
            for c in comparison.adequacy
            if _told(c, different=bool(comparison.inputs or comparison.robots))
        ],
    )
    worst_first = sorted(comparison.verdicts, key=lambda change: not change.worse)
    blocks += _block(
        "Verdicts that changed",
        ["", "before", "after", "case"],
        [["worse" if c.worse else "", c.before, c.after, c.id] for c in worst_first],
    )
    blocks += _block(
        "Drifted beyond their uncertainty",
        ["before", "after", "drift", "allowed", "unit", "", "case"],
        [
            [
                f"{entry.before:.10g}",
                f"{entry.after:.10g}",
                f"{entry.drift:+.2g}",
                f"{entry.allowed:.2g}",
                entry.unit,
                entry.what,
                entry.id,
            ]
            for entry in comparison.drifted
        ],
    )
    blocks += _block("New cases", ["case"], [[identifier] for identifier in comparison.new])
    blocks += _block("Removed cases", ["case"], [[identifier] for identifier in comparison.removed])
    if comparison.times:
        blocks.append(_times(comparison.times))
    return "\n\n".join(blocks)


def _heads(before: RunRecord, after: RunRecord, comparison: RunComparison) -> str:
    rows = [
        [
            name,
            str(run.run.get("robot", run.run.get("robot_file", "?"))),
            str(run.run.get("preset", "?")),
            str(run.run.get("started", "frozen values")),
            f"{len(run.cases)} cases",
        ]
        for name, run in (("before", before), ("after", after))
    ]
    differs = [name.replace("_", " ") for name in comparison.circumstances]
    note = f"\nThe runs differ in {', '.join(differs)}." if differs else ""
    return table(["", "robot", "preset", "started", ""], rows) + note


def _given(value: object) -> str:
    return "not given" if value is None else str(value)


def _judged(entry: AdequacyRecord | None) -> list[str]:
    if entry is None:
        return ["", ""]
    if entry.error is None:
        return ["", entry.verdict]
    # The error of a whole displacement has no sign; its part along the load has.
    sign = "" if entry.along is not None else "+"
    along = "" if entry.along is None else f" ({100.0 * entry.along:+.2f} % along)"
    return [f"{100.0 * entry.error:{sign}.2f} %{along}", entry.verdict]


def _told(change: AdequacyChange, *, different: bool) -> bool:
    """All of different inputs; of the same input what changed its verdict."""
    before, after = change.before, change.after
    if different or before is None or after is None:
        return True
    return before.verdict != after.verdict


def sentence(comparison: RunComparison) -> str:
    """What changed, counted; of two different robots, that nothing can be."""
    if comparison.robots:
        first, second = comparison.robots
        return (
            f"Two different robots, {first} and {second}: none of their cases is better or worse, "
            "and only the adequacy of their models stands side by side."
        )
    worse = sum(change.worse for change in comparison.verdicts)
    drifted = len({entry.id for entry in comparison.drifted})
    parts = [
        f"{worse} verdicts worse" if worse != 1 else "1 verdict worse",
        f"{len(comparison.verdicts) - worse} better",
        f"{drifted} cases drifted" if drifted != 1 else "1 case drifted",
        f"{len(comparison.new)} new",
        f"{len(comparison.removed)} removed",
    ]
    return ", ".join(parts) + "."


def _times(times: Sequence[Timing]) -> str:
    foremost = sorted(times, key=lambda timing: -abs(timing.after - timing.before))[:_SLOWEST]
    rows = [
        [f"{t.before:.2f}", f"{t.after:.2f}", f"{t.after - t.before:+.2f}", t.id] for t in foremost
    ]
    total = [sum(timing.before for timing in times), sum(timing.after for timing in times)]
    rows.append([f"{total[0]:.2f}", f"{total[1]:.2f}", f"{total[1] - total[0]:+.2f}", "all"])
    heading = "Time per case (s)"
    if len(times) > len(foremost):
        heading += f", the {len(foremost)} of {len(times)} that changed most"
    return "\n".join(_block(heading, ["before", "after", "change", "case"], rows))


def _block(heading: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"{heading}\n{table(columns, rows)}"] if rows else []


def table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns set off by two blanks; numbers to the right, texts to the left."""
    lines = [list(columns), *[list(row) for row in rows]]
    widths = [max(len(line[k]) for line in lines) for k in range(len(columns))]
    numeric = [all(_is_number(row[k]) for row in rows) for k in range(len(columns))]
    return "\n".join(
        "  "
        + "  ".join(
            entry.rjust(width) if right else entry.ljust(width)
            for entry, width, right in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in lines
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
