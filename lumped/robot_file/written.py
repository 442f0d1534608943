"""TOML text of dictionaries that contain numbers, texts, lists and tables."""

import json
import re
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from pathlib import PurePath
from typing import Any

import numpy as np

from lumped.errors import InputError
from lumped.text import shown

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_of(tables: Mapping[str, Any]) -> str:
    """TOML text of a dictionary, one line for each top-level entry.

    Numpy arrays are written as lists, paths as texts. Raises InputError with one line for each
    value that TOML cannot represent.
    """
    faults: list[str] = []
    lines = [f"{_key(key)} = {_value(value, str(key), faults)}" for key, value in tables.items()]
    if faults:
        raise InputError(faults)
    return "\n".join(lines) + "\n"


def toml_value(value: object) -> str:
    """TOML text of one value, on one line. Raises InputError like `toml_of`."""
    faults: list[str] = []
    text = _value(value, "value", faults)
    if faults:
        raise InputError(faults)
    return text


def _key(key: object) -> str:
    return str(key) if _BARE.fullmatch(str(key)) else _text(str(key))


def _text(text: str) -> str:
    # Texts are written as in JSON, except for this one control character.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: object, location: str, faults: list[str]) -> str:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    match value:
        case Mapping():
            values = [_value(entry, f"{location}.{key}", faults) for key, entry in value.items()]
            entries = (f"{_key(key)} = {text}" for key, text in zip(value, values, strict=True))
            return f"{{ {', '.join(entries)} }}"
        case str() | PurePath():
            return _text(str(value))
        case Sequence() if not isinstance(value, bytes | bytearray):
            values = [
                _value(entry, f"{location}[{n}]", faults) for n, entry in enumerate(value, start=1)
            ]
            return f"[{', '.join(values)}]"
    return _number(value, location, faults)


def _number(value: object, location: str, faults: list[str]) -> str:
    match value:
        case bool():
            return str(value).lower()
        case Integral():
            return str(int(value))
        case Real():
            return repr(float(value))
    faults.append(f"{location} = {shown(value)}: must be a number, a text, a list or a dictionary")
    return '""'
