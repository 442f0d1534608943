"""Files that are written whole or not at all, and read without waiting or following links."""

import glob
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


def write_whole(path: Path, content: bytes) -> None:
    """Replace a file in a folder that exists, or make it: flushed to the disk, then renamed.

    A link is replaced, not what it leads to. Raises OSError; what was there then remains.
    """
    # A name as long as the file system allows leaves no room for more beside it.
    beside = path.with_name(f".{path.name[:200]}.{token_hex(8)}.tmp")
    try:
        with beside.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except (OSError, KeyboardInterrupt):
        with suppress(OSError):
            beside.unlink()
        raise


def halves(path: Path) -> list[Path]:
    """Files that a kill left beside in place of a new `path`."""
    # A name as long as the file system allows leaves no room for more beside it.
    return list(path.parent.glob(f".{glob.escape(path.name[:200])}.{16 * '[0-9a-f]'}.tmp"))


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
    return next(kept for name in names if not lies(kept := place.with_name(name)))


def lies(place: Path) -> bool:
    """Whether there is anything under a name, a broken link say."""
    return os.path.lexists(place)


def is_file(place: Path) -> bool:
    """Whether a name is that of a regular file, and no link."""
    return place.is_file() and not place.is_symlink()


def is_folder(place: Path) -> bool:
    """Whether a name is that of a folder, and no link."""
    return place.is_dir() and not place.is_symlink()
