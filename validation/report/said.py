"""What a source says, as printed and as corrected: a table of the page, and as CSV."""

from collections.abc import Mapping
from dataclasses import dataclass

from validation.claims import Claim, Standing, summary
from validation.drawing.style import csv_of
from validation.drawing.text import number

# How far a sentence holds, in the words and the colours of the page.
HOLDS: Mapping[Standing, str] = {
    "both": "holds",
    "as printed alone": "as printed alone",
    "as corrected alone": "as corrected alone",
    "in part": "in part",
    "neither": "does not hold",
    "circular": "circular, not counted",
}


@dataclass(frozen=True)
class Cell:
    """A sentence in one reading: `text` (its number, or curves that hold), `verdict`, `hint`."""

    text: str
    verdict: str
    hint: str


@dataclass(frozen=True)
class Row:
    """A sentence with both readings; `colour` is that of its standing."""

    claim: Claim
    printed: Cell
    corrected: Cell

    @property
    def holds(self) -> str:
        """In which reading the sentence holds."""
        return HOLDS[self.claim.standing]

    @property
    def colour(self) -> str:
        """As of verdicts: adequate where it holds, inadequate where not, undecided between."""
        standing = self.claim.standing
        if standing == "neither":
            return "inadequate"
        return "adequate" if standing == "both" else "undecided"


@dataclass(frozen=True)
class SaidTable:
    """Sentences of a source, one row each."""

    claims: tuple[Claim, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows in the order of the source."""
        return tuple(
            Row(claim, _cell(claim, "printed"), _cell(claim, "corrected")) for claim in self.claims
        )

    @property
    def summary(self) -> str:
        """How many sentences hold in which reading."""
        return summary(self.claims)

    @property
    def csv(self) -> str:
        """One line for each curve of each sentence."""
        lines = [(claim, curve) for claim in self.claims for curve in claim.curves]
        return csv_of(
            {
                "statement": [claim.sentence for claim, _ in lines],
                "quantity": [claim.quantity for claim, _ in lines],
                "where": [claim.where for claim, _ in lines],
                "curve": [curve.name for _, curve in lines],
                "unit": [curve.unit for _, curve in lines],
                "as printed": [_shown(curve.printed) for _, curve in lines],
                "holds as printed": [_yes(curve.printed_holds) for _, curve in lines],
                "as corrected": [_shown(curve.corrected) for _, curve in lines],
                "holds as corrected": [_yes(curve.corrected_holds) for _, curve in lines],
                "standing": [claim.standing for claim, _ in lines],
                "differs by": [claim.differs for claim, _ in lines],
                "circular": [claim.circular for claim, _ in lines],
            }
        )


def _cell(claim: Claim, reading: str) -> Cell:
    values = [getattr(curve, reading) for curve in claim.curves]
    held = [getattr(curve, f"{reading}_holds") for curve in claim.curves]
    texts = [_with_unit(v, curve.unit) for v, curve in zip(values, claim.curves, strict=True)]
    alone = len(claim.curves) == 1
    return Cell(
        text=texts[0] if alone else f"{sum(held)} of {len(held)} curves",
        verdict="adequate" if all(held) else "inadequate",
        hint="; ".join(
            f"{curve.name + ': ' if curve.name else ''}{text}{'' if holds else ', does not hold'}"
            for curve, text, holds in zip(claim.curves, texts, held, strict=True)
        ),
    )


def _with_unit(value: float | None, unit: str) -> str:
    if value is None:
        return "no number"
    return number(value, 4) if unit == "1" else f"{number(value, 4)}\u00a0{unit}"


def _shown(value: float | None) -> float | str:
    return "" if value is None else value


def _yes(holds: bool) -> str:  # noqa: FBT001
    return "yes" if holds else "no"
