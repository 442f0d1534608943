"""Robot files: TOML in SI units, read into a robot or refused with a list of all faults."""

import hashlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from lumped.acceptance.measured import Measured, pose_faults
from lumped.acceptance.requirement import DEFAULT_LIMITS, AgreementLimits, Requirement
from lumped.errors import InputError, write_error
from lumped.files import read_ordinary, require_ordinary
from lumped.mechanism.body import Part
from lumped.mechanism.mechanism import Mechanism
from lumped.memo import memo
from lumped.robot_file.biglide import biglide_entry, biglide_of
from lumped.robot_file.evidence import (
    OF_NO_ROBOT,
    corrections_of,
    evidence_faults,
    measured_of,
    read_measured,
    requirement_of,
    times,
)
from lumped.robot_file.hammer import Hammer, hammer_of
from lumped.robot_file.included import part_content
from lumped.robot_file.loads import excitations_of, load_faults, loads_of, response_faults
from lumped.robot_file.mechanism.build import mechanism_of
from lumped.robot_file.mechanism.draft import draft
from lumped.robot_file.mechanism.faults import description_faults, motion_faults
from lumped.robot_file.mechanism.pattern import has_patterns, pattern_faults, written_out
from lumped.robot_file.places import keys_named, value_at, with_value
from lumped.robot_file.reading import (
    Printed,
    decimal_tables,
    decoded,
    parsed,
    printed_compliances,
    tables_of,
)
from lumped.robot_file.rules.published import key_comments
from lumped.robot_file.rules.tables.requests import HammerEntry
from lumped.robot_file.rules.tables.robots import (
    Correction,
    MechanismEntry,
    RobotEntry,
    is_mechanism,
    rules_of,
)
from lumped.robot_file.written import toml_of
from lumped.robots import FIRST_TYPE, RobotType
from lumped.text import did_you_mean, visible

_SUFFIX = ".toml"
# Keys whose values designers usually take from tables, data sheets and experience.
_RARELY_KNOWN = ("E", "length", "stiffness", "compliance")
# Largest size (bytes) of a robot file: ten thousand poses, or the matrices of a thousand legs,
# which take about a second to parse.
_LARGEST = 1_000_000
# Source of a robot without a file, for messages.
DICTIONARY = "dictionary"


@dataclass(frozen=True)
class RobotFile:
    """A robot with the content of its robot file.

    `source` is the path as typed, or the name of the robot if `built_in` is True. `text` is the
    text of the file and `sha256` the hexadecimal digest of the file and of the files to which it
    refers. `schema` is the format of the file: 2 for a mechanism of named bodies and joints, 1 for
    the biglide. `corrections` are corrected misprints in the source of the data. `requirement`
    limits the errors of the robot's models, `measured` are measured values, `agreement` limits the
    differences between formulations.

    `stated` are the relative standard uncertainties of inputs in the file: pairs (key,
    uncertainty). If the file contains none, `supposed` is the relative standard uncertainty of all
    values with the keys E, length, stiffness and compliance. If `supposed` is None, too, all inputs
    are exact. `changes` are numbers or matrices that replace those of the text, by key.
    `modal_test` is the table [hammer]. None if the file has no such table.
    """

    mechanism: Mechanism
    source: str
    built_in: bool
    text: str
    sha256: str
    schema: int
    corrections: tuple[Correction, ...]
    requirement: Requirement = field(default_factory=Requirement)
    measured: tuple[Measured, ...] = ()
    agreement: AgreementLimits = DEFAULT_LIMITS
    stated: tuple[tuple[str, float], ...] = ()
    supposed: float | None = None
    changes: Mapping[str, Any] = field(default_factory=dict, hash=False)
    modal_test: HammerEntry | None = field(default=None, hash=False)

    @property
    def name(self) -> str:
        """Name of the robot."""
        return self.mechanism.name

    @property
    def hammer(self) -> Hammer | None:
        """Geometry of a modal test. None if the file has no table [hammer]."""
        return None if self.modal_test is None else hammer_of(self.modal_test, self.mechanism)

    @property
    def uncertain_inputs(self) -> dict[str, float]:
        """Relative standard uncertainties of numbers and matrices in the file, by key."""
        if self.stated or self.supposed is None:
            return dict(self.stated)
        robot_tables = {
            name: table for name, table in self.tables.items() if name not in OF_NO_ROBOT
        }
        return dict.fromkeys(keys_named(robot_tables, _RARELY_KNOWN), self.supposed)

    def with_factors(self, relative_changes: Mapping[str, float]) -> Mechanism:
        """Robot in which numbers or matrices of the file are multiplied by 1 + relative change.

        `relative_changes` contains the relative changes by the keys of the numbers or matrices.
        Raises InputError if such a robot is impossible.
        """
        try:
            tables = _changed(self.tables, self.changes)
            values = {
                key: times(value_at(tables, key), 1.0 + relative_changes[key])
                for key in relative_changes
            }
            return self.with_values(values).mechanism
        except InputError as error:
            changes_text = ", ".join(
                f"{key} by {change:+.3g}" for key, change in relative_changes.items()
            )
            location = f"{self.source}: input_uncertainty, {changes_text}"
            raise InputError(f"{location}: {fault}" for fault in error.faults) from error

    def with_values(self, values: Mapping[str, Any]) -> "RobotFile":
        """Robot file in which `values` replace the numbers or matrices at their keys.

        Raises InputError if such a robot is impossible, LookupError if a key does not exist.
        """
        # Measured values and misprints do not change with the robot.
        invariant_tables = ("measured", "hammer", "corrections")
        tables = {
            name: table for name, table in self.tables.items() if name not in invariant_tables
        }
        changes = {**self.changes, **values}
        mechanism = described_by(_changed(tables, changes), self.folder)[0]
        return replace(self, mechanism=mechanism, changes=changes)

    @property
    def printed_compliances(self) -> tuple[Printed, ...]:
        """6×6 compliances in the file, each with half a unit of the last digit of its entries."""
        return tuple(printed_compliances(_changed(decimal_tables(self.text), self.changes)))

    @property
    def folder(self) -> Path:
        """Folder of the robot file, from which relative paths in the file start."""
        return Path() if self.built_in else Path(self.source).parent

    @property
    def tables(self) -> Mapping[str, Any]:
        """Tables of the file as typed, including data used only by the audit.

        They must not be changed. The text is parsed once per process.
        """
        return tables_of(self.text)


