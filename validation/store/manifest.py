"""What the program itself wrote into a folder: only that is ever removed or replaced.

A line is added before a file is written, so that after a kill nothing of ours is taken for
somebody's. A file is ours as long as it holds what was written; else it is its owner's, or damaged,
and is kept. A power cut may lose the last lines: that errs on the safe side.
"""

import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Literal

import msgspec

from validation.store.tree import Tree

FILE = ".manifest"
_SEAL = b"\nflexproof "
_DIGEST = 32
# Units of the sweeps, and one on its way to the disk; several processes write them, without a
# manifest. What lies elsewhere is another run's or somebody's copy, whatever its seal says.
_UNIT = re.compile(r"sweeps/([0-9a-f]{32})\.npz")
_HALF_UNIT = re.compile(r"sweeps/\.[0-9a-f]{32}\.npz\.[0-9a-f]{16}\.tmp")


class _Head(msgspec.Struct, frozen=True):
    """First line: what is being run."""

    flexproof: Literal["manifest"]
    run: str


class _Line(msgspec.Struct, frozen=True):
    """A file as it was written; `growing`: the digest is that of its first line."""

    path: str
    digest: str
    temporary: str = ""
    growing: bool = False


@dataclass
class Manifest:
    """The lines on a folder's files; `run` is what they belong to, None where that is not known."""

    tree: Tree
    run: str | None = None
    digests: dict[str, set[str]] = field(default_factory=dict)
    growing: set[str] = field(default_factory=set)
    temporary: set[str] = field(default_factory=set)

    def owns(self, name: str) -> bool:
        """Whether a regular file holds what this program wrote there."""
        content = self.tree.read(name)
        if content is None:
            return False
        if name == FILE or self._is_half_written(name):
            return True
        written = self.digests.get(name, set())
        if name in self.growing:
            return digest(content.split(b"\n", 1)[0]) in written
        unit = _UNIT.fullmatch(name)
        return digest(content) in written or (
            unit is not None and unsealed(unit[1], content) is not None
        )

    def own(self) -> list[str]:
        """All files that are ours, the manifest last."""
        names = [name for name in self.tree.files() if name != FILE and self.owns(name)]
        return [*names, *([FILE] if self.tree.kind(FILE) == "file" else [])]

    def half_written(self) -> list[str]:
        """Files that a kill left unfinished under a name that nobody else had."""
        return [
            name
            for name in self.tree.files()
            if self._is_half_written(name) and self.tree.kind(name) == "file"
        ]

    def begin(self, run: str) -> None:
        """Say what the following files belong to."""
        self.run = run
        self._add(_Head("manifest", run))

    def expect(
        self,
        name: str,
        content: bytes,
        temporary: str = "",
        kind: Literal["whole", "growing"] = "whole",
    ) -> None:
        """Note a file that is about to be written; of a growing one, its first line."""
        line = _Line(name, digest(content), temporary, kind == "growing")
        self._add(line)
        self._take(line)

    def _is_half_written(self, name: str) -> bool:
        return name in self.temporary or _HALF_UNIT.fullmatch(name) is not None

    def _add(self, line: _Head | _Line) -> None:
        # A line that a full disk cut off does not spoil the next one.
        self.tree.append(FILE, b"\n" + msgspec.json.encode(line))

    def _take(self, line: _Line) -> None:
        self.digests.setdefault(line.path, set()).add(line.digest)
        if line.temporary:
            self.temporary.add(line.temporary)
        if line.growing:
            self.growing.add(line.path)


def manifest_of(tree: Tree) -> Manifest:
    """The manifest of a folder; lines that are damaged are passed over."""
    manifest = Manifest(tree)
    for line in _lines(tree.read(FILE) or b""):
        if isinstance(line, _Head):
            manifest.run = line.run
        else:
            manifest._take(line)
    return manifest


def digest(content: bytes) -> str:
    """Digest of a file's content."""
    return blake2b(content, digest_size=_DIGEST // 2).hexdigest()


def sealed(key: str, content: bytes) -> bytes:
    """The content with a last line that proves it to be ours, whole, and filed under `key`."""
    return content + _SEAL + digest(key.encode() + b"\n" + content).encode()


def unsealed(key: str, content: bytes) -> bytes | None:
    """The content before its seal; None where the seal does not hold."""
    body = content[: -len(_SEAL) - _DIGEST]
    return body if len(body) > 0 and sealed(key, body) == content else None


def _lines(content: bytes) -> Iterator[_Head | _Line]:
    decoders: tuple[Callable[[bytes], _Line | _Head], ...] = (
        msgspec.json.Decoder(_Line).decode,
        msgspec.json.Decoder(_Head).decode,
    )
    for text in content.splitlines():
        for decode in decoders:
            with suppress(msgspec.MsgspecError, RecursionError):
                yield decode(text)
                break
