"""What became of the faults of a run, read off the outcomes of their cases.

Apart from the faults themselves, which whoever reads a run has no need of.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from validation.case import Case
from validation.results.outcome import Outcome

# Columns of the table that comes with the case of a fault, and who noticed it where nobody did.
CASES, GROUPS, VERDICTS = "caught by", "group", "verdict"
NONE = "–"
# What the ids of faults begin with, for who names them by a pattern.
PREFIX = "fault."


@dataclass(frozen=True)
class Detection:
    """A fault and what noticed it: case ids, and how many of them by group that was asked."""

    id: str
    title: str
    caught_by: tuple[str, ...]
    asked: Mapping[str, int]

    @property
    def thin_ice(self) -> bool:
        """Caught by a single case."""
        return len(self.caught_by) == 1


@dataclass(frozen=True)
class Power:
    """What became of all faults of a run."""

    detections: tuple[Detection, ...]

    @property
    def survivors(self) -> tuple[Detection, ...]:
        """Faults that nothing noticed."""
        return tuple(one for one in self.detections if not one.caught_by)

    @property
    def thin_ice(self) -> tuple[Detection, ...]:
        """Faults that a single case noticed."""
        return tuple(one for one in self.detections if one.thin_ice)

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups that were asked, in the order in which they first were."""
        return tuple(dict.fromkeys(name for one in self.detections for name in one.asked))

    @property
    def sentence(self) -> str:
        """The whole in one sentence."""
        count, lost = len(self.detections), len(self.survivors)
        caught = "all caught" if not lost else f"{lost} not caught"
        thin = len(self.thin_ice)
        return f"{count} faults injected, {caught}, {thin} by a single comparison."

    def records(self) -> list[dict[str, Any]]:
        """The "faults" of results.json."""
        return [
            {"id": one.id, "title": one.title, "caught_by": list(one.caught_by)}
            for one in self.detections
        ]


def is_fault(case: Case) -> bool:
    """Whether a case says whether a fault is noticed."""
    return case.subject == "faults"


def names_faults(pattern: str) -> bool:
    """Whether a pattern of ids is meant for faults."""
    return pattern.startswith(PREFIX)


def detection_power(outcomes: Iterable[Outcome]) -> Power:
    """What the outcomes of fault cases say, in their order.

    Other outcomes are passed over, and faults that this run had nothing to notice them with.
    """
    return Power(
        tuple(
            _detection(outcome)
            for outcome in outcomes
            if is_fault(outcome.case) and outcome.verdict != "skipped"
        )
    )


def comparisons(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """The outcomes that are not those of faults."""
    return [outcome for outcome in outcomes if not is_fault(outcome.case)]


def _detection(outcome: Outcome) -> Detection:
    table = outcome.measurement.table if outcome.measurement else {}
    rows = list(zip(table.get(CASES, ()), table.get(GROUPS, ()), strict=True))
    asked = {str(group): 0 for _, group in rows}
    for case, group in rows:
        asked[str(group)] += case != NONE
    caught_by = tuple(str(case) for case, _ in rows if case != NONE)
    return Detection(outcome.case.row, outcome.case.title, caught_by, asked)
