"""Uncompressed size of the arrays in a .vtu file: read in advance, and enforced when inflating.

Each compressed array begins with integers: number of blocks, bytes of a block, bytes of the last
block if it is smaller (otherwise 0), and compressed bytes of each block (VTK file formats, "XML
file formats").
"""

import lzma
import re
import zlib
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

_ROOT = re.compile(rb"<VTKFile\b[^>]*>")
_ARRAY = re.compile(rb"<DataArray\b((?:[^>\"']|\"[^\"]*\"|'[^']*')*)>\s*")
_APPENDED = re.compile(rb"<AppendedData\b([^>]*)>\s*_")
_OFFSET = re.compile(rb"offset=[\"']\s*(\d+)")
_BINARY = re.compile(rb"format=[\"']binary")
_COUNTS = 3


def inflated_size(content: bytes) -> int:
    """Uncompressed size (bytes) of all compressed arrays of a .vtu file, from their headers.

    Zero if the arrays of the file are not compressed.
    """
    root = _ROOT.search(content)
    if root is None or b"compressor" not in root.group():
        return 0
    order = ">" if b"BigEndian" in root.group() else "<"
    integer_type = np.dtype(f"{order}u{8 if b'UInt64' in root.group() else 4}")
    total = 0
    for start, is_raw in _arrays(content):
        size = _COUNTS * integer_type.itemsize
        # The size is a multiple of three bytes. Base64 uses four characters for three bytes.
        head = content[start : start + (size if is_raw else size // 3 * 4)]
        try:
            head = head if is_raw else b64decode(head)
        except ValueError:
            continue
        if len(head) == size:
            blocks, block, last = map(int, np.frombuffer(head, integer_type))
            total += blocks * block if last == 0 else max(blocks - 1, 0) * block + last
    return total


def _arrays(content: bytes) -> Iterator[tuple[int, bool]]:
    """Yield for each array of a file the position of its first byte, and True if it is raw.

    An array that is not raw is coded in base64.
    """
    appended = _APPENDED.search(content)
    for array in _ARRAY.finditer(content, 0, appended.start() if appended else len(content)):
        offset = _OFFSET.search(array.group(1))
        if appended and offset:
            yield appended.end() + int(offset.group(1)), b"raw" in appended.group(1)
        elif _BINARY.search(array.group(1)):
            yield array.end(), False


@contextmanager
def inflating(limit: int) -> Iterator[None]:
    """Context in which meshio inflates at most `limit` bytes of one file.

    If the file contains more, meshio raises its ReadError.
    """
    from meshio.vtu import _vtu as reader  # noqa: PLC0415  slow to import, and rarely needed

    originals = reader.zlib, reader.lzma
    reader.zlib = _Bounded(zlib.decompressobj, limit)
    reader.lzma = _Bounded(lzma.LZMADecompressor, limit)
    try:
        yield
    finally:
        reader.zlib, reader.lzma = originals


@dataclass
class _Bounded:
    """Replacement of the module zlib or lzma in meshio, with a limit on the uncompressed size.

    `begin` creates a decompressor of one block. `remaining` (bytes) is the limit for all blocks
    that are still to be decompressed.
    """

    begin: Callable[[], Any]
    remaining: int

    def decompress(self, block: bytes) -> bytes:
        from meshio import ReadError  # noqa: PLC0415

        stream = self.begin()
        inflated: bytes = stream.decompress(block, self.remaining + 1)
        self.remaining -= len(inflated)
        if self.remaining < 0 or not stream.eof:
            raise ReadError("a compressed array is longer or shorter than the file specifies")
        return inflated
