"""Reading of TOML and CSV files into tables. Files of other kinds are refused.

The uncertainty of a printed compliance is half a unit of its last digit: 1.67e-10 lies between
1.665e-10 and 1.675e-10. Zeros, integers and numbers changed by `--vary` count as exact. So does a
6×6 compliance whose entries have fewer than three digits: such entries are round figures chosen by
a designer.
"""

import csv
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal, InvalidOperation
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.files import read_ordinary
from lumped.memo import memo
from lumped.robot_file.rules.matrices import symmetric
from lumped.robot_file.rules.rule import too_many
from lumped.text import cut, shown

# Largest number of parts of a key "a.b.c". The time to parse a key grows with the square of it.
_MOST_PARTS = 100
_FEWEST_DIGITS = 3
_BETWEEN_KEYS = re.compile(r"[=,\[\]{}\n]")


class Printed(NamedTuple):
    """A symmetric 6×6 compliance (SI) of a robot file, and the precision of its printed digits.

    `half` (6×6) is half a unit of the last digit of each entry.
    """

    compliance: Array
    half: Array


class TableRow(NamedTuple):
    """A row of a CSV file: its `cells` by column heading, and its location `place` for messages."""

    place: str
    cells: Mapping[str, str]


def table_rows(path: Path, kind: str, columns: Sequence[str], most: int) -> list[TableRow]:
    """Rows of a CSV file, which must have the given `columns` and 1 to `most` rows.

    `kind` is the expected kind of file, for messages. Raises InputError with one line per fault.
    """
    try:
        text = read_ordinary(path, kind).decode("utf-8-sig")
        reader = csv.DictReader(StringIO(text, newline=""), restval="")
        missing = [name for name in columns if name not in (reader.fieldnames or ())]
        rows = [(f"{path}: line {reader.line_num}", row) for row in reader if not missing]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    faults = [f"{path}: lacks the column {', '.join(missing)}"] if missing else []
    repeated = [name for name, count in Counter(reader.fieldnames or ()).items() if count > 1]
    faults += [
        f"{path}: has the column {shown(name)} twice; must have it once" for name in repeated
    ]
    if not (rows or faults):
        faults = [f"{path}: contains no row; must be {kind}"]
    if len(rows) > most:
        faults = [too_many(str(path), len(rows), most)]
    # A decimal comma splits a cell into two.
    faults += [f"{location}: more cells than headings" for location, row in rows if None in row]
    if faults:
        raise InputError(faults)
    return [TableRow(*row) for row in rows]


def number_or_text(cell: str) -> int | float | str:
    """Number in a CSV cell, or the text of the cell if it is not a number."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell


def decoded(content: bytes, source: str) -> str:
    """Text of a file in UTF-8, with or without a byte order mark.

    Raises InputError if `content` is not UTF-8. `source` is the name of the file, for the message.
    """
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{source}: byte {error.start + 1} is not UTF-8; must be a TOML text in UTF-8"
        ) from error


def parsed(text: str, source: str) -> Mapping[str, Any]:
    """Tables of a TOML text from the file `source`. Raises InputError if it is not TOML."""
    keys = _BETWEEN_KEYS.split(re.sub("#.*", "", text))
    if max(key.count(".") for key in keys) > _MOST_PARTS:
        raise InputError(f"{source}: a key of more than {_MOST_PARTS} parts; not a robot file")
    try:
        return tables_of(text)
    except RecursionError:
        raise InputError(f"{source}: tables or lists nested too deeply; not a robot file") from None
    except ValueError as error:  # tomllib's own, or an integer of too many digits
        raise InputError(f"{source}: not TOML: {cut(str(error), 200)}") from error


@memo(16)
def tables_of(text: str) -> Mapping[str, Any]:
    """Tables of a TOML text without faults. They must not be changed."""
    tables: Mapping[str, Any] = _in_floats(decimal_tables(text))
    return tables


@memo(16)
def decimal_tables(text: str) -> Mapping[str, Any]:
    """Tables of a TOML text without faults, with all digits of its numbers (`Decimal`).

    They must not be changed. The text is parsed once per process.
    """
    return tomllib.loads(text, parse_float=_as_printed)


def _as_printed(number: str) -> Decimal | float:
    """Decimal with all digits of `number`.

    If its exponent is too large in magnitude, the result is a float: 0 or infinite.
    """
    try:
        return Decimal(number)
    except InvalidOperation:
        return float(number)


def _in_floats(value: Any) -> Any:
    """Copy of parsed TOML in which each `Decimal` is replaced by a float."""
    match value:
        case Decimal():
            return float(value)
        case dict():
            return {name: _in_floats(entry) for name, entry in value.items()}
        case list():
            return [_in_floats(entry) for entry in value]
    return value


def printed_compliances(tables: Mapping[str, Any]) -> Iterator[Printed]:
    """Each 6×6 `compliance` in the tables of a robot file, with the precision of its digits."""
    for name, inner in tables.items():
        if isinstance(inner, Mapping):
            yield from printed_compliances(inner)
        elif name == "compliance":
            yield Printed(symmetric(inner), _half_units(inner))


def _half_units(rows: list[list[Any]]) -> Array:
    numbers = [number for row in rows for number in row if isinstance(number, Decimal)]
    if max((len(number.as_tuple().digits) for number in numbers), default=0) < _FEWEST_DIGITS:
        return np.zeros((6, 6))
    half = np.array([[_half_unit(number) for number in row] for row in rows])
    return np.asarray(np.maximum(half, half.T))


def _half_unit(number: Decimal | int) -> float:
    if not isinstance(number, Decimal) or not number:
        return 0.0
    return float(Decimal((0, (5,), int(number.as_tuple().exponent) - 1)))
