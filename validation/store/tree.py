"""A folder by its descriptor: names below it are relative, and no link below it is ever followed.

Files are replaced atomically: written beside under a name that nobody had, flushed to the disk,
renamed. Whatever stood there keeps its content for those who still hold it.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path, PurePosixPath
from secrets import token_hex
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["file", "folder", "other"]
_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC
_BELOW = _FOLDER | os.O_NOFOLLOW
# A pipe or a device is opened without waiting for its other end, and then not read.
_READ = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_CREATE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
_APPEND = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


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


@dataclass(frozen=True)
class Tree:
    """An open folder; `path` serves messages, names are "file" or "folder/file".

    What fails raises OSError, ELOOP or ENOTDIR where a link stands in the place of a folder.
    """

    path: Path
    descriptor: int

    @staticmethod
    @contextmanager
    def opened(path: Path) -> Iterator["Tree"]:
        """The folder at `path`, which the user may have given as a link."""
        descriptor = os.open(path, _FOLDER)
        try:
            yield Tree(path, descriptor)
        finally:
            os.close(descriptor)

    @contextmanager
    def below(self, name: str) -> Iterator["Tree"]:
        """A folder in this one; "" is this one."""
        descriptor = os.open(name or ".", _BELOW, dir_fd=self.descriptor)
        try:
            yield Tree(self.path / name, descriptor)
        finally:
            os.close(descriptor)

    def kind(self, name: str) -> Kind | None:
        """What stands under a name: links, pipes and devices are "other"; None for nothing."""
        try:
            with self._holding(name) as (folder, last):
                mode = os.stat(last, dir_fd=folder, follow_symlinks=False).st_mode
        except OSError:
            return None
        if stat.S_ISREG(mode):
            return "file"
        return "folder" if stat.S_ISDIR(mode) else "other"

    def read(self, name: str) -> bytes | None:
        """Content of a regular file; None where there is none that can be read."""
        try:
            with self._holding(name) as (folder, last):
                descriptor = os.open(last, _READ, dir_fd=folder)
            with os.fdopen(descriptor, "rb") as file:
                if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                    return file.read()
        except OSError:
            pass
        return None

    def write(self, name: str, data: bytes, temporary: str | None = None) -> None:
        """Replace a file; its folder is made. `temporary` is the name that it has meanwhile."""
        beside = temporary_name(name) if temporary is None else temporary
        with self._holding(name, "make") as (folder, last):
            unnamed = PurePosixPath(beside).name
            descriptor = os.open(unnamed, _CREATE, 0o666, dir_fd=folder)
            try:
                with os.fdopen(descriptor, "wb") as file:
                    file.write(data)
                    file.flush()
                    os.fsync(file.fileno())
                os.replace(unnamed, last, src_dir_fd=folder, dst_dir_fd=folder)
                os.fsync(folder)
            except (OSError, KeyboardInterrupt):
                with suppress(OSError):
                    os.unlink(unnamed, dir_fd=folder)
                raise

    def append(self, name: str, data: bytes) -> None:
        """Add to a file that is this program's own alone, or make it."""
        with self._holding(name, "make") as (folder, last):
            descriptor = os.open(last, _APPEND, 0o666, dir_fd=folder)
        try:
            os.write(descriptor, data)
        finally:
            os.close(descriptor)

    def make(self, name: str) -> None:
        """Make a folder if there is none."""
        with self._holding(f"{name}/any", "make"):
            pass

    def move(self, name: str, to: str, target: "Tree | None" = None) -> None:
        """Give a file or folder another name, here or in `target`; what had it is replaced."""
        other = self if target is None else target
        with self._holding(name) as (source, last), other._holding(to, "make") as (goal, new):
            os.replace(last, new, src_dir_fd=source, dst_dir_fd=goal)

    def aside(self, name: str) -> str:
        """Move out of the way what is not ours; returns the name under which it is kept."""
        names = (f"{name}.kept{'' if number == 1 else number}" for number in count(1))
        kept = next(free for free in names if self.lacks(free))
        self.move(name, kept)
        return kept

    def lacks(self, name: str) -> bool:
        """Whether nothing at all stands under the name."""
        return self.kind(name) is None

    def remove(self, name: str) -> None:
        """Remove a file, or a folder if it is empty."""
        with self._holding(name) as (folder, last):
            if self.kind(name) == "folder":
                with suppress(OSError):
                    os.rmdir(last, dir_fd=folder)
            else:
                os.unlink(last, dir_fd=folder)

    def names(self, folder: str = "") -> list[str]:
        """Sorted names in a folder of it; none where there is no such folder."""
        try:
            with self.below(folder) as inner:
                return sorted(os.listdir(inner.descriptor))  # noqa: PTH208  by descriptor
        except OSError:
            return []

    def files(self, folder: str = "") -> list[str]:
        """All names below a folder but those of folders, the inner ones after the folder's own."""
        own: list[str] = []
        inner: list[str] = []
        for name in self.names(folder):
            full = f"{folder}/{name}" if folder else name
            (inner if self.kind(full) == "folder" else own).append(full)
        return own + [name for sub in inner for name in self.files(sub)]

    def prune(self, folder: str) -> None:
        """Remove a folder and those in it as far as they are empty."""
        for name in self.names(folder):
            if self.kind(f"{folder}/{name}") == "folder":
                self.prune(f"{folder}/{name}")
        with suppress(OSError):
            self.remove(folder)

    @contextmanager
    def _holding(self, name: str, making: Literal["make", ""] = "") -> Iterator[tuple[int, str]]:
        """Descriptor of the folder that holds `name`, and the last part of the name."""
        *folders, last = name.split("/")
        held = os.open(".", _BELOW, dir_fd=self.descriptor)
        try:
            for part in folders:
                if making:
                    with suppress(FileExistsError):
                        os.mkdir(part, dir_fd=held)
                inner = os.open(part, _BELOW, dir_fd=held)
                os.close(held)
                held = inner
            yield held, last
        finally:
            os.close(held)


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file in a folder that exists. Raises StoreError; the old file then remains."""
    with refusals(path), Tree.opened(path.parent) as folder:
        folder.write(path.name, content)


def read_regular(path: Path) -> bytes | None:
    """Content of a regular file; None where there is none that can be read."""
    try:
        with Tree.opened(path.parent) as folder:
            return folder.read(path.name)
    except OSError:
        return None


def temporary_name(name: str) -> str:
    """A name beside `name` that nobody had."""
    path = PurePosixPath(name)
    return str(path.with_name(f".{path.name}.{token_hex(8)}.tmp"))
