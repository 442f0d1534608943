"""Numbers that people type on the command line."""

import re
from collections.abc import Sequence
from typing import Annotated, TypeAlias

from cyclopts import Parameter, Token


def _whole_number(_type: object, tokens: Sequence[Token]) -> int:
    # int() of the parser's own cuts 1.5 down to 1.
    text = tokens[0].value
    if not re.fullmatch(r"[+-]?\d{1,15}", text, re.ASCII):
        option = tokens[0].keyword
        raise ValueError(f'Invalid value "{text[:40]}" for {option}. Must be a whole number.')
    return int(text)


def _process_count(_type: object, tokens: Sequence[Token]) -> int:
    count = _whole_number(_type, tokens)
    if not 1 <= count <= 1024:
        raise ValueError(f'Invalid value "{count}" for --jobs. Must be a whole number, 1 to 1024.')
    return count


WholeNumber: TypeAlias = Annotated[int, Parameter(converter=_whole_number)]
ProcessCount: TypeAlias = Annotated[int | None, Parameter(converter=_process_count)]
