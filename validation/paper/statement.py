"""What the paper says, in our words, and how it is measured: as printed and as corrected.

As printed: eq. (25) zeroes row and column of a joint's rotation, and springs stand between the
elements alone (§3.2). As corrected: the rotation is released by condensation, half springs stand at
both ends. The foot's entry (6,6) is the corrected one in both, for no elastic foot has the printed
one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial, update_wrapper
from inspect import signature
from math import isfinite
from typing import Any, TypeVar, Unpack

import numpy as np

from validation.agreement.mesh_half_widths import MeshPolicy, mesh_half_widths
from validation.case import Case, Measurement
from validation.case_group import CaseFields, CaseGroup, Over
from validation.claims import Claim, ClaimedCurve
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.run.outcome import verdict

# Postures over the stroke at which curves are compared.
POSTURES = 81
AS_PRINTED = ModelOptions(release="printed", layout="literal")
AS_CORRECTED = DEFAULT_OPTIONS
# What of the printed text changes a number.
FORMULAS = "release of joints (eq. 25), layout of the springs (§3.2)"
Compute = TypeVar("Compute", bound=Callable[..., Measurement])
# By the name of a curve, the parameters of what computes it.
Curves = Mapping[str, Mapping[str, Any]]
# What statements have in common.
PAPER: CaseFields = {
    "section": "The paper's statements",
    "reference_kind": "paper-statement",
    "group": "paper",
    "effort": 0.2,
    "unit": "1",
}


class Statements(CaseGroup):
    """Sentences and figures of the paper that a computation can check, one case each."""

    def says(
        self,
        identifier: str,
        where: str,
        title: str,
        *,
        over: Over | None = None,
        sentence: str = "",
        curves: Curves | None = None,
        judged: ModelOptions = AS_CORRECTED,
        differs: str = "",
        circular: str = "",
        order: float = 0.0,
        **fields: Unpack[CaseFields],
    ) -> Callable[[Compute], Compute]:
        """Declare a statement of the paper (`where`) by what computes its number.

        `title` says what the case compares. The parameter `reading`, where that is computed with
        one, has the options as printed or as corrected; `judged` is the one whose number the case
        reports. `sentence` is what the paper says where that is more than the title, of all
        `curves` (the case's own where there are none); sentences of several statements are one.
        `differs` names what sets the readings apart (empty: nothing does), `circular` why the
        sentence counts for nothing. `order` is that of the elements in which a number is computed,
        zero where there are none: what half as many change of it is its uncertainty.
        """
        cited = f"Briot, Pashkevich, Chablat, {where}"
        common: CaseFields = {**self._common, "citation": cited, **fields}
        own = CaseGroup(**common)
        said = _Said(where, sentence, curves or {"": {}}, judged, differs, circular, order)

        def declare(compute: Compute) -> Compute:
            self._declared.append(
                lambda **given: tuple(map(said.case, own(reading=judged, **given)))
            )
            return own.case(f"paper.{identifier}", title, over=over)(compute)

        return declare


@dataclass(frozen=True)
class _Said:
    """What `Statements.says` is told of a statement beyond its case."""

    where: str
    sentence: str
    curves: Curves
    judged: ModelOptions
    differs: str
    circular: str
    order: float

    def case(self, declared: Case) -> Case:
        """The case with the claim in what it measures."""
        compute = declared.compute
        function = compute.func if isinstance(compute, partial) else compute
        measured = partial(self._measured, case=declared)
        return replace(declared, compute=update_wrapper(measured, function))

    def _measured(self, context: Context, case: Case) -> Measurement:
        claim = Claim(
            sentence=self.sentence or case.title,
            where=self.where,
            quantity=case.quantity,
            curves=tuple(self._curve(context, case, name) for name in self.curves),
            differs=self.differs,
            circular=self.circular,
        )
        found = replace(_read(context, case, self.judged), claim=claim)
        if not self.order:
            return found
        half = replace(self.judged, elements=self.judged.elements // 2)
        change = abs(found.value - _read(context, case, half).value)
        policy = MeshPolicy.of_order(2.0, self.order)
        uncertain = float(mesh_half_widths([np.asarray(change)], policy))
        return replace(found, value_uncertainty=uncertain, exact=False)

    def _curve(self, context: Context, case: Case, name: str) -> ClaimedCurve:
        found = corrected = _read(context, case, AS_CORRECTED, self.curves[name])
        if self.differs:
            found = _read(context, case, AS_PRINTED, self.curves[name])
        given = case.compute.keywords if isinstance(case.compute, partial) else {}
        return ClaimedCurve(
            name=name.format(**given),
            unit=case.unit,
            printed=_finite(found.value),
            printed_holds=_holds(case, found),
            corrected=_finite(corrected.value),
            corrected_holds=_holds(case, corrected),
        )


def _read(
    context: Context, case: Case, reading: ModelOptions, curve: Mapping[str, Any] | None = None
) -> Measurement:
    """What computes the case, in a reading where it knows several, of one of the curves."""
    compute: Callable[..., Measurement] = case.compute
    read = {"reading": reading} if "reading" in signature(compute).parameters else {}
    return compute(context, **read, **(curve or {}))


def _holds(case: Case, found: Measurement) -> bool:
    tolerance = case.tolerance.at(found.reference)
    return verdict(found.unexplained, case.relation, tolerance) == "agree"


def sampled(number: Callable[[int], float], reference: float) -> Measurement:
    """A number read off a curve at `POSTURES` of the stroke.

    Fewer postures, which do not meet these, miss a peak by more or by less: their spread is the
    uncertainty.
    """
    found = [number(postures) for postures in (POSTURES, POSTURES - 10, POSTURES - 20)]
    return Measurement(found[0], reference, value_uncertainty=float(np.ptp(found)))


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
