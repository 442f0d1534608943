"""Numbers, errors, names and file contents as text for the report.

Input: numbers and entries of verdicts. Output: short texts with units, powers of ten and no-break
spaces.
"""

import re
from base64 import b64encode
from collections.abc import Callable, Mapping
from functools import partial
from inspect import unwrap
from math import isfinite, isinf
from typing import Any, Protocol

from markupsafe import escape

from validation.case import Absolute, Tolerance
from validation.studies_and_figures import Figure
from validation.verdicts import EntryRecord

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MINUS = "−"
# Ratios below this are round-off, whose digits are meaningless.
_ROUNDING = 1e-8
# Fraction of the reference below which half-widths are not written.
_SMALLEST_SPREAD = 5e-4
# Names of rotations on the command line, by their labels in comparisons.
_TYPED_NAMES: Mapping[str, str] = {"φx": "phi_x", "φy": "phi_y", "φz": "phi_z"}


def number(value: Any, digits: int = 5) -> str:
    """Number with `digits` significant digits: "1.06 × 10⁻⁶", "0.4975". "–" for None.

    A text is returned unchanged.
    """
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    if not isfinite(value):
        return "not a number" if value != value else f"{value:g}".replace("inf", "∞")  # noqa: PLR0124
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    mantissa = mantissa.replace("-", _MINUS)
    if not exponent:
        return mantissa
    if 0 < int(exponent) < 6:
        return f"{float(f'{value:.{digits}g}'):.0f}".replace("-", _MINUS)
    # No-break spaces prevent a line break within a number.
    return f"{mantissa}\u00a0×\u00a0{power_of_ten(int(exponent))}"


