"""From a path to the tables of a TOML file, refused where it is none before it costs anything."""

import re
import tomllib
from typing import Any

from lumped.errors import InputError
from lumped.text import cut

_DEEPEST = 100
# Strings (closed or not), comments, and what opens, closes or separates tables and keys.
_TOKENS = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"""|\Z)'
    r"|'''.*?(?:'''|\Z)"
    r'|"(?:\\.|[^"\\\n])*"?'
    r"|'[^'\n]*'?"
    r"|#[^\n]*"
    r"|[\[{\]}.=,\n]",
    re.DOTALL,
)


def decoded(content: bytes, source: str) -> str:
    """The text of a file in UTF-8, with or without a byte order mark; raises InputError."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{source}: byte {error.start + 1} is not UTF-8; must be a TOML text in UTF-8"
        ) from error


def parsed(text: str, source: str) -> dict[str, Any]:
    """The tables of a TOML text, nested at most 100 deep; raises InputError."""
    if (line := _line_nested_too_deeply(text)) is not None:
        raise InputError(
            f"{source}: line {line} is nested more than {_DEEPEST} deep; not a robot file"
        )
    try:
        return tomllib.loads(text)
    except ValueError as error:  # tomllib's own, or an integer of too many digits
        raise InputError(f"{source}: not TOML: {cut(str(error), 200)}") from error


def _line_nested_too_deeply(text: str) -> int | None:
    """Number (from 1) of the line at which brackets or the dots of a key go too deep."""
    depth = dots = 0
    for token in _TOKENS.finditer(text):
        sign = token[0]
        if sign in "[{":
            depth += 1
        elif sign in "]}":
            depth = max(0, depth - 1)
        if sign == ".":
            dots += 1
        elif sign in "[{]}=,\n":
            dots = 0
        if depth > _DEEPEST or dots > _DEEPEST:
            return text.count("\n", 0, token.start()) + 1
    return None
