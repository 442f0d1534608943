"""A record as one line of text that says what it belongs to, and whether it is as it was written.

Who reads it back computes its digest again: what is damaged, changed, or of other work is nothing.
"""

import json
from collections.abc import Mapping
from typing import Any, Literal

import msgspec

from validation.store.manifest import digest


class _Sealed(msgspec.Struct, frozen=True):
    flexproof: Literal["record"]
    run: str
    digest: str
    record: dict[str, Any]


def sealed_record(run: str, record: Mapping[str, Any]) -> str:
    """The line for a record of the work named `run`, without a line break."""
    # Records hold NaN, which JSON proper cannot: only this program reads them.
    text = json.dumps(record)
    head = {"flexproof": "record", "run": run, "digest": _digest(run, text)}
    return f'{json.dumps(head)[:-1]}, "record": {text}}}'


def unsealed_record(run: str, content: bytes) -> dict[str, Any] | None:
    """The record in a line; None where it is damaged, changed, or of other work than `run`."""
    try:
        sealed = msgspec.convert(json.loads(content), _Sealed)
    except (ValueError, msgspec.MsgspecError, RecursionError):
        return None
    # Python writes a number so that it reads the same one: the text comes out as it was.
    holds = sealed.run == run and sealed.digest == _digest(run, json.dumps(sealed.record))
    return sealed.record if holds else None


def _digest(run: str, text: str) -> str:
    return digest(f"{run}\n{text}".encode())
