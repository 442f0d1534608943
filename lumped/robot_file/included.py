"""Abaqus and CalculiX decks over several files: *INCLUDE stands for the lines of another file.

File names count from the folder of the deck itself, in included files, too, as in both programs.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from lumped.errors import InputError
from lumped.files import read_ordinary
from lumped.text import shown

DECK = ".inp"
# Deepest chain of included files: Abaqus allows five.
_DEEPEST = 10
# Of a deck with all that it includes, each file as often as it is included (bytes).
LARGEST_DECK = 500_000_000


class DeckLine(NamedTuple):
    """A line of a deck or of a file that it includes, numbered from 1 within its file."""

    file: Path
    number: int
    text: str

    def fault(self, reason: str) -> InputError:
        """The error of this line."""
        return InputError(f"{self.file}: line {self.number}: {reason}")


def part_content(path: Path) -> bytes:
    """The content of a part's file, that of a deck with all that it includes.

    Raises OSError if it cannot be read, InputError if an included file cannot.
    """
    content = path.read_bytes()
    if path.suffix.lower() != DECK or b"INCLUDE" not in content.upper():
        return content
    return "\n".join(line.text for line in deck_lines(path)).encode()


def deck_lines(path: Path) -> Iterator[DeckLine]:
    """Lines of a deck, those of included files in place of each *INCLUDE.

    Raises InputError with file and line of an *INCLUDE without a file in the folder of the deck or
    below it, of one that includes itself, and of too many or too large ones.
    """
    return _Includer(path.parent.resolve()).lines(path, path.read_bytes(), (path.resolve(),))


class _Includer:
    """Expands the files of one deck, all within its `folder`, and counts their bytes."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.size = folder, 0

    def lines(self, file: Path, content: bytes, chain: tuple[Path, ...]) -> Iterator[DeckLine]:
        """Lines of a file; `chain`: it and all above that include it, the deck first."""
        text = content.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")
        numbered = iter(enumerate(text.split("\n"), start=1))
        for number, own in numbered:
            line = DeckLine(file, number, own)
            fields = _include_fields(own)
            if fields is None:
                yield line
                continue
            if not fields[-1]:
                fields += _fields(next(numbered, (0, ""))[1])
            yield from self._included(line, fields, chain)

    def _included(
        self, line: DeckLine, fields: list[str], chain: tuple[Path, ...]
    ) -> Iterator[DeckLine]:
        named = [
            value.strip()
            for name, _, value in (one.partition("=") for one in fields)
            if name.strip().upper() == "INPUT"
        ]
        name = named[0].strip('"') if named else ""
        if not name:
            raise line.fault("*INCLUDE must name its file: INPUT=…")
        what = f"*INCLUDE {shown(name)}"
        place = self.folder / name.replace("\\", "/")
        try:
            file = place.resolve()
        except (OSError, RuntimeError, ValueError):
            raise line.fault(f"{what}: cannot be read") from None
        if not file.is_relative_to(self.folder):
            raise line.fault(f"{what}: lies outside the folder of the deck; move it there")
        if file in chain:
            circle = " includes ".join(one.name for one in (*chain[chain.index(file) :], file))
            raise line.fault(f"{what}: includes itself ({circle})")
        if len(chain) > _DEEPEST:
            raise line.fault(f"{what}: is more than {_DEEPEST} files deep; write them into one")
        try:
            content = read_ordinary(file, "a part of the deck", LARGEST_DECK)
        except FileNotFoundError:
            raise line.fault(
                f"{what}: no such file; its name must count from the folder of the deck"
            ) from None
        except InputError as error:
            raise line.fault(f"{what}: {error}") from None
        self.size += len(content)
        if self.size > LARGEST_DECK:
            raise line.fault(
                f"{what}: all included files together are larger than {LARGEST_DECK / 1e6:g} MB"
            )
        yield from self.lines(place, content, (*chain, file))


def _include_fields(text: str) -> list[str] | None:
    """Options of an *INCLUDE, the last one empty if it goes on; None for any other line."""
    own = text.strip()
    if not own.startswith("*") or own.startswith("**"):
        return None
    keyword, *options = _fields(own)
    return (options or ["INPUT="]) if _plain(keyword) == "*INCLUDE" else None


def _fields(text: str) -> list[str]:
    return [one.strip() for one in text.split(",")]


def _plain(word: str) -> str:
    return "".join(word.split()).upper()
