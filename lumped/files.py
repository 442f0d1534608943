"""Files: ordinary ones, of a size that was meant, are read; what is written is written whole."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from secrets import token_hex

from lumped.errors import InputError

LARGEST = 10_000_000
# Flags that follow no link and wait for no other end of a pipe, as far as the system has them.
NO_FOLLOW = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
_READ = os.O_RDONLY | NO_FOLLOW | getattr(os, "O_NONBLOCK", 0)
_OTHERS = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}


class StoreError(Exception):
    """Nothing more can be written (disk full, device gone); what was written before is kept."""


def require_ordinary(path: Path | str, kind: str) -> int:
    """Size (bytes) of an ordinary file.

    Raises InputError where `path` is none (opened, a pipe would wait for someone to write) or a
    link to nothing, and OSError or ValueError where it cannot be looked at.
    """
    try:
        found = Path(path).stat()
    except FileNotFoundError:
        if Path(path).is_symlink():
            target = Path(path).readlink()
            raise InputError(
                f"{path}: is a link to {target}, which does not exist; must be {kind}"
            ) from None
        raise
    if not stat.S_ISREG(found.st_mode):
        other = _OTHERS.get(stat.S_IFMT(found.st_mode), "device")
        raise InputError(f"{path}: is a {other}; must be {kind}")
    return found.st_size


def read_ordinary(path: Path | str, kind: str, largest: int = LARGEST) -> bytes:
    """The content of an ordinary file of at most `largest` bytes; `kind` is what it must be.

    Raises InputError, and FileNotFoundError where there is none.
    """
    try:
        size = require_ordinary(path, kind)
        with Path(path).open("rb") as file:
            # Files made by the system while they are read have no size before.
            content = file.read(largest + 1) if size <= largest else None
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{path}: cannot be read ({reason}); must be {kind}") from error
    if content is None or len(content) > largest:
        raise InputError(f"{path}: is larger than {largest // 1_000_000} MB; must be {kind}")
    return content


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
