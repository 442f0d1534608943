"""What the static quantities of the first screen are called and measured in; code of the models."""

from collections.abc import Callable, Mapping

from fem.beams.beam import beam_leg
from lumped.acceptance.requirement import AXES, ROTATIONS
from lumped.arrays import Array
from lumped.models import links, segments, serial_chains
from lumped.system.assembly import assembly
from lumped.system.solution import solved
from validation.case import Elsewhere, Measurement
from validation.models.options import ModelName

# What solves a mechanism of bodies, and what beside it is each model's own.
ASSEMBLER = (assembly, solved)
MODEL_CODE: Mapping[ModelName, tuple[Callable[..., object], ...]] = {
    "simplified": (),
    "vjm": (serial_chains.compliance,),
    "links": (links.link,),
    "segments": (segments.segment_leg, segments.static_leg),
    "beam": (beam_leg,),
}
LOAD = 1000.0  # N or N m
# Degrees of polynomials that are all exact in statics.
EXACT = (3, 4, 5)
# Rounding is a number at random in each: they seldom differ all by less than a tenth of it.
_SELDOM = 10.0
_MICRO, _MILLI = 1e-6, 1e-3


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


# The static quantities, what is said of them, and their units.
SHOWN = (
    *((name, f"deflection along {name} under {LOAD:g} N along it", "µm") for name in AXES[:3]),
    *(
        (name, f"rotation about {ROTATIONS[name]} under {LOAD:g} N m about it", "mrad")
        for name in AXES[3:]
    ),
)
