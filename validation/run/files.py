"""Files that are written whole or not at all, and read without waiting or following links."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import blake2b
from itertools import count
from pathlib import Path
from secrets import token_hex

_READ = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


class StoreError(Exception):
    """Nothing more can be written (disk full, device gone); what was written before is kept."""


@contextmanager
def refusals(path: Path) -> Iterator[None]:
    """What the operating system refuses while `path` is written, as StoreError."""
    try:
        yield
    except OSError as error:
        named = f" ({error.filename})" if isinstance(error.filename, str) else ""
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}{named}; "
            "what was finished before is kept"
        ) from error


def write_whole(path: Path, content: bytes, beside: Path | None = None) -> None:
    """Replace a file in a folder that exists, or make it: flushed to the disk, then renamed.

    It is written in the same folder, or in `beside`. A link is replaced, not what it leads to.
    Raises OSError; what was there then remains.
    """
    # A name as long as the file system allows leaves no room for more in it.
    half = (beside or path.parent) / f".{path.name[:200]}.{token_hex(8)}.tmp"
    try:
        with half.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        half.replace(path)
    except (OSError, KeyboardInterrupt):
        with suppress(OSError):
            half.unlink()
        raise


def read_regular(path: Path) -> bytes | None:
    """Content of a regular file; None where there is none that can be read.

    A pipe or a device is opened without waiting for its other end, and then not read.
    """
    try:
        with os.fdopen(os.open(path, _READ), "rb") as file:
            return file.read() if stat.S_ISREG(os.fstat(file.fileno()).st_mode) else None
    except OSError:
        return None


def digest(content: bytes) -> str:
    """Digest of a content: 32 hexadecimal digits."""
    return blake2b(content, digest_size=16).hexdigest()


def free(place: Path) -> Path:
    """A name beside that nobody has."""
    names = (f"{place.name}.kept{'' if number == 1 else number}" for number in count(1))
    return next(kept for name in names if not os.path.lexists(kept := place.with_name(name)))


def is_folder(place: Path) -> bool:
    """Whether a name is that of a folder, and no link."""
    return place.is_dir() and not place.is_symlink()
