"""Each leg alone, root clamped: segments and beams against closed forms."""

from math import ceil

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import CantileverFrequency, cantilever_frequencies
from lumped.legs import ConstantLeg, tip_compliance
from lumped.models.segments import segment_leg
from validation.agreement.convergence import step_factor
from validation.case import Measurement, Relative, Sides
from validation.case_group import CaseGroup, numbered
from validation.context import Context
from validation.models.legs import constant_leg_of, kind_frequencies, leg_compliance
from validation.models.options import BEAM_ORDER, SEGMENT_ORDER, ModelName, ModelOptions

MODES = 6
# The tolerances of frequencies hold up to this one of a kind with the default number of elements.
_FINE_UP_TO = 3
# Row and column (from 0), meaning and unit of the entries that a straight leg's compliance has.
ENTRIES = {
    "c11": ((0, 0), "tension", "m/N"),
    "c22": ((1, 1), "deflection along y", "m/N"),
    "c33": ((2, 2), "deflection along z", "m/N"),
    "c44": ((3, 3), "torsion", "rad/(N m)"),
    "c55": ((4, 4), "rotation about y", "rad/(N m)"),
    "c66": ((5, 5), "rotation about z", "rad/(N m)"),
    "c26": ((1, 5), "deflection along y under a moment about z", "m/(N m)"),
    "c35": ((2, 4), "deflection along z under a moment about y", "m/(N m)"),
}
OVER_ENTRIES = {"name, entry, meaning, unit": [(name, *of) for name, of in ENTRIES.items()]}
TIMOSHENKO = "S. P. Timoshenko, Phil. Mag. 41 (1921) 744; c = ∫ of unit resultants over EA … κGA"
HUANG = "T. C. Huang, J. Appl. Mech. 28 (1961) 579, exact Timoshenko cantilever, solved here"


# Model, its code, and how near its frequencies are.
_LUMPED = (
    (
        "segments",
        segment_leg,
        Relative(0.02),
        "second order in 1/n: mode k with n elements is off by k²/n², below 2 % with 20 for the "
        "third of its kind and as many more for a higher one",
    ),
    (
        "beam",
        beam_leg,
        Relative(1e-4),
        "fourth order in 1/n: below 1e-5 with 20 elements for the third of its kind and as many "
        "more for a higher one, ten times that for rounding and roots",
    ),
)
cases = CaseGroup(
    over={"body": lambda legs: legs, "model, code, near, reason": _LUMPED},
    reference_kind="closed-form",
    section="{body}",
    group="{body}.lumped",
    effort=0.01,
)


def exact_modes(leg: ConstantLeg) -> tuple[CantileverFrequency, ...]:
    """Its first frequencies, ascending."""
    return cantilever_frequencies(leg.timoshenko, leg.length, MODES)


@cases.case(
    "{body}.compliance.{model}[{name}]",
    "{body}: {name} of the {model} model is the cantilever's",
    over=OVER_ENTRIES,
    quantity="compliance {name}, {meaning}",
    citation=TIMOSHENKO,
    tolerance=Relative(1e-9),
    tolerance_reason="both are exact in statics: rounding alone, grown by n⁴",
    label="{name}, {meaning}",
    sides=lambda code: Sides((code,), (tip_compliance,)),
)
def _entry(context: Context, body: str, model: ModelName, entry: tuple[int, int]) -> Measurement:
    leg = constant_leg_of(context, body)
    found = context.get(leg_compliance, model, leg, ModelOptions())
    exact = tip_compliance(leg.timoshenko, leg.length)
    return Measurement(float(found[entry]), float(exact[entry]), exact=True)


@cases.case(
    "{body}.frequency.{model}[{mode}]",
    "{body}: frequency {mode} of the {model} model is exact",
    over={"index, mode": numbered(MODES)},
    quantity="natural frequency {mode}, clamped-free",
    label="frequency {mode}",
    unit="Hz",
    citation=HUANG,
    tolerance=lambda near: near,
    tolerance_reason="{reason}",
    sides=lambda code: Sides((code,), (cantilever_frequencies,)),
)
def _mode(context: Context, body: str, model: ModelName, index: int) -> Measurement:
    leg = constant_leg_of(context, body)
    exact = context.get(exact_modes, leg)[index]
    elements = _elements(exact.order)
    coarse, fine = (
        context.get(
            kind_frequencies, leg, model, exact.kind, exact.order, ModelOptions(elements=number)
        )[-1]
        for number in (elements // 2, elements)
    )
    order = BEAM_ORDER if model == "beam" else SEGMENT_ORDER
    return Measurement(
        float(fine),
        float(exact.frequency),
        value_uncertainty=step_factor(elements / (elements // 2), order)
        * float(abs(fine - coarse)),
        # What so many elements leave is what is judged, against a root that is exact.
        judged_uncertainty=0.0,
        notes=(f"{exact.kind}, number {exact.order} of its kind, {elements} elements",),
    )


def _elements(order: int) -> int:
    """As many per half wave as the default number has for the last mode that it is fine for.

    All six modes of a flat strip may be of one kind.
    """
    return ceil(ModelOptions().elements * max(1.0, order / _FINE_UP_TO))
