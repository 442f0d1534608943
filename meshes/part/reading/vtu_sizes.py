"""What the compressed arrays of a .vtu file come to: told before, and held to while inflating.

Each begins with whole numbers: how many blocks, bytes of a block, bytes of the last one where it is
a smaller one, and bytes of each as it is compressed (VTK file formats, "XML file formats").
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
    """Bytes of all compressed arrays of a .vtu file, as it says itself; 0 where none is."""
    root = _ROOT.search(content)
    if root is None or b"compressor" not in root.group():
        return 0
    order = ">" if b"BigEndian" in root.group() else "<"
    whole = np.dtype(f"{order}u{8 if b'UInt64' in root.group() else 4}")
    total = 0
    for start, is_raw in _arrays(content):
        size = _COUNTS * whole.itemsize
        # A multiple of three bytes: four signs of base64 for each.
        head = content[start : start + (size if is_raw else size // 3 * 4)]
        try:
            head = head if is_raw else b64decode(head)
        except ValueError:
            continue
        if len(head) == size:
            blocks, block, last = map(int, np.frombuffer(head, whole))
            total += blocks * block if last == 0 else max(blocks - 1, 0) * block + last
    return total


def _arrays(content: bytes) -> Iterator[tuple[int, bool]]:
    """Where the bytes of each array begin, and whether they are raw ones."""
    appended = _APPENDED.search(content)
    for array in _ARRAY.finditer(content, 0, appended.start() if appended else len(content)):
        offset = _OFFSET.search(array.group(1))
        if appended and offset:
            yield appended.end() + int(offset.group(1)), b"raw" in appended.group(1)
        elif _BINARY.search(array.group(1)):
            yield array.end(), False


@contextmanager
def inflating(most: int) -> Iterator[None]:
    """What meshio inflates of one file while the context lasts comes to so many bytes at most.

    meshio raises its ReadError where the file holds more than that.
    """
    from meshio.vtu import _vtu as reader  # noqa: PLC0415  a library that few wait for

    own = reader.zlib, reader.lzma
    reader.zlib = _Bounded(zlib.decompressobj, most)
    reader.lzma = _Bounded(lzma.LZMADecompressor, most)
    try:
        yield
    finally:
        reader.zlib, reader.lzma = own


@dataclass
class _Bounded:
    """Stands for a library that inflates blocks: all of them come to what is `left` (bytes)."""

    begin: Callable[[], Any]
    left: int

    def decompress(self, block: bytes) -> bytes:
        from meshio import ReadError  # noqa: PLC0415

        stream = self.begin()
        inflated: bytes = stream.decompress(block, self.left + 1)
        self.left -= len(inflated)
        if self.left < 0 or not stream.eof:
            raise ReadError("a compressed array holds more or less than the file says")
        return inflated
