"""Convergence on element count, with observed orders held against theory."""

import numpy as np

from fem.beams.beam_theory import bending_frequencies
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from validation.agreement.convergence import order_of_errors
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import ELEMENTS, Study
from validation.models.legs import constant_leg_of
from validation.studies.element_refinement import (
    COUNTS,
    MODES,
    element_frequencies,
    exact_frequencies,
)

# Elements between which the orders are fitted.
_RANGES = {"half": (10, 160), "literal": (20, 160), "beam": (10, 40)}
EXACT = "T. C. Huang, J. Appl. Mech. 28 (1961) 579, exact Timoshenko cantilever"


_FORMAL = (
    ("half", 2.0, Absolute(0.05), "fit from ten elements on, where the next term is below 1 %"),
    (
        "literal",
        1.0,
        Absolute(0.1),
        "fit from 20 elements on, where 1/n² terms still count a few per cent",
    ),
    ("beam", 4.0, Absolute(0.1), "fit from 10 to 40 elements; beyond, rounding takes over"),
)
cases = CaseGroup(over={"number": (1, 2)}, unit="1", reference_kind="closed-form", section=ELEMENTS)


def _errors(context: Context, number: int, name: str) -> tuple[Array, Array]:
    leg = constant_leg_of(context, f"leg{number}")
    counts = COUNTS[context.preset]
    found = context.get(element_frequencies, leg, name, counts)
    return np.array(counts), found / context.get(exact_frequencies, leg) - 1.0


@cases.case(
    "refinement.leg{number}.{name}.order[{mode}]",
    "Leg {number}, {name}: bending frequency {mode} converges with order {order:g}",
    over={"name, order, tolerance, tolerance_reason": _FORMAL, "mode": range(1, MODES + 1)},
    quantity="fitted order in the number of elements",
    citation=EXACT,
    model="{name}",
    row="leg {number}, frequency {mode}",
    group="refinement.{number}.{name}",
)
def _order(context: Context, number: int, name: str, mode: int, order: float) -> Measurement:
    counts, errors = _errors(context, number, name)
    first, last = _RANGES[name]
    used = (counts >= first) & (counts <= last)
    fitted, before = (
        order_of_errors(1.0 / counts[used][part], errors[used, mode - 1][part])
        for part in (slice(None), slice(None, -1))
    )
    at_twenty = 100.0 * float(errors[counts == 20, mode - 1][0])
    study = Study(
        id=f"refinement.leg{number}.{name}.{mode}",
        kind="convergence",
        title=f"Leg {number}, {name}: bending frequency {mode}",
        x_label="elements per leg",
        y_label="relative error of the frequency",
        unit="1",
        x=tuple(counts.tolist()),
        series={name: tuple(np.abs(errors[:, mode - 1]).tolist())},
        formal_order=order,
        orders={name: fitted},
        limits={name: 0.0},
        family=f"refinement.leg{number}.{name}",
        family_title=f"Leg {number}, {name}: bending frequencies",
        variant=f"bending frequency {mode}",
    )
    return Measurement(
        fitted,
        order,
        # What the finest of the grids has changed of the fitted order.
        value_uncertainty=abs(fitted - before),
        notes=(f"error with 20 elements {at_twenty:+.3g} %",),
        studies=(study,),
    )


@cases.case(
    "refinement.leg{number}.literal.coefficient",
    "Leg {number}: without springs at its ends a length L/n of the leg is rigid",
    quantity="limit of n · relative error of the first bending frequency",
    citation="half an element rigid at the root: −(L/2f) df/dL, 1 for a slender beam",
    tolerance=Absolute(1e-3),
    tolerance_reason="extrapolated to 1/n = 0 from the two finest: 1/n² remains",
    group="refinement.{number}.literal",
)
def _literal_coefficient(context: Context, number: int) -> Measurement:
    counts, errors = _errors(context, number, "literal")
    coarsest, coarse, fine = (counts * errors[:, 0])[-3:]
    leg = constant_leg_of(context, f"leg{number}")
    with_shear = _rigid_root_effect(leg)
    return Measurement(
        float(2.0 * fine - coarse),
        with_shear,
        # Extrapolated to second order: what the finest grid has changed is three times its error.
        value_uncertainty=float(abs(2.0 * fine - coarse - (2.0 * coarse - coarsest))),
        notes=(f"error with 20 elements {100.0 * float(errors[counts == 20, 0][0]):+.2f} %",),
    )


def _rigid_root_effect(leg: ConstantLeg) -> float:
    """−(L/2) d ln f/dL at fixed total length: what a rigid piece L/2n at the root does, times n.

    A rigid root piece raises the frequency by the strain energy it takes away; that energy
    density at the root over the mean is −(L/2f) df/dL for a beam whose tip moves with its length.
    """
    step = 1e-4
    lengths = (leg.length * (1.0 - step), leg.length * (1.0 + step))
    low, high = (float(bending_frequencies(leg.timoshenko, l, "y", 1)[0]) for l in lengths)
    return float(-(np.log(high) - np.log(low)) / (4.0 * step))
