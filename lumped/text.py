"""What others wrote, as it may be shown: short, and nothing in it steers a terminal."""

import json
import unicodedata
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

# Control characters, marks that reorder what stands around them or take no room, and halves of
# characters (a file name that is not UTF-8).
_UNSHOWN = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})

_LONGEST_VALUE = 60
_LONGEST_LINE = 500
# No known name is near to a longer one.
_LONGEST_NAME = 100


def shown(value: object) -> str:
    """A value of a file as its author typed it, near enough, cut to one short line."""
    try:
        text = repr(value) if isinstance(value, float) else _as_json(value)
    except ValueError:
        # Python refuses to write integers of more than some thousand digits.
        return "a number of thousands of digits"
    except RecursionError:
        return "tables in tables"
    return cut(text, _LONGEST_VALUE)


def cut(text: str, longest: int) -> str:
    """The text, or its beginning and … where it is longer than that."""
    return text if len(text) <= longest else text[: longest - 1] + "…"


def shortened(line: str) -> str:
    """The line, or where it is too long for one its beginning, … and its end."""
    if len(line) <= _LONGEST_LINE:
        return line
    # Places come first, reasons last.
    begin = _LONGEST_LINE * 2 // 3
    return f"{line[:begin]}…{line[begin + 1 - _LONGEST_LINE :]}"


def counted(count: int, one: str, several: str = "") -> str:
    """How many there are: "1 body", "2 bodies"; `several` where that is not `one` with an s."""
    return f"{count} {one if count == 1 else several or f'{one}s'}"


def aligned(headings: Sequence[str], rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """A table as plain text with two blanks between columns; numbers align to the right."""
    lines = [list(headings), *[list(row) for row in rows]]
    widths = [max(len(line[k]) for line in lines) for k in range(len(headings))]
    numeric = [all(_is_number(row[k]) for row in rows) for k in range(len(headings))]
    return "\n".join(
        indent
        + "  ".join(
            entry.rjust(width) if right else entry.ljust(width)
            for entry, width, right in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in lines
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "", cutoff: float = 0.6) -> str:
    """The end of a fault that asks for the nearest known name; `otherwise` where none is near."""
    by_lower_case = {one.lower(): one for one in known}
    if len(name) <= _LONGEST_NAME and (
        close := get_close_matches(name.lower(), by_lower_case, n=1, cutoff=cutoff)
    ):
        return f'; did you mean "{by_lower_case[close[0]]}"?'
    return otherwise


def _as_json(value: object) -> str:
    # Of a long text or list only the beginning will be seen.
    if isinstance(value, str | list):
        value = value[: _LONGEST_VALUE + 1]
    return json.dumps(value, ensure_ascii=False, default=str)


def visible(text: str, keep: str = "") -> str:
    r"""The text with each control and format character written out as \x1b or \u202e.

    Characters of `keep` (line ends, say) stay as they are.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        one
        if one in keep or unicodedata.category(one) not in _UNSHOWN
        else one.encode("unicode_escape").decode()
        for one in text
    )
