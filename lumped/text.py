"""Display of texts from files: shortened, and without characters that control a terminal."""

import json
import unicodedata
from collections.abc import Collection, Iterable, Sequence
from difflib import get_close_matches

# Unicode categories that are escaped: control characters, marks that reorder adjacent text or have
# no width, and surrogates (from file names that are not UTF-8).
_ESCAPED_CATEGORIES = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})

_LONGEST_VALUE = 60
_LONGEST_LINE = 500
# Longest name for which similar known names are searched. All known names are shorter.
_LONGEST_NAME = 100


def shown(value: object) -> str:
    """Text of a value from a file for a message: one short line, approximately as typed."""
    try:
        text = repr(value) if isinstance(value, float) else _as_json(value)
    except ValueError:
        # Python refuses to print integers of more than a few thousand digits.
        return "a number of thousands of digits"
    except RecursionError:
        return "tables in tables"
    return cut(text, _LONGEST_VALUE)


def cut(text: str, longest: int) -> str:
    """`text`, or its beginning and "…" if it is longer than `longest` characters."""
    return text if len(text) <= longest else text[: longest - 1] + "…"


def shortened(line: str) -> str:
    """`line`, or its beginning, "…" and its end if it is longer than 500 characters."""
    if len(line) <= _LONGEST_LINE:
        return line
    # A message begins with the location and ends with the reason.
    begin = _LONGEST_LINE * 2 // 3
    return f"{line[:begin]}…{line[begin + 1 - _LONGEST_LINE :]}"


def counted(count: int, singular: str, plural: str = "") -> str:
    """Number and noun, such as "1 leg" or "2 legs". `plural` is needed if it is irregular."""
    return f"{count} {singular if count == 1 else plural or f'{singular}s'}"


def aligned(headings: Sequence[str], rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """A table as plain text with two blanks between columns. Numbers are aligned to the right."""
    lines = [list(headings), *[list(row) for row in rows]]
    widths = [max(len(line[k]) for line in lines) for k in range(len(headings))]
    numeric = [all(_is_number(row[k]) for row in rows) for k in range(len(headings))]
    return "\n".join(
        indent
        + "  ".join(
            entry.rjust(width) if right_aligned else entry.ljust(width)
            for entry, width, right_aligned in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in lines
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def unknown_name(key: str, name: str, valid_names: Collection[str], allowed: str) -> str:
    """Error message for the unknown name `name` at `key`. It suggests the most similar valid name.

    If no name is similar, it lists all valid ones. `allowed` describes them, such as "a body".
    """
    advice = did_you_mean(name, valid_names, otherwise=f": {', '.join(valid_names) or 'none'}")
    return f"{key} = {shown(name)}: must be {allowed}{advice}"


def did_you_mean(
    name: str, valid_names: Iterable[str], otherwise: str = "", cutoff: float = 0.6
) -> str:
    """Suggestion of the most similar valid name, to end a message. `otherwise` if there is none.

    `cutoff` is the smallest similarity, from 0 to 1 (`difflib`).
    """
    by_lower_case = {known_name.lower(): known_name for known_name in valid_names}
    if len(name) <= _LONGEST_NAME and (
        close := get_close_matches(name.lower(), by_lower_case, n=1, cutoff=cutoff)
    ):
        return f'; did you mean "{by_lower_case[close[0]]}"?'
    return otherwise


def _as_json(value: object) -> str:
    # Only the beginning of a long text or list is displayed.
    if isinstance(value, str | list):
        value = value[: _LONGEST_VALUE + 1]
    return json.dumps(value, ensure_ascii=False, default=str)


def visible(text: str, keep: str = "") -> str:
    r"""`text` with control and format characters escaped, such as \x1b or \u202e.

    Characters in `keep` (for example line ends) remain unchanged.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        character
        if character in keep or unicodedata.category(character) not in _ESCAPED_CATEGORIES
        else character.encode("unicode_escape").decode()
        for character in text
    )