def power_of_ten(exponent: int) -> str:
    """Power of ten with superscripts: "10⁻⁶"."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def engineering(value: float) -> tuple[float, str]:
    """Number and SI prefix ("n", "µ", "m" or ""), such that the number lies between 1 and 1000.

    The number is smaller or larger for a value outside the range of these prefixes.
    """
    for prefix, factor in (("", 1.0), ("m", 1e3), ("µ", 1e6)):
        if abs(value) * factor >= 1.0:
            return value * factor, prefix
    return value * 1e9, "n"


def percent(fraction: float, *, signed: bool = True) -> str:
    """Ratio in per cent with two significant digits: "+1.3 %", "−0.02 %", "120 %".

    A ratio of magnitude below 1e-8 is displayed as a bound, "< 1 × 10⁻⁶ %". "" if it is not finite.
    """
    if not isfinite(fraction):
        return ""
    if abs(fraction) < _ROUNDING:
        return "0\u00a0%" if not fraction else f"<\u00a0{number(100.0 * _ROUNDING)}\u00a0%"
    sign = "+" if signed and fraction > 0.0 else ""
    return f"{sign}{number(100.0 * fraction, 2)}\u00a0%"


def error_text(error: float, *, signed: bool = True) -> str:
    """Error (a ratio) as text in per cent, rounded to 0.01 %, then to two significant digits."""
    return percent(round(error, 4), signed=signed)


def spread_text(uncertainty: float | None) -> str:
    """Half-width of an error: "± 0.3 %". "" if it is below 0.05 %."""
    if uncertainty is None or uncertainty < _SMALLEST_SPREAD:
        return ""
    return f"±\u00a0{error_text(uncertainty, signed=False)}"


class ErrorText(Protocol):
    """Function that formats an error in per cent, with its sign if `signed`."""

    def __call__(self, error: float, *, signed: bool = True) -> str:
        """Format the error."""


def error_parts(
    entry: EntryRecord[Any, Any], *, named: bool = True, written: ErrorText = error_text
) -> tuple[str, str]:
    """Texts of an entry's error and of its half-width. ("", "") if there is no error.

    The error lies in the interval from `entry.low` to `entry.high`. The first condition that holds
    determines the form:

    - an end of the interval is infinite: the error, and "without bound";
    - the interval contains zero, and the errors under the interpretations of the robot file
      differ by at most the half-width: the bound of the error, "below 4.4 %", and "";
    - there is one interpretation, and the interval extends beyond error ± half-width:
      the ends of the interval, "0 to 33 %", and "";
    - the errors under the interpretations differ: the lowest and the highest error, with
      the names of their interpretations if `named`, and the half-width;
    - otherwise: the error, and the half-width.

    `written` formats the errors.
    """
    error, half_width = entry.error, entry.uncertainty or 0.0
    if error is None:
        return "", ""
    low = error - half_width if entry.low is None else entry.low
    high = error + half_width if entry.high is None else entry.high
    readings = _readings_text(entry, written, named=named)
    differ = readings and max(entry.readings.values()) - min(entry.readings.values()) > half_width
    largest = max(abs(low), abs(high))
    if isinf(largest):
        return written(error, signed=entry.signed), "without bound"
    if low <= 0.0 <= high and not differ and largest - abs(error) >= _SMALLEST_SPREAD:
        return f"below {written(largest, signed=False)}", ""
    # The interval can extend farther to one side, for example with other partners of a mode.
    if max(error - low, high - error) - half_width >= _SMALLEST_SPREAD and not readings:
        return _range(low, high, written, signed=entry.signed), ""
    spread = ""
    if half_width >= _SMALLEST_SPREAD:
        spread = f"±\u00a0{written(half_width, signed=False)}"
    return readings or written(error, signed=entry.signed), spread


def error_with_spread(entry: EntryRecord[Any, Any], written: ErrorText = error_text) -> str:
    """Error and half-width in one text: "+1.2 % ± 0.3 %", "below 4.4 %".

    If errors under several interpretations of the robot file differ, their names are included.
    """
    return " ".join(filter(None, error_parts(entry, written=written)))


def bound(entry: EntryRecord[Any, Any]) -> float:
    """Largest magnitude of the error within its uncertainty."""
    ends = (entry.error, entry.low, entry.high)
    return max(abs(end) for end in ends if end is not None)


def _readings_text(entry: EntryRecord[Any, Any], written: ErrorText, *, named: bool) -> str:
    """Errors under the interpretations with the lowest and with the highest error, as text.

    With the names of the interpretations if `named`. "" if there is one interpretation, or if the
    errors are nearly equal.
    """
    ranked = sorted(entry.readings.items(), key=lambda reading: reading[1])
    if len(ranked) < 2:
        return ""
    (first, low), (last, high) = ranked[0], ranked[-1]
    texts = [written(error, signed=entry.signed) for error in (low, high)]
    if texts[0] == texts[1] or high - low < _SMALLEST_SPREAD:
        return ""
    if named:
        return f"{texts[0]} with {first}, {texts[1]} with {last}"
    return _range(low, high, written, signed=entry.signed)


def _range(low: float, high: float, written: ErrorText, *, signed: bool) -> str:
    """Range of errors with one percent sign: "0 to 33 %"."""
    first, last = (written(end, signed=signed) for end in (low, high))
    return f"{first.removesuffix('%').rstrip()} to {last}"


def share_text(share: float) -> str:
    """Ratio of difference to tolerance as text: "35 %", or "1.4 times" above 1.

    "inside the bound" for a negative ratio, which only one-sided comparisons have.
    """
    if share < 0.0:
        return "inside the bound"
    if share > 1.0:
        return f"{number(share, 2)} times"
    return f"{100.0 * share:.2g}\u00a0%" if share >= 1e-4 or not share else "<\u00a00.01\u00a0%"


def tolerance(allowed: Tolerance, unit: str) -> str:
    """Tolerance as "±0.5 µm" or "±1 %"."""
    if isinstance(allowed, Absolute):
        return f"±{number(allowed.amount, 3)}\u00a0{unit}".removesuffix("\u00a01")
    return f"±{number(100.0 * allowed.fraction, 3)}\u00a0%"


def seconds(time: float) -> str:
    """Time in ms, s or min. The argument is in s."""
    if time < 0.05:
        return f"{1000.0 * time:.0f} ms"
    return f"{time:.1f} s" if time < 100.0 else f"{time / 60.0:.1f} min"


def anchor(identifier: str) -> str:
    """Identifier as the target of a link: special characters are replaced by "_"."""
    return re.sub(r"[^\w.+-]+", "_", identifier).rstrip("_")


def function_name(function: Callable[..., object]) -> str:
    """Module and name of a function.

    For a closure, the names of the enclosing function. For a partial or a wrapper of
    functools.wraps, the names of the wrapped function.
    """
    function = unwrap(function)
    while isinstance(function, partial):
        function = unwrap(function.func)
    module = getattr(function, "__module__", type(function).__module__)
    name: str = getattr(function, "__qualname__", type(function).__qualname__)
    return f"{module}.{name.partition('.<locals>')[0]}"


def base64(content: bytes) -> str:
    """Bytes as base64 text."""
    return b64encode(content).decode("ascii")


def data_uri(content: str | bytes, kind: str) -> str:
    """Data URI of a content with the media type `kind`, for example "text/csv;charset=utf-8"."""
    data = content.encode("utf-8") if isinstance(content, str) else content
    return f"data:{kind};base64,{base64(data)}"


def inline_svg(figure: Figure) -> str:
    """SVG of a figure with a prefix in all ids, so that ids of several plots on a page differ."""
    prefix = f"{anchor(figure.id)}--"
    markup = re.sub(r'\bid="', f'id="{prefix}', figure.svg)
    markup = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}", markup)
    return markup.replace("<svg ", f'<svg role="img" aria-label="{escape(figure.title)}" ', 1)


def quantity_name(label: str) -> str:
    """Name of a quantity on the command line: "phi_x" for "φx"."""
    return _TYPED_NAMES.get(label, label)
