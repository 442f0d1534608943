"""What people type: whole numbers, and files for results, refused at once and written afterwards.

A file that is there is replaced if it is an earlier result (`validation.console.marks`), or by
`--force`, and only by one of its kind, as its name ends: never a robot file or a drawing by the
table made of it.
"""

import os
import re
from collections.abc import Sequence
from errno import ENAMETOOLONG
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from cyclopts import Parameter, Token

from lumped.errors import InputError, write_error
from lumped.files import write_whole
from validation.console.marks import is_marked, marked
from validation.console.streams import complain

# Of a run: more than any machine has cores.
MOST_PROCESSES = 1024


def _whole_number(_type: object, tokens: Sequence[Token]) -> int:
    # int() of the parser's own cuts 1.5 down to 1.
    text = tokens[0].value
    if not re.fullmatch(r"[+-]?\d{1,15}", text, re.ASCII):
        option = tokens[0].keyword
        raise ValueError(f'Invalid value "{text[:40]}" for {option}. Must be a whole number.')
    return int(text)


def _process_count(_type: object, tokens: Sequence[Token]) -> int:
    count = _whole_number(_type, tokens)
    if not 1 <= count <= MOST_PROCESSES:
        allowed = f"Must be a whole number, 1 to {MOST_PROCESSES}."
        raise ValueError(f'Invalid value "{count}" for --jobs. {allowed}')
    return count


def _place(_type: object, tokens: Sequence[Token]) -> Path:
    path = Path(text := tokens[0].value)
    try:
        path.stat()
    except OSError as error:
        # Whether it is there, and may be used, is for those to say who use it.
        if error.errno == ENAMETOOLONG:
            raise ValueError(f'"{text[:40]}…": {error.strerror}.') from None
    return path


LengthUnit: TypeAlias = Literal["m", "mm", "cm", "inch"]
Place: TypeAlias = Annotated[Path, Parameter(converter=_place)]
WholeNumber: TypeAlias = Annotated[int, Parameter(converter=_whole_number)]
ProcessCount: TypeAlias = Annotated[int | None, Parameter(converter=_process_count)]
SolverName: TypeAlias = Annotated[
    Literal["auto", "rslab", "cudss"] | None,
    Parameter(
        help="Library that factorises large systems: rslab; cudss, on a graphics card (needs the "
        "extra gpu); or auto, which takes the card for large ones. FLEXPROOF_SOLVER, or auto, if "
        "left out."
    ),
]
RobotName: TypeAlias = Annotated[str, Parameter(help="A built-in robot or a robot file.")]
AsJson: TypeAlias = Annotated[bool, Parameter(help="Print JSON for programs.")]
Force: TypeAlias = Annotated[
    bool, Parameter(help="Replace a file of the same kind, even if flexproof did not write it.")
]


def require_place(path: Path | None, kind: str, *, force: bool = False) -> None:
    """Raise InputError where no file can be written to `path`, before anything is computed for it.

    Folders that it lacks count as there: `write` makes them. Earlier results are replaced, whatever
    their names, with `force` any file with the ending `kind` (".csv", say). None asks for no file.
    """
    if path is None:
        return
    if path.is_dir():
        raise InputError(f"{path}: cannot be written (is a folder); must be a file")
    foreign = path.is_file() and not is_marked(path, kind)
    if foreign and path.resolve().suffix.lower() != kind:
        raise InputError(
            f"{path}: exists already, and only {kind} files are replaced; must be the name of a "
            "new file or end so"
        )
    if foreign and not force:
        raise InputError(
            f"{path}: exists already and was not written by flexproof, or was changed since; "
            "must be the name of a new file, or be replaced with --force"
        )
    nearest = next(place for place in (path, *path.absolute().parents) if place.exists())
    if nearest != path and not nearest.is_dir():
        raise InputError(f"{path}: cannot be written ({nearest} is no folder)")
    if not os.access(nearest, os.W_OK):
        raise InputError(f"{path}: cannot be written ({nearest} is not yours to write to)")


def require_apart(*paths: Path | None) -> None:
    """Raise InputError where two results are to go into one file."""
    named = [path.absolute() for path in paths if path is not None]
    if len(set(named)) < len(named):
        raise InputError(f"{paths[0]}: is named for two results; each must have a file of its own")


def write(path: Path, content: bytes, kind: str) -> None:
    """Write a file of a kind (its ending) whole, with a mark, and say so.

    What was there stays until all is written; a link is replaced, not what it leads to. Raises
    InputError with the system's reason, ComputationError if it is out of room.
    """
    content = marked(content, kind)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():
            # A device or a pipe.
            path.write_bytes(content)
        else:
            write_whole(path, content)
    except OSError as error:
        raise write_error(path, error) from error
    complain([f"{path} written"], 0)
