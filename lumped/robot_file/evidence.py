"""Tables of a robot file for accepted errors, measured values, uncertain inputs and misprints."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from lumped.acceptance.measured import Measured, measured_value, pose_faults
from lumped.acceptance.requirement import MODEL_KINDS, Requirement
from lumped.errors import InputError
from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.hammer import hammer_faults
from lumped.robot_file.mechanism.relations import named_twice
from lumped.robot_file.places import value_at
from lumped.robot_file.reading import number_or_text, table_rows
from lumped.robot_file.rules.rule import is_finite_number
from lumped.robot_file.rules.tables.requests import (
    ACCEPT,
    MEASURED,
    MEASURED_VALUES,
    AcceptEntry,
    MeasuredEntry,
)
from lumped.robot_file.rules.tables.robots import BiglideEntry, Correction, RobotEntry
from lumped.text import shown

# Tables that do not describe the robot. Their numbers cannot be uncertain inputs.
OF_NO_ROBOT = {"schema", "accept", "agree", "path", "hammer"}
_COLUMNS = ("quantity", "pose", "value", "uncertainty", "source")


def read_measured(
    path: Path,
    responses: Sequence[str] = (),
    unit: UnitOfLength = METRE,
    moves: Sequence[str] = (),
) -> tuple[Measured, ...]:
    """Measured values from a CSV file.

    The columns of the file are quantity, pose, value, uncertainty, source and, if needed, load. The
    column pose contains one coordinate for each of the tool's `moves`, separated by spaces. Lengths
    are in `unit`. `responses` are the names of the judged values of the robot's harmonic responses.
    Raises InputError with one line per fault.
    """
    rows = table_rows(path, "a CSV file of measured values", _COLUMNS, MEASURED_VALUES.most)
    rules, values, faults = MEASURED.in_unit(unit, moves), [], []
    for location, cells in rows:
        table = {name: _value(name, cells[name]) for name in _COLUMNS}
        if cells.get("load"):
            table["load"] = _value("load", cells["load"])
        row_faults, read = rules.checked_within(table, f"{location}.")
        if row_faults:
            faults += row_faults
            continue
        try:
            values.append(measured_of(rules.entry(read), location, responses))
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return tuple(values)


def measured_of(entry: MeasuredEntry, location: str, responses: Sequence[str]) -> Measured:
    """Measured value from an entry of the table [[measured]] or a row of a CSV file.

    `responses` are the names of the judged values of the robot's harmonic responses. Raises
    InputError if the entry has faults. Each fault begins with `location`.
    """
    return measured_value(
        entry.quantity,
        location,
        responses,
        value=entry.value,
        uncertainty=entry.uncertainty,
        source=entry.source,
        pose=entry.pose,
        load=entry.load,
    )


def _value(name: str, text: str) -> Any:
    """Value of the cell `text` in the column `name` of a CSV file, as it would be in a robot file.

    A pose is a list of numbers, a quantity or source a text. Any other cell is a number if
    possible, otherwise a text.
    """
    if name == "pose":
        return [_value("", part) for part in text.split()]
    if name in {"quantity", "source"}:
        return text.strip() or ("unnamed" if name == "source" else "")
    return number_or_text(text)


def requirement_of(accept: AcceptEntry | None, robot: Mechanism) -> Requirement:
    """Limits for the models of a robot, from the table [accept] of its file.

    If `accept` is None, they are the default limits.
    """
    requirement = Requirement(
        loads=tuple(load.name for load in robot.loads),
        responses=robot.judged_responses,
    )
    return requirement if accept is None else replace(requirement, **vars(accept))


def with_options(
    requirement: Requirement,
    accept: Sequence[str],
    rely: Sequence[str],
    unit: UnitOfLength = METRE,
) -> Requirement:
    """Limits changed by the command line options `--accept NAME=NUMBER` and `--rely MODEL`.

    NAME is deflection, displacement (in `unit`), frequency, response, modes or the name of a
    quantity. `accept` contains the texts NAME=NUMBER. The models in `rely` replace those of the
    robot file, unless `rely` is empty. Raises InputError with one line per fault.
    """
    faults = [
        f"--rely {model}: no such model; must be one of {', '.join(MODEL_KINDS)}"
        for model in rely
        if model not in MODEL_KINDS
    ]
    general = ("deflection", "displacement", "frequency", "response", "modes")
    rules = ACCEPT.in_unit(unit, ())
    for text in accept:
        name, _, typed = text.partition("=")
        rule = rules.keys[name if name in general else general[0]].kind
        value = int(typed[:9]) if typed.isdecimal() else _value("", typed)
        if name not in (
            names := (*general, *(quantity.name for quantity in requirement.quantities))
        ):
            faults.append(f"--accept {text}: must be NAME=NUMBER with a name of {', '.join(names)}")
        elif rule.faults(value, name):
            faults.append(f"--accept {text}: must be NAME=NUMBER, {rule.allowed}")
        else:
            limits: dict[str, Any] = {"limits": {**requirement.limits, name: float(value)}}
            changes = {name: rule.read(value)} if name in general else limits
            requirement = replace(requirement, **changes)
    if faults:
        raise InputError(faults)
    return replace(requirement, rely=tuple(rely)) if rely else requirement


def times(value: Any, factor: float) -> Any:
    """A number, or all numbers of a matrix, multiplied by `factor`."""
    return [times(entry, factor) for entry in value] if isinstance(value, list) else factor * value


def corrections_of(entry: RobotEntry) -> tuple[Correction, ...]:
    """Corrected misprints in the source of the data. Only robot files of schema 1 list them."""
    return entry.corrections if isinstance(entry, BiglideEntry) else ()


def evidence_faults(tables: Mapping[str, Any], entry: RobotEntry, robot: Mechanism) -> list[str]:
    """Faults of corrections, measured values, modal test and uncertain inputs, one line each.

    `entry` is the record into which the `tables` of the file were read.
    """
    faults: list[str] = []
    for number, correction in enumerate(corrections_of(entry), start=1):
        faults += _correction_faults(tables, f"corrections[{number}]", correction)
    for number, measured in enumerate(entry.measured, start=1):
        location = f"measured[{number}]"
        try:
            value = measured_of(measured, location, robot.judged_responses)
        except InputError as error:
            faults += error.faults
        else:
            faults += pose_faults(robot, value, location)
    if entry.hammer is not None:
        faults += hammer_faults(entry.hammer, robot)
    keys = [uncertain.key for uncertain in entry.input_uncertainty]
    rely = entry.accept.rely if entry.accept is not None else ()
    repeated = (
        named_twice(keys, "input_uncertainty[{}].key"),
        named_twice(rely, "accept.rely[{}]"),
    )
    faults += [f"{fault}; must be named once" for table in repeated for fault in table]
    return faults + [
        f"input_uncertainty[{number}].key = {shown(key)}: must name a number or a matrix "
        'of the robot in this file, like "leg1.length" or "foot.compliance"'
        for number, key in enumerate(keys, start=1)
        if key.partition(".")[0].strip() in OF_NO_ROBOT
        or not _are_numbers(_value_or_none(tables, key))
    ]


def _correction_faults(
    tables: Mapping[str, Any], location: str, correction: Correction
) -> Iterator[str]:
    value = _value_or_none(tables, correction.key)
    if not is_finite_number(value):
        yield (
            f"{location}.key = {shown(correction.key)}: must name a number of this file, "
            'like "leg1.length" or "foot.compliance[6,6]"'
        )
        return
    if value != correction.used:
        yield (
            f"{location}.used = {correction.used!r}: must be the value of {correction.key}, "
            f"{value!r}"
        )
    if correction.printed == correction.used:
        required = "must differ from used, or there is nothing to correct"
        yield f"{location}.printed = {correction.printed!r}: {required}"


def _value_or_none(tables: Mapping[str, Any], key: str) -> Any:
    try:
        return value_at(tables, key)
    except LookupError:
        return None


def _are_numbers(value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(map(_are_numbers, value))
    return is_finite_number(value)
