"""Data records of a publication's statements, and of whether they hold as printed or corrected.

Input: values and verdicts of each curve of a statement. Output: the standing of the statement, and
counts over all statements. Rule: a statement about several curves ("longer legs, smaller
deflections", six curves) holds if it holds for all of them. A statement that was used to choose a
correction is circular and not counted.
"""

from collections.abc import Iterable, Mapping
from typing import Any, Literal, TypeAlias

import msgspec

Standing: TypeAlias = Literal[
    "both", "as printed alone", "as corrected alone", "in part", "neither", "circular"
]
# Standings in display order, with their texts.
STANDINGS: Mapping[Standing, str] = {
    "both": "true as printed and as corrected",
    "as printed alone": "true only as printed",
    "as corrected alone": "true only as corrected",
    "in part": "true only for some of their curves",
    "neither": "true in neither form",
}


_CURVE = {
    "name": "curve",
    "printed": "as_printed",
    "printed_holds": "as_printed_holds",
    "corrected": "as_corrected",
    "corrected_holds": "as_corrected_holds",
}


class ClaimedCurve(msgspec.Struct, frozen=True, rename=_CURVE):
    """One number or curve of a statement: its value and verdict, as printed and as corrected.

    `printed_holds` and `corrected_holds` are true if the statement holds for the curve. A value is
    None if there is no finite number; the statement does not hold then.
    """

    name: str
    unit: str
    printed: float | None
    printed_holds: bool
    corrected: float | None
    corrected_holds: bool


class Claim(msgspec.Struct, frozen=True, rename={"sentence": "statement"}):
    """A statement, paraphrased, at the place `where` of a source, with the curves that test it.

    `quantity` names the values of the curves. `differs`: correction of the printed text that
    changes the numbers, "" if there is none. `circular`: reason why the statement is not counted,
    "" if it is counted.
    """

    sentence: str
    where: str
    quantity: str
    curves: tuple[ClaimedCurve, ...]
    differs: str = ""
    circular: str = ""

    @property
    def printed(self) -> int:
        """Number of curves for which the statement holds as printed."""
        return sum(curve.printed_holds for curve in self.curves)

    @property
    def corrected(self) -> int:
        """Number of curves for which the statement holds as corrected."""
        return sum(curve.corrected_holds for curve in self.curves)

    @property
    def standing(self) -> Standing:
        """Variants in which the statement holds for all curves, such as "both" or "neither".

        "in part" if it holds for some curves only. "circular" if it is not counted.
        """
        if self.circular:
            return "circular"
        match self.printed == len(self.curves), self.corrected == len(self.curves):
            case True, True:
                return "both"
            case True, False:
                return "as printed alone"
            case False, True:
                return "as corrected alone"
        return "in part" if self.printed or self.corrected else "neither"


def merged_claims(claims: Iterable[Claim]) -> tuple[Claim, ...]:
    """One claim for each statement, with the curves of all its claims, in order of appearance."""
    merged: dict[str, Claim] = {}
    for claim in claims:
        earlier = merged.get(claim.sentence)
        curves = (*(earlier.curves if earlier else ()), *claim.curves)
        merged[claim.sentence] = msgspec.structs.replace(earlier or claim, curves=curves)
    return tuple(merged.values())


def summary(claims: Iterable[Claim]) -> str:
    """Sentence with the number of statements for each standing (see `Claim.standing`)."""
    standings = [claim.standing for claim in claims]
    counted_statements = len(standings) - standings.count("circular")
    counts = [
        f"{standings.count(standing)} {meaning}"
        for standing, meaning in STANDINGS.items()
        if standing in standings
    ]
    circular = standings.count("circular")
    remainder = f"; {circular} circular and not counted" if circular else ""
    return f"{counted_statements} statements: {', '.join(counts)}{remainder}."


def claim_records(claims: Iterable[Claim]) -> list[dict[str, Any]]:
    """Records of the claims for results.json."""
    return [msgspec.to_builtins(claim) | {"standing": claim.standing} for claim in claims]
