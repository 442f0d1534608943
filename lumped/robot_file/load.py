"""Robot files: TOML with SI units, read into a robot or refused with every fault named."""

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from lumped.biglide import Biglide, geometry_faults
from lumped.errors import InputError
from lumped.legs import GivenLeg
from lumped.requirement import STATIC_QUANTITIES, Requirement
from lumped.robot_file.corrections import correction_faults, value_at, with_printed_values
from lumped.robot_file.leg_table import leg_faults, leg_of, symmetric
from lumped.robot_file.reading import decoded, parsed, read_bytes
from lumped.robot_file.table_faults import table_faults
from lumped.robot_file.tables import Accept, Correction, Length, RobotTables
from lumped.text import cut, visible

_SUFFIX = ".toml"
# What a person reads before mending the first of them.
_MOST_LINES = 50
_LONGEST_LINE = 300


@dataclass(frozen=True)
class RobotFile:
    """A robot and the file it came from.

    `source` is the path as given or, if `built_in`, the robot's name; `text` the file's text and
    `sha256` the digest (hexadecimal) of its bytes; `corrections` of misprints in its source;
    `requirement` what is asked of its models.
    """

    robot: Biglide
    source: str
    built_in: bool
    text: str
    sha256: str
    corrections: tuple[Correction, ...]
    requirement: Requirement = field(default_factory=Requirement)

    @property
    def tables(self) -> dict[str, Any]:
        """The file's tables as written, with the data that only the audit reads."""
        return tomllib.loads(self.text)


def built_in_robots() -> tuple[str, ...]:
    """Names of the robots that come with the program."""
    names = (entry.name for entry in _robots_folder().iterdir())
    return tuple(sorted(name.removesuffix(_SUFFIX) for name in names if name.endswith(_SUFFIX)))


def load_robot(name_or_path: str | Path) -> RobotFile:
    """The robot of a built-in name or of a robot file.

    Raises InputError with one line per fault, all faults at once, each with file, key, value,
    unit and what is allowed.
    """
    source = str(name_or_path)
    built_in = source in built_in_robots()
    content = (_robots_folder() / f"{source}{_SUFFIX}").read_bytes() if built_in else _read(source)
    text = decoded(content, source)
    tables = parsed(text, source)
    faults = table_faults(RobotTables, tables)
    for leg in ("leg1", "leg2"):
        faults += leg_faults(tables.get(leg), leg)
    faults += _geometry_faults(tables)
    if not faults:
        typed = msgspec.convert(tables, RobotTables)
        faults += correction_faults(tables, typed.corrections)
    if faults:
        raise InputError(_listed(source, faults))
    return RobotFile(
        robot=_robot(typed),
        source=source,
        built_in=built_in,
        text=text,
        sha256=hashlib.sha256(content).hexdigest(),
        corrections=tuple(typed.corrections),
        requirement=requirement_of(typed.accept),
    )


def requirement_of(accept: Accept | None) -> Requirement:
    """What a file's [accept] asks; the defaults without it."""
    if accept is None:
        return Requirement()
    limits = {name: getattr(accept, name) for name in STATIC_QUANTITIES}
    return Requirement(
        deflection=accept.deflection,
        frequency=accept.frequency,
        modes=accept.modes,
        rely=tuple(accept.rely),
        limits={name: limit for name, limit in limits.items() if limit is not None},
    )


def as_printed(robot_file: RobotFile) -> dict[str, Any]:
    """The file's tables with every correction undone: the data as their source prints them."""
    return with_printed_values(robot_file.tables, robot_file.corrections)


def write_template(path: str | Path) -> None:
    """Write a commented robot file to start from.

    Raises InputError where `path` exists already or cannot be written; nothing half-written stays.
    """
    target = Path(path)
    content = (resources.files("lumped") / "templates" / f"robot{_SUFFIX}").read_bytes()
    try:
        file = target.open("xb")
    except FileExistsError as error:
        raise InputError(f"{path}: exists already; must be the name of a new file") from error
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}); must be in a folder that exists and "
            "may be written to"
        ) from error
    try:
        with file:
            file.write(content)
    except OSError as error:
        target.unlink(missing_ok=True)
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error


def _listed(source: str, faults: list[str]) -> list[str]:
    """The faults with their file, each on one short line, the rest counted where there are many."""
    some = faults if len(faults) <= _MOST_LINES else faults[: _MOST_LINES - 1]
    lines = [visible(f"{source}: {cut(fault, _LONGEST_LINE)}") for fault in some]
    if len(some) < len(faults):
        lines.append(visible(f"{source}: and {len(faults) - len(some)} more faults"))
    return lines


def _robots_folder() -> Traversable:
    return resources.files("lumped") / "robots"


def _read(source: str) -> bytes:
    try:
        return read_bytes(source)
    except FileNotFoundError as error:
        robots = built_in_robots()
        close = get_close_matches(source.lower(), robots, n=1)
        advice = f'; did you mean "{close[0]}"?' if close else ""
        raise InputError(
            f"{source}: no such file; must be a robot file or a built-in robot "
            f"({', '.join(robots)}){advice}"
        ) from error


def _geometry_faults(tables: Mapping[str, Any]) -> list[str]:
    """Why the legs cannot meet; silent while a length itself is missing or wrong."""
    try:
        a, length1, length2 = (
            msgspec.convert(value_at(tables, key), Length)
            for key in ("geometry.a", "leg1.length", "leg2.length")
        )
    except (LookupError, msgspec.ValidationError):
        return []
    # Only the lengths matter to the question, so the rest may still be wrong in the file.
    leg1, leg2 = (GivenLeg(length, 1.0, np.eye(6)) for length in (length1, length2))
    skeleton = Biglide("", a, platform_mass=1.0, actuator_stiffness=1.0, leg1=leg1, leg2=leg2)
    place = "geometry.a, leg1.length, leg2.length"
    return [f"{place}: {fault}" for fault in geometry_faults(skeleton)]


def _robot(tables: RobotTables) -> Biglide:
    foot, tool = tables.foot, tables.tool
    return Biglide(
        name=tables.name,
        a=tables.geometry.a,
        platform_mass=tables.platform.mass,
        actuator_stiffness=tables.actuators.stiffness,
        leg1=leg_of(tables.leg1),
        leg2=leg_of(tables.leg2),
        tool_offset=np.array(tables.geometry.tool_offset, dtype=float),
        foot_compliance=None if foot is None else symmetric(foot.compliance),
        tool_compliance=symmetric(tool.compliance) if tool and tool.active else None,
    )
