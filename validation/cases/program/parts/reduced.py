"""The fork reduced, by its modes with interfaces held or free, beside all its unknowns."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.craig_bampton import Reduction, heavier_at_interfaces, reduction
from fem.reduction.free_interface import free_interface
from fem.reduction.held import HeldBody
from lumped.arrays import Array
from lumped.dense.modes import solve_modes
from validation.agreement.differences import farthest_off
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.parts.drawing import SECTION
from validation.cases.program.parts.fork import COARSE, STEEL, fork
from validation.context import Context
from validation.models.options import ReductionBy

_MODES = 4

cases = CaseGroup(
    section=SECTION,
    group="program.parts.reduced",
    unit="1",
    reference_kind="independent-solver",
    citation=f"the first {_MODES} modes of all its unknowns, held at one bore, none missing by "
    "their count",
    effort=3.0,
    subject="program",
)


@dataclass(frozen=True, eq=False)
class Reduced:
    """Frequencies (k, Hz) of the whole fork, of it reduced, and the bound below these."""

    whole: Array
    upper: Array
    lower: Array


def reduced_fork(by: ReductionBy) -> Reduced:
    """Held at its first bore; its modes are cut off at the usual multiple of the highest."""
    found = fork(COARSE)
    body = held_part(meshed_part(found.mesh, STEEL), grips_of(found.mesh, found.interfaces), "fork")
    whole = body.modes(_MODES).frequencies
    if by == "free":
        small, truncation = free_interface(body, whole[-1])
        loosened = truncation.loosened
    else:
        small = reduction(HeldBody(body), whole[-1])
        loosened = partial(_heavier, small)
    upper = _held_at_one(small.stiffness, small.mass, _MODES)
    lower = [
        _held_at_one(*loosened((2.0 * np.pi * one) ** 2), j + 1)[j] for j, one in enumerate(upper)
    ]
    return Reduced(whole, upper, np.array(lower))


def _heavier(small: Reduction, squared: float) -> tuple[Array, Array]:
    size = len(small.mass)
    stiffness, mass = heavier_at_interfaces(small.truncated, small.cutoff, size, squared)
    return small.stiffness + stiffness, small.mass + mass


def _held_at_one(stiffness: Array, mass: Array, count: int) -> Array:
    return solve_modes(stiffness[6:, 6:], mass[6:, 6:], count, "fork, reduced").frequencies


@cases.case(
    "program.parts.reduced.{by}",
    "A fork by its modes with interfaces {by} swings as the whole mesh",
    over={"by": ("fixed", "free")},
    quantity="largest relative difference of frequencies",
    tolerance=Absolute(1e-3),
    tolerance_reason="at 2.5 times the highest frequency the dropped modes' response errs by "
    "(1/2.5)⁴, 3 % of their static share, which is a few percent of what the fork yields",
)
def _near(context: Context, by: ReductionBy) -> Measurement:
    found = context.get(reduced_fork, by)
    return farthest_off(found.upper / found.whole - 1.0)


@cases.case(
    "program.parts.reduced.{by}.bound",
    "The bounds of a fork by its modes with interfaces {by} enclose the whole mesh's frequencies",
    over={"by": ("fixed", "free")},
    quantity="largest relative distance from between the bounds",
    tolerance=Absolute(1e-8),
    tolerance_reason="rounding, grown by the stiffness of a solid's fastest modes",
)
def _enclosed(context: Context, by: ReductionBy) -> Measurement:
    found = context.get(reduced_fork, by)
    outside = np.maximum(found.whole - found.upper, found.lower - found.whole) / found.whole
    return farthest_off(np.maximum(outside, 0.0))