def _changed(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Copy of the tables in which `changes` replace the values at their keys.

    Raises LookupError if a key does not exist.
    """
    for key, value in changes.items():
        tables = with_value(tables, key, value)
    return tables


def _digest(content: bytes, files: Iterable[Path]) -> str:
    """Hexadecimal SHA-256 of the `content` of a robot file and of its `files`, if readable."""
    digest = hashlib.sha256(content)
    for file in files:
        with suppress(OSError, InputError):
            require_ordinary(file, "a part")
            digest.update(hashlib.sha256(part_content(file)).digest())
    return digest.hexdigest()


def built_in_robots() -> tuple[str, ...]:
    """Names of the built-in robots."""
    names = (entry.name for entry in _robots_folder().iterdir())
    return tuple(sorted(name.removesuffix(_SUFFIX) for name in names if name.endswith(_SUFFIX)))


def load_robot(name_or_path: str | Path) -> RobotFile:
    """Read the robot file of a built-in robot (by its name) or at a path.

    Raises InputError with one line for each fault in the file. A line contains file, key, value,
    unit and allowed values.
    """
    source = str(name_or_path)
    is_built_in = source in built_in_robots()
    return _of_built_in(source) if is_built_in else _described(source, _read(source))


def robot_of(tables: Mapping[str, Any]) -> RobotFile:
    """Robot file from a dictionary with the keys of a robot file.

    Paths of files are relative to the working folder. Raises InputError like `load_robot`.
    """
    try:
        text = toml_of(tables)
    except InputError as error:
        raise InputError(visible(f"{DICTIONARY}: {fault}") for fault in error.faults) from None
    return _described(DICTIONARY, text.encode())


@memo(16)
def _of_built_in(name: str) -> RobotFile:
    return _described(name, _built_in(name), built_in=True)


def _described(source: str, content: bytes, *, built_in: bool = False) -> RobotFile:
    text = decoded(content, source)
    tables = parsed(text, source)
    folder = Path() if built_in else Path(source).parent
    try:
        mechanism, entry = described_by(tables, folder)
    except InputError as error:
        raise InputError(visible(f"{source}: {fault}") for fault in error.faults) from None
    parts = [body.shape.file for body in mechanism.bodies.values() if isinstance(body.shape, Part)]
    wrenches = [folder / load.file for load in entry.loads if load.file]
    return RobotFile(
        mechanism=mechanism,
        source=source,
        built_in=built_in,
        text=text,
        sha256=_digest(content, [*parts, *wrenches]),
        schema=entry.schema,
        corrections=corrections_of(entry),
        requirement=requirement_of(entry.accept, mechanism),
        measured=tuple(
            measured_of(measured, "measured", mechanism.judged_responses)
            for measured in entry.measured
        ),
        agreement=entry.agree or DEFAULT_LIMITS,
        stated=tuple((uncertain.key, uncertain.relative) for uncertain in entry.input_uncertainty),
        modal_test=entry.hammer,
    )


def as_printed(robot_file: RobotFile) -> Mapping[str, Any]:
    """Tables of the file without its corrections: the data as printed in their source."""
    tables = robot_file.tables
    for correction in robot_file.corrections:
        tables = with_value(tables, correction.key, correction.printed)
    return tables


def write_template(path: str | Path, kind: RobotType = FIRST_TYPE) -> None:
    """Write a commented robot file to start from: the built-in robot of type `kind`.

    A list of all keys follows at the end of the file. Raises InputError if `path` exists already or
    cannot be written, ComputationError if the disk is full. An incomplete file is removed.
    """
    target = Path(path)
    text = decoded(_built_in(kind), kind)
    content = f"{text}\n{key_comments(tables_of(text))}".encode()
    try:
        file = target.open("xb")
    except FileExistsError as error:
        raise InputError(f"{path}: exists already; must be the name of a new file") from error
    except OSError as error:
        advice = "; must be in a folder that exists and may be written to"
        raise write_error(path, error, advice) from error
    try:
        with file:
            file.write(content)
    except OSError as error:
        target.unlink(missing_ok=True)
        raise write_error(path, error) from error


def described_by(tables: Mapping[str, Any], folder: Path) -> tuple[Mechanism, RobotEntry]:
    """Mechanism described by tables of schema 1 or 2, and the record into which they are read.

    Paths of files are relative to `folder`. Raises InputError with one line per fault.
    """
    entry, mechanism = _built(tables, folder)
    damping = entry.damping.ratio if entry.damping else 0.0
    complete = replace(mechanism, damping=damping)
    faults = [
        *load_faults(entry.loads, complete, folder),
        *response_faults(entry.responses, complete),
    ]
    if not faults:
        loads = loads_of(entry.loads, complete, folder)
        complete = replace(
            complete, loads=loads, excitations=excitations_of(entry.responses, complete)
        )
    # The complete robot is checked, because its postures are memoised for later computations.
    any_robot = isinstance(entry, MechanismEntry)
    if faults := (motion_faults(complete) if any_robot else []) or faults:
        raise InputError(faults)
    if faults := evidence_faults(tables, entry, complete):
        raise InputError(faults)
    return complete, entry


def _built(tables: Mapping[str, Any], folder: Path) -> tuple[RobotEntry, Mechanism]:
    """Record of a robot file, and its mechanism without damping, loads and harmonic forces.

    Paths of files are relative to `folder`. Raises InputError with one line per fault.
    """
    if not is_mechanism(tables):
        faults, biglide = biglide_entry(tables)
        if biglide is None:
            raise InputError(faults)
        return biglide, biglide_of(biglide)
    if has_patterns(tables):
        # Copies can only be made of entries without faults.
        if faults := rules_of(tables).faults_within(tables) or pattern_faults(tables):
            raise InputError(faults)
        tables = written_out(tables)
    described = draft(tables)
    faults = description_faults(described)
    if faults or described.entry is None:
        raise InputError(faults)
    return described.entry, mechanism_of(described, described.entry, folder)


def _built_in(name: str) -> bytes:
    return (_robots_folder() / f"{name}{_SUFFIX}").read_bytes()


def _robots_folder() -> Traversable:
    return resources.files("lumped") / "robots"


def _read(source: str) -> bytes:
    try:
        return read_ordinary(source, "a robot file", _LARGEST)
    except FileNotFoundError as error:
        robots = built_in_robots()
        raise InputError(
            f"{source}: no such file; must be a robot file or a built-in robot "
            f"({', '.join(robots)}){did_you_mean(source, robots)}"
        ) from error


def with_measured(robot_file: RobotFile, path: Path) -> RobotFile:
    """Robot file with additional measured values from a CSV file.

    Raises InputError with one line per fault, also for poses that the robot cannot reach.
    """
    robot = robot_file.mechanism
    values = read_measured(path, robot.judged_responses, robot.lengths, robot.tool.moves)
    faults = [
        fault
        for number, value in enumerate(values, start=2)
        for fault in pose_faults(robot, value, f"{path}: line {number}")
    ]
    if faults:
        raise InputError(faults)
    return replace(robot_file, measured=(*robot_file.measured, *values))
