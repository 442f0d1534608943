"""Marks in files that commands write, by which an earlier result is told from a user's own file.

A mark stands where the format has room for a remark and holds a digest of the rest: neither a file
of somebody else nor a result that was changed since carries one that fits. CSV has no such room: of
a table the first line alone ends in CR LF, which all readers take, and editors and spreadsheets
change as they write.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from lumped.files import digest, read_regular

_MARK = "written by flexproof {}"
_TABLE = ".csv"
_LENGTH = len(_MARK.format(digest(b"")))


class _Format(Protocol):
    """A format with room for a mark, ASCII of a fixed length."""

    def plain(self, content: bytes) -> bytes:
        """The content without what the mark replaces."""

    def marked(self, plain: bytes, mark: bytes) -> bytes:
        """The content with a mark."""

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        """The content without its mark, and the mark; b"" if there is none."""


@dataclass(frozen=True)
class _Text:
    """A text whose second line is a comment: `begin`, the mark and `end`."""

    begin: bytes
    end: bytes = b""

    def plain(self, content: bytes) -> bytes:
        return content

    def marked(self, plain: bytes, mark: bytes) -> bytes:
        first, line_end, rest = plain.partition(b"\n")
        return first + line_end + self.begin + mark + self.end + b"\n" + rest

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        first, _, others = content.partition(b"\n")
        second, _, rest = others.partition(b"\n")
        if not (second.startswith(self.begin) and second.endswith(self.end)):
            return content, b""
        return first + b"\n" + rest, second[len(self.begin) : len(second) - len(self.end)]


class _Png:
    """A chunk of text after the header (PNG, third edition, 11.3.3)."""

    _header = 33  # bytes: signature and IHDR
    _keyword = b"tEXtComment\x00"

    def plain(self, content: bytes) -> bytes:
        return content

    def marked(self, plain: bytes, mark: bytes) -> bytes:
        return plain[: self._header] + self._chunk(mark) + plain[self._header :]

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        rest = content[self._header :]
        begin = 4 + len(self._keyword)
        mark = rest[begin : begin + _LENGTH]
        chunk = self._chunk(mark)
        if not rest.startswith(chunk):
            return content, b""
        return content[: self._header] + rest[len(chunk) :], mark

    def _chunk(self, mark: bytes) -> bytes:
        text = self._keyword + mark
        return (len(text) - 4).to_bytes(4, "big") + text + zlib.crc32(text).to_bytes(4, "big")


class _Zip:
    """The comment at the end of an archive (.npz)."""

    _size = _LENGTH.to_bytes(2, "little")

    def plain(self, content: bytes) -> bytes:
        return content

    def marked(self, plain: bytes, mark: bytes) -> bytes:
        return plain[:-2] + self._size + mark

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        if content[-_LENGTH - 2 : -_LENGTH] != self._size:
            return content, b""
        return content[: -_LENGTH - 2] + bytes(2), content[-_LENGTH:]


class _Matlab:
    """The text with which a MAT file of level 5 begins."""

    _begin = b"MATLAB 5.0 MAT-file, "
    _text = 116  # bytes

    def plain(self, content: bytes) -> bytes:
        return content[self._text :]

    def marked(self, plain: bytes, mark: bytes) -> bytes:
        return (self._begin + mark).ljust(self._text) + plain

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        text = content[: self._text]
        found = text[len(self._begin) :].rstrip() if text.startswith(self._begin) else b""
        return content[self._text :], found


_MARKUP = _Text(b"<!-- ", b" -->")
_FORMATS: Mapping[str, _Format] = {
    ".py": _Text(b"# "),
    ".bdf": _Text(b"$ "),
    ".html": _MARKUP,
    ".svg": _MARKUP,
    ".png": _Png(),
    ".npz": _Zip(),
    ".mat": _Matlab(),
}


def marked(content: bytes, kind: str) -> bytes:
    """The content of a file of a `kind` (its ending) with a mark."""
    if kind == _TABLE:
        return content.replace(b"\n", b"\r\n", 1)
    own = _FORMATS[kind]
    plain = own.plain(content)
    return own.marked(plain, _mark(plain))


def is_marked(path: Path, kind: str) -> bool:
    """Whether a file is one that a command wrote, unchanged since; False if it cannot be read."""
    content = read_regular(path.resolve())
    if content is None:
        return False
    if kind == _TABLE:
        first, _, rest = content.partition(b"\n")
        return first.endswith(b"\r") and bool(rest) and b"\r" not in first[:-1] + rest
    own = _FORMATS[kind]
    plain, mark = own.split(content)
    return mark == _mark(plain) and own.marked(plain, mark) == content


def _mark(plain: bytes) -> bytes:
    return _MARK.format(digest(plain)).encode("ascii")
