"""What the static quantities of the first screen are called and measured in; code of the models."""

from collections.abc import Callable, Mapping

from fem.beams.beam import beam_leg
from lumped.acceptance.requirement import AXES, ROTATIONS
from lumped.models import links, segments, serial_chains
from lumped.system.assembly import assembly
from lumped.system.solution import solved
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
_ALONG = AXES[:3]
# Degrees of polynomials that are all exact in statics.
EXACT = (3, 4, 5)
# Rounding is a number at random in each: they seldom differ all by less than a tenth of it.
_SELDOM = 10.0
_MICRO, _MILLI = 1e-6, 1e-3


def meaning(quantity: str) -> str:
    """A static quantity in words."""
    if quantity in _ALONG:
        return f"deflection along {quantity} under {LOAD:g} N along it"
    return f"rotation about {ROTATIONS[quantity]} under {LOAD:g} N m about it"


def unit(quantity: str) -> str:
    """What it is shown in."""
    return "µm" if quantity in _ALONG else "mrad"


def rounding(found: float, *others: float) -> float:
    """What rounding leaves open of a number that further degrees of polynomials ought to share."""
    return _SELDOM * max(abs(found - other) for other in others)


def in_shown_units(compliance: float, quantity: str) -> float:
    """From an entry of the 6×6 (m/N or rad/(N m))."""
    return float(compliance) * LOAD / (_MICRO if quantity in _ALONG else _MILLI)


# The static quantities with what is said of them and their units.
SHOWN = tuple((quantity, meaning(quantity), unit(quantity)) for quantity in AXES)
