"""Read ordinary files of limited size, and write files atomically."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from secrets import token_hex

from lumped.errors import InputError

# Default limit (bytes) on the size of an input file.
LARGEST = 10_000_000
# Flags of `os.open` against following links and inheriting descriptors, if the system has them.
NO_FOLLOW = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
_READ = os.O_RDONLY | NO_FOLLOW | getattr(os, "O_NONBLOCK", 0)
_OTHER_FILE_TYPES = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}


class StoreError(Exception):
    """Error: files can no longer be written (disk full, device gone).

    Files that were written before are kept.
    """


def require_ordinary(path: Path | str, kind: str) -> int:
    """Size (bytes) of an ordinary file.

    `kind` is the expected kind of file, for messages. Raises InputError if `path` is a broken link,
    a folder, a pipe or a device. Raises OSError or ValueError if the status of the file cannot be
    read.
    """
    try:
        status = Path(path).stat()
    except FileNotFoundError:
        if Path(path).is_symlink():
            target = Path(path).readlink()
            raise InputError(
                f"{path}: is a link to {target}, which does not exist; must be {kind}"
            ) from None
        raise
    if not stat.S_ISREG(status.st_mode):
        file_type = _OTHER_FILE_TYPES.get(stat.S_IFMT(status.st_mode), "device")
        raise InputError(f"{path}: is a {file_type}; must be {kind}")
    return status.st_size


def read_ordinary(path: Path | str, kind: str, largest: int = LARGEST) -> bytes:
    """Content of an ordinary file of at most `largest` bytes.

    `kind` is the expected kind of file, for messages. Raises FileNotFoundError if there is no such
    file, and InputError for any other fault.
    """
    try:
        size = require_ordinary(path, kind)
        with Path(path).open("rb") as file:
            # Files that the system generates when they are read have the size 0 until then.
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
def os_errors_as_store_errors(path: Path) -> Iterator[None]:
    """Context that converts errors of the operating system to StoreError.

    `path` is the file that is written, for the message.
    """
    try:
        yield
    except OSError as error:
        file_name = f" ({error.filename})" if isinstance(error.filename, str) else ""
        raise StoreError(f"cannot write {path}: {error.strerror or error}{file_name}") from error


def write_whole(path: Path, content: bytes, temporary_folder: Path | None = None) -> None:
    """Create or replace a file in one step: a temporary file is flushed to the disk and renamed.

    The folder must exist. The temporary file lies in the same folder, or in `temporary_folder`. If
    `path` is a link, the link is replaced, not its target. Raises OSError, in which case the
    previous file remains.
    """
    # The name is cut because it may already have the largest length of the file system.
    temporary = (temporary_folder or path.parent) / f".{path.name[:200]}.{token_hex(8)}.tmp"
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except (OSError, KeyboardInterrupt):
        with suppress(OSError):
            temporary.unlink()
        raise


def read_regular(path: Path) -> bytes | None:
    """Content of a regular file. None if `path` is anything else or cannot be read.

    Links are not followed if the system supports this. A pipe or a device is not read, and the
    function does not wait for its other end.
    """
    try:
        with os.fdopen(os.open(path, _READ), "rb") as file:
            return file.read() if stat.S_ISREG(os.fstat(file.fileno()).st_mode) else None
    except OSError:
        return None


def digest(content: bytes) -> str:
    """Digest of `content` as 32 hexadecimal digits."""
    return blake2b(content, digest_size=16).hexdigest()
