"""Table and CSV of a publication's statements, checked as printed and as corrected.

Input: `Claim` records. Output: rows of the page and CSV.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from validation.drawing.style import csv_of
from validation.drawing.text import number
from validation.published_statements import Claim, Standing, summary

# Text for the standing of a statement, and the verdict whose colour it has.
_STANDINGS: Mapping[Standing, tuple[str, str]] = {
    "both": ("holds", "adequate"),
    "as printed alone": ("as printed alone", "undecided"),
    "as corrected alone": ("as corrected alone", "undecided"),
    "in part": ("in part", "undecided"),
    "neither": ("does not hold", "inadequate"),
    "circular": ("circular, not counted", "undecided"),
}
_YES = {True: "yes", False: "no"}


@dataclass(frozen=True)
class StatementCell:
    """Table cell for a statement in one form, as printed or as corrected.

    A statement is checked on one or several curves. `text`: value of the only curve, or "3 of 4
    curves" if the statement holds for three of four. `verdict` sets the colour. `hint`: values of
    all curves, displayed beside the mouse pointer.
    """

    text: str
    verdict: str
    hint: str


@dataclass(frozen=True)
class StatementTable:
    """Table of the statements of a source, one row each."""

    claims: tuple[Claim, ...]

    @property
    def rows(self) -> Iterator[tuple[Claim, list[StatementCell], str, str]]:
        """Rows with four elements: statement, two cells, standing and colour.

        The cells are for the statement as printed and as corrected. The standing is the result for
        both forms, such as "holds" or "as printed alone". The colour is the name of a verdict.
        """
        for claim in self.claims:
            readings = [_cell(claim, reading) for reading in ("printed", "corrected")]
            yield claim, readings, *_STANDINGS[claim.standing]

    @property
    def summary(self) -> str:
        """Sentence with the number of statements for each standing (see `rows`)."""
        return summary(self.claims)

    @property
    def csv(self) -> str:
        """CSV with a line for each curve to which a published statement refers."""
        lines = [(claim, curve) for claim in self.claims for curve in claim.curves]
        return csv_of(
            {
                "statement": [claim.sentence for claim, _ in lines],
                "quantity": [claim.quantity for claim, _ in lines],
                "where": [claim.where for claim, _ in lines],
                "curve": [curve.name for _, curve in lines],
                "unit": [curve.unit for _, curve in lines],
                "as printed": [curve.printed for _, curve in lines],
                "holds as printed": [_YES[curve.printed_holds] for _, curve in lines],
                "as corrected": [curve.corrected for _, curve in lines],
                "holds as corrected": [_YES[curve.corrected_holds] for _, curve in lines],
                "standing": [claim.standing for claim, _ in lines],
                "differs by": [claim.differs for claim, _ in lines],
                "circular": [claim.circular for claim, _ in lines],
            }
        )


def _cell(claim: Claim, reading: str) -> StatementCell:
    holding = [getattr(curve, f"{reading}_holds") for curve in claim.curves]
    texts = [_with_unit(getattr(curve, reading), curve.unit) for curve in claim.curves]
    return StatementCell(
        text=texts[0] if len(texts) == 1 else f"{sum(holding)} of {len(holding)} curves",
        verdict="adequate" if all(holding) else "inadequate",
        hint="; ".join(
            f"{curve.name + ': ' if curve.name else ''}{text}{'' if holds else ', does not hold'}"
            for curve, text, holds in zip(claim.curves, texts, holding, strict=True)
        ),
    )


def _with_unit(value: float | None, unit: str) -> str:
    if value is None:
        return "no number"
    return number(value, 4) if unit == "1" else f"{number(value, 4)}\u00a0{unit}"
