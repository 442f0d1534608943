"""Marks of the fields of records: columns of tables and keys of JSON.

A mark is part of the annotation of a field: `Annotated[str, COLUMN]`. A table or JSON object of
records is made from the marks, so that the record alone lists its fields.
"""

from functools import lru_cache
from typing import Any, Literal, NamedTuple, TypeAlias, TypeVar, get_args, get_type_hints

Document: TypeAlias = Literal["results.json", "cases --json"]
M = TypeVar("M")


class Column(NamedTuple):
    """Marks a field that is a column of tables.

    The heading is the name of the field if it is "". `percent`: shares are written in per cent.
    """

    heading: str = ""
    percent: bool = False


class Key(NamedTuple):
    """Marks a field that is a key of JSON objects in `document`.

    The key is the name of the field if `name` is "".
    """

    document: Document
    name: str = ""


COLUMN = Column()
# Keys of results.json, and of the list of cases.
RESULTS, LISTING = Key("results.json"), Key("cases --json")


def columns_of(record: type) -> dict[str, Column]:
    """Columns by the names of the fields, in their order, with their headings."""
    return {
        name: column._replace(heading=column.heading or name.replace("_", " "))
        for name, column in _marked(record, Column)
    }


def json_object(record: Any, document: Document) -> dict[str, Any]:
    """Values of a record's fields by their keys in `document`."""
    return {
        key.name or name: getattr(record, name)
        for name, key in _marked(record.__class__, Key)
        if key.document == document
    }


@lru_cache
def _marked(record: type, kind: type[M]) -> tuple[tuple[str, M], ...]:
    """Names of fields with their marks of this kind."""
    return tuple(
        (name, mark)
        for name, hint in get_type_hints(record, include_extras=True).items()
        for mark in get_args(hint)
        if isinstance(mark, kind)
    )
