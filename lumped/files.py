"""Files that were named to be read: ordinary ones, of a size that was meant."""

import stat
from pathlib import Path

from lumped.errors import InputError

LARGEST = 10_000_000
_OTHERS = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}


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
