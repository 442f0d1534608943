"""Numbers, names and files as the page shows them."""

import re
from base64 import b64encode
from collections.abc import Callable
from functools import partial
from inspect import unwrap
from math import isfinite, isinf
from typing import Any, Protocol

from markupsafe import escape

from validation.case import Absolute, Tolerance
from validation.exhibits import Figure
from validation.verdicts import EntryRecord

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MINUS = "−"
# Ratios below this are rounding: their digits say nothing.
_ROUNDING = 1e-8
# Half-widths below this share of the reference are not shown.
_WORTH_SHOWING = 5e-4


def number(value: Any, digits: int = 5) -> str:
    """A number with `digits` significant ones: "1.06 × 10⁻⁶", "0.4975"; texts stay as they are."""
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
    # No-break spaces: a number is never torn apart.
    return f"{mantissa}\u00a0×\u00a0{power_of_ten(int(exponent))}"


def power_of_ten(exponent: int) -> str:
    """As in print: "10⁻⁶"."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def engineering(value: float) -> tuple[float, str]:
    """The number with its SI prefix, "n" to "": 1 to 1000 if a prefix reaches it."""
    for prefix, factor in (("", 1.0), ("m", 1e3), ("µ", 1e6)):
        if abs(value) * factor >= 1.0:
            return value * factor, prefix
    return value * 1e9, "n"


def percent(fraction: float, *, signed: bool = True) -> str:
    """A ratio as percentage with two significant digits: "+1.3 %", "−2 × 10⁻⁷ %", "120 %"."""
    if not isfinite(fraction):
        return ""
    if abs(fraction) < _ROUNDING:
        return "0\u00a0%" if not fraction else f"<\u00a0{number(100.0 * _ROUNDING)}\u00a0%"
    sign = "+" if signed and fraction > 0.0 else ""
    return f"{sign}{number(100.0 * fraction, 2)}\u00a0%"


def error_text(error: float, *, signed: bool = True) -> str:
    """An error in percent, two digits, none behind hundredths; "0 %" below these."""
    return percent(round(error, 4), signed=signed)


def spread_text(uncertainty: float | None) -> str:
    """A half-width of an error: "± 0.3 %"; "" if it is too small to be shown."""
    if uncertainty is None or uncertainty < _WORTH_SHOWING:
        return ""
    return f"±\u00a0{error_text(uncertainty, signed=False)}"


class ErrorText(Protocol):
    """An error in percent, with its sign if it is `signed`."""

    def __call__(self, error: float, *, signed: bool = True) -> str:
        """The text."""


def error_parts(
    stated: EntryRecord[Any, Any], *, named: bool = True, written: ErrorText = error_text
) -> tuple[str, str]:
    """An error and the half-width beside it as text; ("", "") without an error.

    Readings that lie farther apart than their half-width are shown as such, the lowest and the
    highest, with their names if `named`. Of any other interval that contains zero the largest size
    is the bound of the error: "below 4.4 %". An interval wider than the half-width is shown by its
    ends, an infinite one as "without bound". What is left is an error with its half-width.
    """
    error, half = stated.error, stated.uncertainty or 0.0
    if error is None:
        return "", ""
    low = error - half if stated.low is None else stated.low
    high = error + half if stated.high is None else stated.high
    apart = _apart(stated, written, named=named)
    far = apart and max(stated.readings.values()) - min(stated.readings.values()) > half
    largest = max(abs(low), abs(high))
    if isinf(largest):
        return written(error, signed=stated.signed), "without bound"
    if low <= 0.0 <= high and not far and largest - abs(error) >= _WORTH_SHOWING:
        return f"below {written(largest, signed=False)}", ""
    # More may be left open to one side, by other partners of a mode say.
    if max(error - low, high - error) - half >= _WORTH_SHOWING and not apart:
        return _range(low, high, written, signed=stated.signed), ""
    spread = f"±\u00a0{written(half, signed=False)}" if half >= _WORTH_SHOWING else ""
    return apart or written(error, signed=stated.signed), spread


def error_with_spread(stated: EntryRecord[Any, Any], written: ErrorText = error_text) -> str:
    """An error in one text: "+1.2 % ± 0.3 %", "below 4.4 %"; readings with their names."""
    return " ".join(filter(None, error_parts(stated, written=written)))


def bound(stated: EntryRecord[Any, Any]) -> float:
    """The largest size of an error that is left open."""
    ends = (stated.error, stated.low, stated.high)
    return max(abs(end) for end in ends if end is not None)


def _apart(stated: EntryRecord[Any, Any], written: ErrorText, *, named: bool) -> str:
    """The lowest and the highest reading; "" if there is one, or both read alike."""
    ranked = sorted(stated.readings.items(), key=lambda reading: reading[1])
    if len(ranked) < 2:
        return ""
    (first, low), (last, high) = ranked[0], ranked[-1]
    texts = [written(one, signed=stated.signed) for one in (low, high)]
    if texts[0] == texts[1] or high - low < _WORTH_SHOWING:
        return ""
    if named:
        return f"{texts[0]} with {first}, {texts[1]} with {last}"
    return _range(low, high, written, signed=stated.signed)


def _range(low: float, high: float, written: ErrorText, *, signed: bool) -> str:
    """Two errors with one sign of percent: "0 to 33 %"."""
    first, last = (written(end, signed=signed) for end in (low, high))
    return f"{first.removesuffix('%').rstrip()} to {last}"


def share_text(share: float) -> str:
    """How much of the tolerance an error uses."""
    if share < 0.0:
        return "inside the bound"
    if share > 1.0:
        return f"{number(share, 2)} times"
    return f"{100.0 * share:.2g}\u00a0%" if share >= 1e-4 or not share else "<\u00a00.01\u00a0%"


def tolerance(allowed: Tolerance, unit: str) -> str:
    """The tolerance as "±0.5 µm" or "±1 %"."""
    if isinstance(allowed, Absolute):
        return f"±{number(allowed.amount, 3)}\u00a0{unit}".removesuffix("\u00a01")
    return f"±{number(100.0 * allowed.fraction, 3)}\u00a0%"


def seconds(time: float) -> str:
    """A time in s or min."""
    if time < 0.05:
        return f"{1000.0 * time:.0f} ms"
    return f"{time:.1f} s" if time < 100.0 else f"{time / 60.0:.1f} min"


def anchor(identifier: str) -> str:
    """An id as it may stand in a link."""
    return re.sub(r"[^\w.+-]+", "_", identifier).rstrip("_")


def function_name(function: Callable[..., object]) -> str:
    """Where a function is found: module and name, for a closure those of the outer function.

    A partial, and what wraps a function (functools.wraps), is told by that.
    """
    function = unwrap(function)
    while isinstance(function, partial):
        function = unwrap(function.func)
    module = getattr(function, "__module__", type(function).__module__)
    name: str = getattr(function, "__qualname__", type(function).__qualname__)
    return f"{module}.{name.partition('.<locals>')[0]}"


def base64(content: bytes) -> str:
    """Bytes as text that a page can carry."""
    return b64encode(content).decode("ascii")


def data_uri(content: str | bytes, kind: str) -> str:
    """Content as a link that needs no file; `kind` as "text/csv;charset=utf-8"."""
    data = content.encode("utf-8") if isinstance(content, str) else content
    return f"data:{kind};base64,{base64(data)}"


def inline_svg(figure: Figure) -> str:
    """The figure's SVG with ids of its own, so that plots on one page do not mix them up."""
    own = f"{anchor(figure.id)}--"
    markup = re.sub(r'\bid="', f'id="{own}', figure.svg)
    markup = re.sub(r'(href="#|url\(#)', rf"\g<1>{own}", markup)
    return markup.replace("<svg ", f'<svg role="img" aria-label="{escape(figure.title)}" ', 1)
