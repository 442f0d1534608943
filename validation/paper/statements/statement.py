"""What the paper says, in our words, and how it is measured: as printed and as corrected.

As printed: eq. (25) zeroes row and column of a joint's rotation, and springs stand between the
elements alone (§3.2). As corrected: the rotation is released by condensation, half springs stand at
both ends. The foot's entry (6,6) is the corrected one in both, for no elastic foot has the printed
one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial, update_wrapper
from math import isfinite
from typing import Literal, TypeAlias

import numpy as np

from validation.agreement.convergence import step_factor
from validation.case import Case, Measurement, Relation, Sides, Tolerance
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE
from validation.claims import Claim, ClaimedCurve
from validation.context import PRESETS, Context, Preset
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.results.outcome import verdict

SECTION = "The paper's statements"
# Postures over the stroke at which curves are compared.
POSTURES = 81
AS_PRINTED = ModelOptions(release="printed", layout="literal")
AS_CORRECTED = DEFAULT_OPTIONS
# What of the printed text changes a number.
FORMULAS = "release of joints (eq. 25), layout of the springs (§3.2)"
Compute: TypeAlias = Callable[[Context, ModelOptions], Measurement]
# What a number is computed by, where the paper prints the other one.
SIMPLIFIED, VJM = Sides(ASSEMBLER), Sides(MODEL_CODE["vjm"])
SEGMENTS = Sides((*MODEL_CODE["segments"], *ASSEMBLER))


@dataclass(frozen=True)
class Statement:
    """A sentence or figure of the paper (`where`) that a computation can check.

    `title` says what the case compares, `sides` by which code. `compute` takes the options of a
    reading; `judged` is the one whose number the case reports. `sentence` is what the paper says
    where that is more than the title, of all `curves` (the case's own where empty); sentences of
    several statements are one. `differs` names what sets the readings apart (empty: nothing does),
    `circular` why the sentence counts for nothing. `order` is that of the elements in which a
    number is computed, zero where there are none: what half as many change of it is its
    uncertainty. `figure`: id of the report's figure that shows it.
    """

    id: str
    where: str
    title: str
    quantity: str
    unit: str
    tolerance: Tolerance
    reason: str
    compute: Compute
    sides: Sides
    relation: Relation = Relation.EQUAL
    group: str = "paper"
    effort: float = 0.2
    sentence: str = ""
    curves: Mapping[str, Compute] = field(default_factory=dict)
    judged: Literal["as printed", "as corrected"] = "as corrected"
    differs: str = ""
    circular: str = ""
    order: float = 0.0
    figure: str = ""
    presets: tuple[Preset, ...] = PRESETS
    model: str = ""

    def case(self) -> Case:
        """The statement as a case."""
        return Case(
            id=f"paper.{self.id}",
            title=self.title,
            quantity=self.quantity,
            unit=self.unit,
            reference_kind="paper-statement",
            citation=f"Briot, Pashkevich, Chablat, {self.where}",
            tolerance=self.tolerance,
            tolerance_reason=self.reason,
            compute=update_wrapper(partial(_measured, statement=self), self.compute),
            relation=self.relation,
            section=SECTION,
            group=self.group,
            effort=self.effort,
            figure=self.figure,
            presets=self.presets,
            model=self.model,
            sides=self.sides,
        )

    def claim(self, context: Context) -> Claim:
        """What the paper says, in both readings."""
        curves = self.curves or {"": self.compute}
        return Claim(
            sentence=self.sentence or self.title,
            where=self.where,
            quantity=self.quantity,
            curves=tuple(self._curve(context, *named) for named in curves.items()),
            differs=self.differs,
            circular=self.circular,
        )

    def _curve(self, context: Context, name: str, compute: Compute) -> ClaimedCurve:
        corrected = compute(context, AS_CORRECTED)
        printed = compute(context, AS_PRINTED) if self.differs else corrected
        return ClaimedCurve(
            name=name,
            unit=self.unit,
            printed=_finite(printed.value),
            printed_holds=self._holds(printed),
            corrected=_finite(corrected.value),
            corrected_holds=self._holds(corrected),
        )

    def _holds(self, found: Measurement) -> bool:
        tolerance = self.tolerance.at(found.reference)
        return verdict(found.unexplained, self.relation, tolerance) == "agree"


def _measured(context: Context, statement: Statement) -> Measurement:
    options = AS_PRINTED if statement.judged == "as printed" else AS_CORRECTED
    found = replace(statement.compute(context, options), claim=statement.claim(context))
    if not statement.order:
        return found
    coarse = statement.compute(context, replace(options, elements=options.elements // 2))
    uncertain = step_factor(2.0, statement.order) * abs(found.value - coarse.value)
    return replace(found, value_uncertainty=uncertain, exact=False)


def sampled(number: Callable[[int], float], reference: float) -> Measurement:
    """A number read off a curve at `POSTURES` of the stroke.

    Fewer postures, which do not meet these, miss a peak by more or by less: their spread is the
    uncertainty.
    """
    found = [number(postures) for postures in (POSTURES, POSTURES - 10, POSTURES - 20)]
    return Measurement(found[0], reference, value_uncertainty=float(np.ptp(found)))


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
