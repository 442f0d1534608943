"""The comparisons by what their two sides rest on, from the program's check that listed them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from validation.independence.listing import NOTHING, SECTION, Row, from_table
from validation.results.outcome import Outcome


@dataclass(frozen=True)
class Number:
    """A headline number with the comparisons that are about it."""

    shown: str
    number: str
    rows: tuple[Row, ...]

    @property
    def has_independent(self) -> bool:
        """Whether two sides of one of them share nothing."""
        return any(row.shared == NOTHING for row in self.rows)


@dataclass(frozen=True)
class Listing:
    """All headline numbers of a kind of robot, by the check that listed them."""

    outcome: Outcome
    numbers: tuple[Number, ...]

    @property
    def kind(self) -> str:
        """Of what: "biglide" or "mechanism"."""
        return self.outcome.case.row


def listings(outcomes: Sequence[Outcome]) -> tuple[Listing, ...]:
    """What this run, or an earlier one of this version, found out."""
    return tuple(
        Listing(outcome, _numbers(from_table(outcome.measurement.table)))
        for outcome in outcomes
        if outcome.case.section == SECTION and outcome.measurement
    )


def _numbers(rows: Sequence[Row]) -> tuple[Number, ...]:
    return tuple(
        Number(shown, number, tuple(found))
        for (shown, number), found in groupby(rows, key=lambda row: (row.shown, row.number))
    )
