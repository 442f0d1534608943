"""Abaqus and CalculiX decks of several files: *INCLUDE inserts the lines of another file.

File names, also those in included files, are relative to the folder of the deck, as in both
programs.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from lumped.errors import InputError
from lumped.files import read_ordinary
from lumped.text import shown

DECK = ".inp"
# Largest depth of nested *INCLUDE. Abaqus allows five.
_DEEPEST = 10
# Largest size (bytes) of a deck with its included files, each counted as often as it is included.
LARGEST_DECK = 500_000_000


class DeckLine(NamedTuple):
    """A line of a deck or of a file that it includes, numbered from 1 within its file."""

    file: Path
    number: int
    text: str

    def fault(self, reason: str) -> InputError:
        """Error to raise for this line, with the `reason`."""
        return InputError(f"{self.file}: line {self.number}: {reason}")


def part_content(path: Path) -> bytes:
    """Content of the file of a part. For a deck this includes the content of all included files.

    Raises OSError if the file cannot be read, InputError if an included file cannot be read.
    """
    content = path.read_bytes()
    if path.suffix.lower() != DECK or b"INCLUDE" not in content.upper():
        return content
    return "\n".join(line.text for line in deck_lines(path)).encode()


def deck_lines(path: Path) -> Iterator[DeckLine]:
    """Lines of a deck, in which each *INCLUDE is replaced by the lines of the included file.

    Raises InputError, with file and line, if the included file does not exist, is outside the
    folder of the deck, includes itself, or is too large, or if includes are nested too deeply.
    """
    return _Includer(path.parent.resolve()).lines(path, path.read_bytes(), (path.resolve(),))


class _Includer:
    """Expands the included files of one deck, all within its `folder`, and adds up their bytes."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.size = folder, 0

    def lines(self, file: Path, content: bytes, chain: tuple[Path, ...]) -> Iterator[DeckLine]:
        """Lines of `file`, whose bytes are `content`. Included lines replace each *INCLUDE.

        `chain` contains the files from the deck to `file`, each of which includes the next.
        """
        text = content.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")
        numbered = iter(enumerate(text.split("\n"), start=1))
        for number, text_line in numbered:
            line = DeckLine(file, number, text_line)
            fields = _include_fields(text_line)
            if fields is None:
                yield line
                continue
            if not fields[-1]:
                fields += _fields(next(numbered, (0, ""))[1])
            yield from self._included(line, fields, chain)

    def _included(
        self, line: DeckLine, fields: list[str], chain: tuple[Path, ...]
    ) -> Iterator[DeckLine]:
        file_names = [
            value.strip()
            for name, _, value in (field.partition("=") for field in fields)
            if name.strip().upper() == "INPUT"
        ]
        name = file_names[0].strip('"') if file_names else ""
        if not name:
            raise line.fault("*INCLUDE must name its file: INPUT=…")
        include = f"*INCLUDE {shown(name)}"
        path = self.folder / name.replace("\\", "/")
        try:
            file = path.resolve()
        except (OSError, RuntimeError, ValueError):
            raise line.fault(f"{include}: cannot be read") from None
        if not file.is_relative_to(self.folder):
            raise line.fault(
                f"{include}: lies outside the folder of the deck; move it into this folder"
            )
        if file in chain:
            cycle = " includes ".join(
                included.name for included in (*chain[chain.index(file) :], file)
            )
            raise line.fault(f"{include}: includes itself ({cycle})")
        if len(chain) > _DEEPEST:
            raise line.fault(f"{include}: is more than {_DEEPEST} files deep; join the files")
        try:
            content = read_ordinary(file, "a part of the deck", LARGEST_DECK)
        except FileNotFoundError:
            raise line.fault(
                f"{include}: no such file; its name must count from the folder of the deck"
            ) from None
        except InputError as error:
            raise line.fault(f"{include}: {error}") from None
        self.size += len(content)
        if self.size > LARGEST_DECK:
            raise line.fault(
                f"{include}: all included files together are larger than {LARGEST_DECK / 1e6:g} MB"
            )
        yield from self.lines(path, content, (*chain, file))


def _include_fields(text: str) -> list[str] | None:
    """Options of an *INCLUDE line, which are separated by commas.

    The last one is "" if the options continue on the next line. None if `text` is another line.
    """
    stripped = text.strip()
    if not stripped.startswith("*") or stripped.startswith("**"):
        return None
    keyword, *options = _fields(stripped)
    return (options or ["INPUT="]) if _plain(keyword) == "*INCLUDE" else None


def _fields(text: str) -> list[str]:
    return [field.strip() for field in text.split(",")]


def _plain(word: str) -> str:
    return "".join(word.split()).upper()
