"""Annotations of record fields, from which columns of tables and keys of JSON are made.

Input: records whose fields are annotated, as in `Annotated[str, COLUMN]`. Output: column headings,
and JSON objects. Fields are listed in the record only.
"""

import json
from functools import lru_cache
from math import isfinite
from typing import Any, Literal, NamedTuple, TypeAlias, TypeVar, get_args, get_type_hints

import msgspec
import numpy as np

from lumped.arrays import Array

Document: TypeAlias = Literal["results.json", "cases --json"]
M = TypeVar("M")


class Column(NamedTuple):
    """Annotation of a field that is a column of tables.

    The heading is the name of the field if `heading` is "". If `percent`, ratios are written in per
    cent.
    """

    heading: str = ""
    percent: bool = False


class JsonKey(NamedTuple):
    """Annotation of a field that is a key of JSON objects in `document`.

    The key is the name of the field if `name` is "".
    """

    document: Document
    name: str = ""


class CountRecord(msgspec.Struct, frozen=True):
    """Number of modes of a part below a frequency (Hz). Both are None if they were not counted."""

    count: int | None
    below: float | None


COLUMN = Column()
# Keys of results.json, and of the list of cases.
RESULTS, LISTING = JsonKey("results.json"), JsonKey("cases --json")


def columns_of(record: type) -> dict[str, Column]:
    """Columns of a record by field name, in order, with their headings."""
    return {
        name: column._replace(heading=column.heading or name.replace("_", " "))
        for name, column in _marked(record, Column)
    }


def json_object(record: Any, document: Document) -> dict[str, Any]:
    """Values of a record's fields by their keys in `document`."""
    return {
        key.name or name: getattr(record, name)
        for name, key in _marked(record.__class__, JsonKey)
        if key.document == document
    }


def plain_data(record: Any) -> Any:
    """Records and arrays as dictionaries, lists and numbers. NaN and infinite numbers are kept."""
    return msgspec.to_builtins(record, enc_hook=_of_numpy)


def json_text(record: Any) -> str:
    """JSON of a record, with null for None.

    Raises ValueError if it contains a number that is not finite.
    """
    return json.dumps(plain_data(record), allow_nan=False)


def finite(value: float) -> float | None:
    """The number itself, or None if it is infinite or NaN."""
    return float(value) if isfinite(value) else None


def finite_items(values: Array) -> Any:
    """Nested lists of an array's numbers, with None for each that is infinite or NaN."""
    items = values.astype(object)
    items[~np.isfinite(values)] = None
    return items.tolist()


def _of_numpy(value: object) -> object:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} cannot be stored")


@lru_cache
def _marked(record: type, kind: type[M]) -> tuple[tuple[str, M], ...]:
    """Names of the fields with an annotation of class `kind`, and the annotations."""
    return tuple(
        (name, mark)
        for name, hint in get_type_hints(record, include_extras=True).items()
        for mark in get_args(hint)
        if isinstance(mark, kind)
    )
