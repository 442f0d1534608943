"""Claims on what judges: one that is broken fails the case, it is not judged by what it doubts."""

from collections.abc import Callable, Mapping
from functools import partial
from math import isclose, isnan
from typing import TypeAlias

from lumped.errors import ComputationError
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.context import Context

SECTION = "Judgement"
# Claims in words, each true or false on its own.
Claims: TypeAlias = Callable[[Context], Mapping[str, bool]]

cases = CaseGroup(
    quantity="claims that hold",
    unit="1",
    reference_kind="closed-form",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number; a broken claim fails the case and is named",
    section=SECTION,
    group="guard.judgement",
    effort=0.05,
)


def claims(name: str, title: str, citation: str) -> Callable[[Claims], Claims]:
    """Declare a case of what the function below claims."""

    def declare(claimed: Claims) -> Claims:
        case = cases.case(f"guard.judgement.{name}", title, citation=citation)
        case(partial(_held, claimed=claimed))
        return claimed

    return declare


def _held(context: Context, claimed: Claims) -> Measurement:
    found = claimed(context)
    if broken := [claim for claim, holds in found.items() if not holds]:
        raise ComputationError(f"the judgement is wrong: {'; '.join(broken)}")
    return Measurement(float(sum(found.values())), float(len(found)), exact=True)


def same(found: float | None, wanted: float | None, share: float = 1e-12) -> bool:
    """Whether two numbers are one but for rounding; None is None and NaN is NaN."""
    if found is None or wanted is None:
        return found is wanted
    return isclose(found, wanted, rel_tol=share, abs_tol=1e-300) or (isnan(found) and isnan(wanted))
