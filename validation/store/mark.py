"""run.json: what a run's folder is known by, and what tells one run from another."""

from collections.abc import Mapping
from typing import Any, Literal

import msgspec

from lumped.errors import InputError
from validation.store.manifest import digest
from validation.store.tree import Tree

FILE = "run.json"


class Mark(msgspec.Struct, frozen=True):
    """What must not change when a run goes on: else old and new numbers would be mixed.

    The file holds the whole header of the run; the rest of it is for people.
    """

    flexproof: Literal["run"]
    robot: str = ""
    robot_sha256: str = ""
    preset: str = ""
    suite_sha256: str = ""
    versions: Mapping[str, str] = msgspec.field(default_factory=dict)
    options: Mapping[str, str] = msgspec.field(default_factory=dict)

    @property
    def run(self) -> str:
        """Name of the run: equal for runs whose numbers may be mixed."""
        return digest(msgspec.json.encode(self, order="deterministic"))

    def require_same(self, other: "Mark", tree: Tree) -> None:
        """Raise InputError, naming what differs, where `other` may not go on with this run."""
        named = [name for name in self.__struct_fields__ if name != "flexproof"]
        changed = [name for name in named if getattr(self, name) != getattr(other, name)]
        if changed:
            raise another_run(tree, f"{', '.join(_SPOKEN.get(n, n) for n in changed)} differ")


_SPOKEN = {"robot_sha256": "robot file", "suite_sha256": "source files of flexproof"}


def mark_of(header: Mapping[str, Any]) -> Mark:
    """The mark of a run with this header."""
    return msgspec.convert({"flexproof": "run", **header}, Mark)


def mark_text(header: Mapping[str, Any]) -> bytes:
    """The content of run.json."""
    text = msgspec.json.encode({"flexproof": "run", **header})
    return msgspec.json.format(text, indent=2) + b"\n"


def mark_in(tree: Tree) -> Mark | None:
    """The mark in a folder; None where there is none, or none of ours."""
    content = tree.read(FILE)
    try:
        return msgspec.json.decode(content, type=Mark) if content else None
    except (msgspec.MsgspecError, RecursionError):
        return None


def another_run(tree: Tree, why: str) -> InputError:
    """The refusal to mix two runs."""
    return InputError(
        f"--resume: {tree.path} belongs to another run ({why}); "
        "start afresh without --resume, or name another folder with --out"
    )
