"""What cases of a mechanism share: static quantities, code of the models, where two differ most."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from fem.beams.beam import beam_leg
from lumped.acceptance.requirement import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.models import segments, serial_chains
from lumped.models.bodies import link
from lumped.system.assembly import assembly
from lumped.system.solution import solved
from validation.case import Elsewhere, Measurement
from validation.models.options import ModelName

# What solves a mechanism of bodies, and what beside it is each model's own.
ASSEMBLER = (assembly, solved)
MODEL_CODE: Mapping[ModelName, tuple[Callable[..., object], ...]] = {
    "simplified": (),
    "vjm": (serial_chains.compliance,),
    "links": (link,),
    "segments": (segments.segment_leg, segments.static_leg),
    "beam": (beam_leg,),
}
LOAD = 1000.0  # N or N m
# Degrees of polynomials that are all exact in statics.
EXACT = (3, 4, 5)
# Rounding is a number at random in each: they seldom differ all by less than a tenth of it.
_SELDOM = 10.0
_MICRO, _MILLI = 1e-6, 1e-3
# Digits of differences that are more than rounding.
_DIGITS = 8
# The static quantities, what is said of them, and their units.
SHOWN = (
    *((name, f"deflection along {name} under {LOAD:g} N along it", "µm") for name in AXES[:3]),
    *(
        (name, f"rotation about {ROTATIONS[name]} under {LOAD:g} N m about it", "mrad")
        for name in AXES[3:]
    ),
)


def farthest(found: Array, reference: Array, known: NDArray[np.bool_] | None = None) -> int:
    """Number of the posture (of p) that is farthest off, relatively, among those `known`.

    Of those off by rounding alone that of the largest number: rounding differs from machine to
    machine. What is not there where it should be is farthest of all.
    """
    looked = np.ones(len(reference), dtype=bool) if known is None else known
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.round(np.abs(found / reference - 1.0), _DIGITS)
    off = np.where(looked, np.where(np.isnan(off), np.inf, off), -1.0)
    return int(np.lexsort((np.where(looked, reference, -np.inf), off))[-1])


def rounding(found: float, *others: float) -> float:
    """What rounding leaves open of a number that further degrees of polynomials ought to share."""
    return _SELDOM * max(abs(found - other) for other in others)


def in_shown_units(compliance: float, quantity: str) -> float:
    """From an entry of the 6×6 (m/N or rad/(N m))."""
    return float(compliance) * LOAD / (_MICRO if quantity in AXES[:3] else _MILLI)


def by_another_program(
    own: Array, theirs: Array, uncertainty: Array, headings: tuple[str, str], note: str = ""
) -> Measurement:
    """Frequencies (Hz) beside another program's, which are uncertain: the first, others beside it.

    `headings` of its and of our column in the table.
    """
    places = [f"mode {number}" for number in range(1, len(theirs) + 1)]
    columns = zip(headings, (theirs, own), strict=True)
    compared = zip(places, own.tolist(), theirs.tolist(), uncertainty.tolist(), strict=True)
    return Measurement(
        float(own[0]),
        float(theirs[0]),
        reference_uncertainty=float(uncertainty[0]),
        elsewhere=tuple(Elsewhere(*one) for one in compared)[1:],
        notes=(note,) if note else (),
        table={
            "mode": tuple(float(number) for number in range(1, len(theirs) + 1)),
            **{heading: tuple(column.tolist()) for heading, column in columns},
        },
    )


def farthest_entry(
    found: Array, reference: Array, left_open: Array | float = 0.0
) -> tuple[float, float, float]:
    """The entries of two compliances (…×n×n) that differ most, in units of √(c_ii c_jj).

    And what is `left_open` of their difference: they are those that differ most beyond it. The
    unit is the power of two next to that of the reference, so that both numbers stay what they are.
    Of entries that differ by rounding alone the largest: rounding differs from machine to machine.
    """
    sizes = np.sqrt(np.abs(np.diagonal(reference, axis1=-2, axis2=-1)))
    scale = sizes[..., :, None] * sizes[..., None, :]
    scale = np.exp2(np.round(np.log2(np.where(scale > 0.0, scale, 1.0))))
    ours, theirs, open_of_both = (
        (one / scale).ravel() for one in (found, reference, left_open + 0.0 * found)
    )
    beyond = np.round(np.abs(ours - theirs) - open_of_both, _DIGITS)
    at = np.lexsort((np.abs(theirs), beyond))[-1]
    return float(ours[at]), float(theirs[at]), float(open_of_both[at])
