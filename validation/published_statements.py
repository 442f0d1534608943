"""What a source says, read as printed and as corrected, and in which of the two readings it holds.

A sentence may speak of several curves ("longer legs, smaller deflections" of six): it holds where
all of them do. One that itself chose a correction is circular and counts for nothing.
"""

from collections.abc import Iterable, Mapping
from typing import Any, Literal, TypeAlias

import msgspec

Standing: TypeAlias = Literal[
    "both", "as printed alone", "as corrected alone", "in part", "neither", "circular"
]
# In the order in which they are told.
STANDINGS: Mapping[Standing, str] = {
    "both": "as printed and as corrected",
    "as printed alone": "as printed alone",
    "as corrected alone": "as corrected alone",
    "in part": "for some of their curves alone",
    "neither": "in neither reading",
}


_CURVE = {
    "name": "curve",
    "printed": "as_printed",
    "printed_holds": "as_printed_holds",
    "corrected": "as_corrected",
    "corrected_holds": "as_corrected_holds",
}


class ClaimedCurve(msgspec.Struct, frozen=True, rename=_CURVE):
    """One number or curve that a sentence speaks of: its value in each reading, and the verdicts.

    A value is None where that reading gives no finite number; then it does not hold either.
    """

    name: str
    unit: str
    printed: float | None
    printed_holds: bool
    corrected: float | None
    corrected_holds: bool


class Claim(msgspec.Struct, frozen=True, rename={"sentence": "statement"}):
    """A sentence of a source (`where`), in our words, and the curves that bear it out or not.

    `quantity` says what the values of the curves are.
    `differs` names what of the printed text changes the numbers, empty where both readings are
    one; `circular` why it counts for nothing.
    """

    sentence: str
    where: str
    quantity: str
    curves: tuple[ClaimedCurve, ...]
    differs: str = ""
    circular: str = ""

    @property
    def printed(self) -> int:
        """How many curves hold as printed."""
        return sum(curve.printed_holds for curve in self.curves)

    @property
    def corrected(self) -> int:
        """How many curves hold as corrected."""
        return sum(curve.corrected_holds for curve in self.curves)

    @property
    def standing(self) -> Standing:
        """In which reading the sentence holds."""
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


def gathered(claims: Iterable[Claim]) -> tuple[Claim, ...]:
    """One claim for each sentence, with the curves of all that make it; order of appearance."""
    found: dict[str, Claim] = {}
    for claim in claims:
        known = found.get(claim.sentence)
        curves = (*(known.curves if known else ()), *claim.curves)
        found[claim.sentence] = msgspec.structs.replace(known or claim, curves=curves)
    return tuple(found.values())


def summary(claims: Iterable[Claim]) -> str:
    """How many sentences hold in which reading."""
    standings = [claim.standing for claim in claims]
    counted = len(standings) - standings.count("circular")
    told = [
        f"{standings.count(standing)} {meaning}"
        for standing, meaning in STANDINGS.items()
        if standing in standings
    ]
    circular = standings.count("circular")
    left = f"; {circular} circular and not counted" if circular else ""
    return f"Of {counted} statements hold: {', '.join(told)}{left}."


def claim_records(claims: Iterable[Claim]) -> list[dict[str, Any]]:
    """The claims as results.json carries them."""
    return [msgspec.to_builtins(claim) | {"standing": claim.standing} for claim in claims]
