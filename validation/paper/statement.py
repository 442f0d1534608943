"""Statements of the paper as cases, each computed as printed and as corrected.

Input: a function that computes the number of a statement. Output: a case whose measurement contains
a `Claim`: for each curve of the statement, the number and whether the statement holds, in both
variants. As printed: eq. (25) sets row and column of a joint's rotation to zero in the stiffness of
the last spring, and springs stand between the elements only (§3.2). As corrected: the rotation is
released by condensation, and springs of half length stand at both ends. Entry (6,6) of the foot's
compliance is the corrected one in both variants, because no elastic foot can have the printed one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial, update_wrapper
from inspect import signature
from typing import Any, TypeVar, Unpack

import numpy as np

from validation.case import Case, Measurement
from validation.case_group import CaseFields, CaseGroup, Over
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.published_statements import Claim, ClaimedCurve
from validation.record_fields import finite
from validation.run.outcome import verdict
from validation.uncertainty.half_widths import MeshPolicy

# Number of postures over the stroke at which curves are compared.
POSTURES = 81
AS_PRINTED = ModelOptions(release="printed", layout="literal")
AS_CORRECTED = DEFAULT_OPTIONS
# Text on the corrected formulas that change the value of a statement.
FORMULAS = "release of joints (eq. 25), layout of the springs (§3.2)"
Compute = TypeVar("Compute", bound=Callable[..., Measurement])
# Arguments of a case's computation, by the name of the curve.
Curves = Mapping[str, Mapping[str, Any]]
# Case fields that all statements have in common.
PAPER: CaseFields = {
    "section": "The paper's statements",
    "reference_kind": "paper-statement",
    "group": "paper",
    "effort": 0.2,
    "unit": "1",
}


class Statements(CaseGroup):
    """Sentences and figures of the paper that a computation can check, one case each."""

    def statement(
        self,
        identifier: str,
        passage: str,
        title: str,
        *,
        over: Over | None = None,
        sentence: str = "",
        curves: Curves | None = None,
        reported: ModelOptions = AS_CORRECTED,
        corrections: str = "",
        circular: str = "",
        order: float = 0.0,
        **fields: Unpack[CaseFields],
    ) -> Callable[[Compute], Compute]:
        """Decorator of the function that computes the value of a statement in a `passage`.

        `title` names the comparison. `sentence` is the paper's statement if it covers more than the
        title; statements with equal sentences are counted once. `curves` are the curves that the
        sentence covers; if None, the case itself is the only curve.

        A computation with a parameter `variant` receives the options as printed or as corrected;
        the case contains its value for the options `reported`. `corrections` names the corrected
        formulas that change the value, "" if none does. `circular` is the reason why the sentence
        is not counted, "" if it is. `order` is the order of convergence in the element count; the
        uncertainty of the value then follows from its change with half as many elements. 0 if the
        value does not depend on elements.
        """
        citation = f"Briot, Pashkevich, Chablat, {passage}"
        common: CaseFields = {**self._common, "citation": citation, **fields}
        group = CaseGroup(**common)
        statement = _Statement(
            passage, sentence, curves or {"": {}}, reported, corrections, circular, order
        )

        def declare(compute: Compute) -> Compute:
            self._declared.append(
                lambda **parameters: tuple(
                    map(statement.case, group(variant=reported, **parameters))
                )
            )
            return group.case(f"paper.{identifier}", title, over=over)(compute)

        return declare


@dataclass(frozen=True)
class _Statement:
    """Arguments of `Statements.statement` that are not fields of a `Case`."""

    passage: str
    sentence: str
    curves: Curves
    reported: ModelOptions
    corrections: str
    circular: str
    order: float

    def case(self, declared: Case) -> Case:
        """Copy of the declared case whose measurement contains the `Claim`."""
        compute = declared.compute
        function = compute.func if isinstance(compute, partial) else compute
        compute_with_claim = partial(self._measurement_with_claim, case=declared)
        return replace(declared, compute=update_wrapper(compute_with_claim, function))

    def _measurement_with_claim(self, context: Context, case: Case) -> Measurement:
        claim = Claim(
            sentence=self.sentence or case.title,
            where=self.passage,
            quantity=case.quantity,
            curves=tuple(self._curve(context, case, name) for name in self.curves),
            differs=self.corrections,
            circular=self.circular,
        )
        measurement = replace(_measure(context, case, self.reported), claim=claim)
        if not self.order:
            return measurement
        coarse = replace(self.reported, elements=self.reported.elements // 2)
        change = measurement.value - _measure(context, case, coarse).value
        half_width = MeshPolicy.of_order(2.0, self.order).half_width(change)
        return replace(measurement, value_uncertainty=half_width, exact=False)

    def _curve(self, context: Context, case: Case, name: str) -> ClaimedCurve:
        printed = corrected = _measure(context, case, AS_CORRECTED, self.curves[name])
        if self.corrections:
            printed = _measure(context, case, AS_PRINTED, self.curves[name])
        parameters = case.compute.keywords if isinstance(case.compute, partial) else {}
        return ClaimedCurve(
            name=name.format(**parameters),
            unit=case.unit,
            printed=finite(printed.value),
            printed_holds=_holds(case, printed),
            corrected=finite(corrected.value),
            corrected_holds=_holds(case, corrected),
        )


def _measure(
    context: Context, case: Case, variant: ModelOptions, curve: Mapping[str, Any] | None = None
) -> Measurement:
    """Measurement of the case for one of its curves.

    `variant`: options as printed or as corrected. It has no effect if the function of the case has
    no such parameter. `curve`: arguments of that function for the curve, None if the curve has no
    arguments.
    """
    compute: Callable[..., Measurement] = case.compute
    options = {"variant": variant} if "variant" in signature(compute).parameters else {}
    return compute(context, **options, **(curve or {}))


def _holds(case: Case, measurement: Measurement) -> bool:
    tolerance = case.tolerance.at(measurement.reference)
    return verdict(measurement.unexplained, case.relation, tolerance) == "agree"


def sampled(number: Callable[[int], float], reference: float) -> Measurement:
    """Measurement of a number that is taken from a curve at `POSTURES` points of the stroke.

    The argument of `number` is the count of points. The number is also computed with two smaller
    counts, which miss a peak of the curve by different amounts. The range of the three results is
    the uncertainty.
    """
    numbers = [number(postures) for postures in (POSTURES, POSTURES - 10, POSTURES - 20)]
    return Measurement(numbers[0], reference, value_uncertainty=float(np.ptp(numbers)))
