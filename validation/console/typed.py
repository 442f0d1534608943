"""Types of command-line arguments, and checked paths of result files.

Input: texts from the command line. Output: whole numbers, options and paths. Rule: a path is
checked before the computation and written after it. An existing file is replaced if it is an
unchanged earlier result (`validation.console.marks`). Any other file is replaced only with
`--force`, and only if it has the suffix of the result, so that a table never replaces a robot file
or a CAD file.
"""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from errno import ENAMETOOLONG
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from cyclopts import Parameter, Token

from fem.solvers.backends.request import request_solver
from lumped.errors import InputError, write_error
from lumped.files import write_whole
from lumped.model_choices import EquivalentBy, LegSprings, PartLegs, Theory
from validation.console.marks import is_marked, with_mark
from validation.console.streams import write_messages

# Largest number of processes of a run, more than any machine has cores.
MOST_PROCESSES = 1024


def _whole_number(_type: object, tokens: Sequence[Token]) -> int:
    # The parser's own conversion by int() would truncate 1.5 to 1.
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


def _path(_type: object, tokens: Sequence[Token]) -> Path:
    path = Path(text := tokens[0].value)
    try:
        path.stat()
    except OSError as error:
        # Existence and permissions are checked by the commands that use the path.
        if error.errno == ENAMETOOLONG:
            raise ValueError(f'"{text[:40]}…": {error.strerror}.') from None
    return path


LengthUnit: TypeAlias = Literal["m", "mm", "cm", "inch"]
PathArgument: TypeAlias = Annotated[Path, Parameter(converter=_path)]
WholeNumber: TypeAlias = Annotated[int, Parameter(converter=_whole_number)]
ProcessCount: TypeAlias = Annotated[int | None, Parameter(converter=_process_count)]
RobotName: TypeAlias = Annotated[str, Parameter(help="Name of a built-in robot, or a robot file.")]
AsJson: TypeAlias = Annotated[bool, Parameter(help="Print JSON instead of text.")]
Force: TypeAlias = Annotated[
    bool,
    Parameter(
        help="Replace an existing file of the same kind, even if it was not written by flexproof."
    ),
]


@Parameter(name="*")
@dataclass(frozen=True)
class SolverChoice:
    """Options of a command for the library that factorises large systems.

    Attributes
    ----------
    solver
        Library that factorises large systems. rslab: on the processor. cudss: on a graphics card
        (needs the extra "gpu"). petsc: MUMPS in MPI processes (needs Debian's python3-petsc4py);
        statics that exceed the memory are solved by multigrid. gamg: like petsc, with multigrid
        for the statics of all solids. auto: cudss for large systems if there is a card, otherwise
        rslab. Default: FLEXPROOF_SOLVER, otherwise auto.
    ranks
        Number of MPI processes for --solver petsc or gamg, a multiple of the number of hosts.
        Default: FLEXPROOF_RANKS, otherwise one per host.
    hosts
        Hostfile of mpiexec: names of the machines on which --solver petsc or gamg computes, one per
        line, this machine first. Default: FLEXPROOF_HOSTS, otherwise this machine alone.
    """

    solver: Literal["auto", "rslab", "cudss", "petsc", "gamg"] | None = None
    ranks: WholeNumber | None = None
    hosts: Path | None = None

    def request(self) -> None:
        """Request the library for this process and for those that it starts."""
        request_solver(self.solver, self.ranks, self.hosts)


@Parameter(name="*")
@dataclass(frozen=True)
class ModelChoices:
    """Options of a command for the model that it solves.

    Attributes
    ----------
    legs
        vjm, links: compliance of each leg. given: that of its section, or the 6×6 of the robot
        file. equivalent: that of the prism with the same diagonal (see --equivalent). Default:
        given.
    theory
        Beam theory of segments, beam, and of prisms in vjm and links. Default: timoshenko.
    elements
        segments, beam: number of segments or of beam elements per leg. Default: 20.
    divisions
        solid: quadratic elements across the smaller side of the section. Default: 4.
    equivalent
        Prism that replaces a leg given by its 6×6 compliance (segments, beam, solid, and --legs
        equivalent). stiffness: it has the first four diagonal terms of the inverse of the 6×6.
        compliance: those of the 6×6 itself. Default: stiffness.
    parts
        segments, beam: model of CAD parts. equivalent: a leg of one section. stepped: a leg of ten
        prismatic pieces with the sections of the part. condensed: stiffness and mass between its
        interfaces. Default: equivalent.
    """

    legs: LegSprings | None = None
    theory: Theory | None = None
    elements: WholeNumber | None = None
    divisions: WholeNumber | None = None
    equivalent: EquivalentBy | None = None
    parts: PartLegs | None = None

    def given(self, **further: object) -> dict[str, object]:
        """Options that the user gave, by name, together with `further` options.

        Options that are None are omitted.
        """
        choices = {**vars(self), **further}
        return {name: value for name, value in choices.items() if value is not None}


DEFAULT_SOLVER, DEFAULT_MODEL = SolverChoice(), ModelChoices()


def require_writable(path: Path | None, kind: str, *, force: bool = False) -> None:
    """Raise InputError if no file can be written to `path`, before its content is computed.

    Missing folders are allowed, because `write` creates them. Earlier results are replaced under
    any name. With `force`, other files are replaced if they have the suffix `kind`, such as ".csv".
    Nothing is checked if `path` is None.
    """
    if path is None:
        return
    if path.is_dir():
        raise InputError(f"{path}: cannot be written (is a folder); must be a file")
    foreign = path.is_file() and not is_marked(path, kind)
    if foreign and path.resolve().suffix.lower() != kind:
        raise InputError(
            f"{path}: exists already and is not a {kind} file; give the name of a new "
            f"file or of a {kind} file"
        )
    if foreign and not force:
        raise InputError(
            f"{path}: exists already and was not written by flexproof, or was changed "
            "since; give another name, or replace it with --force"
        )
    nearest = next(parent for parent in (path, *path.absolute().parents) if parent.exists())
    if nearest != path and not nearest.is_dir():
        raise InputError(f"{path}: cannot be written ({nearest} is not a folder)")
    if not os.access(nearest, os.W_OK):
        raise InputError(f"{path}: cannot be written (no write permission for {nearest})")


def require_distinct(*paths: Path | None) -> None:
    """Raise InputError if two results are to be written to the same file."""
    files = [path.absolute() for path in paths if path is not None]
    if len(set(files)) < len(files):
        raise InputError(f"{paths[0]}: given for two results; give a separate file for each")


def write(path: Path, content: bytes, kind: str) -> None:
    """Write a file with a mark, and a message to stderr. `kind` is the suffix of the file.

    An existing file is replaced after the new one is complete. A link is replaced, not its target.
    Raises InputError with the system's reason, and ComputationError if the disk is full.
    """
    content = with_mark(content, kind)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():
            # A device or a pipe cannot be replaced.
            path.write_bytes(content)
        else:
            write_whole(path, content)
    except OSError as error:
        raise write_error(path, error) from error
    write_messages([f"{path} written"], 0)
