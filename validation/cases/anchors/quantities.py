"""What the first screen's static quantities are called and measured in, one comparison for each."""

from collections.abc import Callable

from lumped.acceptance.requirement import STATIC_QUANTITIES
from validation.case import Case, Measurement, Relative
from validation.context import PRESETS, Context, Preset

LOAD = 1000.0  # N or N m
_ALONG = STATIC_QUANTITIES[:3]
# Degrees of polynomials that are both exact in statics.
EXACT = (3, 4)
_MICRO, _MILLI = 1e-6, 1e-3
RITZ = "Ritz's method, Legendre polynomials along the legs (validation.studies.ritz)"


def meaning(quantity: str) -> str:
    """A static quantity in words."""
    if quantity in _ALONG:
        return f"deflection along {quantity} under {LOAD:g} N along it"
    axis = quantity.removeprefix("phi_")
    return f"rotation about {axis} under {LOAD:g} N m about it"


def unit(quantity: str) -> str:
    """What it is shown in."""
    return "µm" if quantity in _ALONG else "mrad"


def in_shown_units(compliance: float, quantity: str) -> float:
    """From an entry of the 6×6 (m/N or rad/(N m))."""
    return float(compliance) * LOAD / (_MICRO if quantity in _ALONG else _MILLI)


def static_case(
    identifier: str,
    quantity: str,
    *,
    model: str,
    of: str,
    places: str,
    citation: str,
    compute: Callable[[Context], Measurement],
    section: str,
    group: str,
    presets: tuple[Preset, ...] = PRESETS,
    tolerance: float = 1e-6,
    reason: str = "statics of legs are cubic polynomials: rounding alone, grown by the condition",
) -> Case:
    """A number of `of` by a `model`, at `places`, against what is computed without it."""
    return Case(
        id=identifier,
        title=f"{of}: {meaning(quantity)} by {model}, obtained once more without its code",
        quantity=f"{meaning(quantity)}{', ' + places if places else ''}",
        unit=unit(quantity),
        reference_kind="independent-solver",
        citation=citation,
        tolerance=Relative(tolerance),
        tolerance_reason=reason,
        compute=compute,
        model=model,
        row=f"{of}, first screen",
        section=section,
        group=group,
        presets=presets,
        effort=0.05,
    )
