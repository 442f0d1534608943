"""Marks in result files, which distinguish earlier results from files of the user.

Input: content of a result file. Output: content with a mark, and a test for it. Rule: the mark is a
comment with a digest of the rest of the file, so a file of the user, or an edited result, has no
valid mark. CSV has no comments: a table is marked by CR LF at the end of its first line only. All
readers accept this mark; editors and spreadsheets remove it when they change the file.
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
    """File format with room for a mark (ASCII, fixed length)."""

    def plain(self, content: bytes) -> bytes:
        """Content without the bytes that the mark will replace."""

    def with_mark(self, plain: bytes, mark: bytes) -> bytes:
        """Content `plain` with a mark inserted or appended."""

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        """Content without its mark, and the mark. The mark is b"" if there is none."""


@dataclass(frozen=True)
class _Text:
    """Text format with a comment as its second line: `begin`, the mark and `end`."""

    begin: bytes
    end: bytes = b""

    def plain(self, content: bytes) -> bytes:
        return content

    def with_mark(self, plain: bytes, mark: bytes) -> bytes:
        first, line_end, rest = plain.partition(b"\n")
        return first + line_end + self.begin + mark + self.end + b"\n" + rest

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        first, _, remainder = content.partition(b"\n")
        second, _, rest = remainder.partition(b"\n")
        if not (second.startswith(self.begin) and second.endswith(self.end)):
            return content, b""
        return first + b"\n" + rest, second[len(self.begin) : len(second) - len(self.end)]


class _Png:
    """PNG with the mark in a text chunk after the header (PNG, third edition, 11.3.3)."""

    _header = 33  # bytes: signature and IHDR
    _keyword = b"tEXtComment\x00"

    def plain(self, content: bytes) -> bytes:
        return content

    def with_mark(self, plain: bytes, mark: bytes) -> bytes:
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
    """Archive (.npz) with the mark in the comment at its end."""

    _size = _LENGTH.to_bytes(2, "little")

    def plain(self, content: bytes) -> bytes:
        return content

    def with_mark(self, plain: bytes, mark: bytes) -> bytes:
        return plain[:-2] + self._size + mark

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        if content[-_LENGTH - 2 : -_LENGTH] != self._size:
            return content, b""
        return content[: -_LENGTH - 2] + bytes(2), content[-_LENGTH:]


class _Matlab:
    """MAT file of level 5 with the mark in the text of its header."""

    _begin = b"MATLAB 5.0 MAT-file, "
    _text = 116  # bytes

    def plain(self, content: bytes) -> bytes:
        return content[self._text :]

    def with_mark(self, plain: bytes, mark: bytes) -> bytes:
        return (self._begin + mark).ljust(self._text) + plain

    def split(self, content: bytes) -> tuple[bytes, bytes]:
        text = content[: self._text]
        mark = text[len(self._begin) :].rstrip() if text.startswith(self._begin) else b""
        return content[self._text :], mark


_MARKUP = _Text(b"<!-- ", b" -->")
_FORMATS: Mapping[str, _Format] = {
    ".py": _Text(b"# "),
    ".bdf": _Text(b"$ "),
    ".html": _MARKUP,
    ".svg": _MARKUP,
    ".vtu": _MARKUP,
    ".png": _Png(),
    ".npz": _Zip(),
    ".mat": _Matlab(),
}


def with_mark(content: bytes, kind: str) -> bytes:
    """Content of a file with a mark. `kind` is the suffix of the file, such as ".svg".

    A kind of file without a format for marks has none.
    """
    if kind == _TABLE:
        return content.replace(b"\n", b"\r\n", 1)
    if (file_format := _FORMATS.get(kind)) is None:
        return content
    plain = file_format.plain(content)
    return file_format.with_mark(plain, _mark(plain))


def is_marked(path: Path, kind: str) -> bool:
    """True if a command wrote the file and nobody changed it. False if it cannot be read."""
    content = read_regular(path.resolve())
    if content is None:
        return False
    if kind == _TABLE:
        first, _, rest = content.partition(b"\n")
        return first.endswith(b"\r") and bool(rest) and b"\r" not in first[:-1] + rest
    if (file_format := _FORMATS.get(kind)) is None:
        return False
    plain, mark = file_format.split(content)
    return mark == _mark(plain) and file_format.with_mark(plain, mark) == content


def _mark(plain: bytes) -> bytes:
    return _MARK.format(digest(plain)).encode("ascii")
