"""Detection power: each fault a case, which claims that the comparisons of the run notice it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from fem.calculix.run import CalculixMissing, calculix_program
from lumped.robot_file import RobotFile
from validation.case import Absolute, Case, Measurement, Outcome, Relation, Skip
from validation.catalogue import catalogue
from validation.context import Context, Preset
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Fault
from validation.faults.sound import SoundCases, sound_cases
from validation.faults.trial import catchers, tried
from validation.results.records import Task

SECTION = "Detection power"
_PREFIX = "fault."
_CASES, _GROUPS, _VERDICTS = "caught by", "group", "verdict"
_NONE = "–"
# Time (s) of one fault, mostly in groups of lumped models.
_EFFORT = 3.0


def with_faults(robot_file: RobotFile) -> Sequence[Task]:
    """Everything a run can compute, and the faults to be noticed by it."""
    return (*catalogue(robot_file), *fault_cases())


def fault_cases() -> tuple[Case, ...]:
    """One case for each fault."""
    return tuple(
        Case(
            id=f"{_PREFIX}{fault.id}",
            title=fault.title,
            quantity="comparisons that turn from agreement to disagreement or failure",
            unit="1",
            reference_kind="closed-form",
            citation=f"put into {fault.where}",
            tolerance=Absolute(0.5),
            tolerance_reason="a count is a whole number: one comparison must catch the fault",
            compute=partial(_detect, fault=fault),
            relation=Relation.AT_LEAST,
            section=SECTION,
            subject="robot",
            effort=_EFFORT,
        )
        for fault in FAULTS
    )


def is_fault(identifier: str) -> bool:
    """Whether an id is that of a fault."""
    return identifier.startswith(_PREFIX)


@dataclass(frozen=True)
class Detection:
    """A fault and what noticed it: case ids, and how many of them by group that was asked."""

    id: str
    title: str
    caught_by: tuple[str, ...]
    asked: Mapping[str, int]

    @property
    def thin_ice(self) -> bool:
        """Caught by a single case."""
        return len(self.caught_by) == 1


@dataclass(frozen=True)
class Power:
    """What became of all faults of a run."""

    detections: tuple[Detection, ...]

    @property
    def survivors(self) -> tuple[Detection, ...]:
        """Faults that nothing noticed."""
        return tuple(one for one in self.detections if not one.caught_by)

    @property
    def thin_ice(self) -> tuple[Detection, ...]:
        """Faults that a single case noticed."""
        return tuple(one for one in self.detections if one.thin_ice)

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups that were asked, in the order in which they first were."""
        return tuple(dict.fromkeys(name for one in self.detections for name in one.asked))

    @property
    def sentence(self) -> str:
        """The whole in one sentence."""
        count, lost = len(self.detections), len(self.survivors)
        caught = "all caught" if not lost else f"{lost} not caught"
        thin = len(self.thin_ice)
        return f"{count} faults injected, {caught}, {thin} by a single comparison."

    def records(self) -> list[dict[str, Any]]:
        """The "faults" of results.json."""
        return [
            {"id": one.id, "title": one.title, "caught_by": list(one.caught_by)}
            for one in self.detections
        ]


def detection_power(outcomes: Iterable[Outcome]) -> Power:
    """What the outcomes of fault cases say, in their order.

    Other outcomes are passed over, and faults that this run had nothing to notice them with.
    """
    by_id = {f"{_PREFIX}{fault.id}": fault for fault in FAULTS}
    return Power(
        tuple(
            _detection(by_id[outcome.case.id], outcome)
            for outcome in outcomes
            if outcome.case.id in by_id and outcome.verdict != "skipped"
        )
    )


def comparisons(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """The outcomes that are not those of faults."""
    return [outcome for outcome in outcomes if not is_fault(outcome.case.id)]


def _detection(fault: Fault, outcome: Outcome) -> Detection:
    table = outcome.measurement.table if outcome.measurement else {}
    rows = list(zip(table.get(_CASES, ()), table.get(_GROUPS, ()), strict=True))
    asked = {str(group): 0 for _, group in rows}
    for case, group in rows:
        asked[str(group)] += case != _NONE
    caught_by = tuple(str(case) for case, _ in rows if case != _NONE)
    return Detection(fault.id, fault.title, caught_by, asked)


def _detect(context: Context, fault: Fault) -> Measurement:
    sound = context.get(sound_run, context.robot_file, context.preset)
    said = tried(fault, sound)
    if not said:
        _excuse(fault, context)
    caught = catchers(said)
    missed = {_group(case) for case in said} - {_group(case) for case in caught}
    rows = [(case.id, _group(case), said[case]) for case in caught]
    rows += [(_NONE, group, "agree") for group in sorted(missed)]
    return Measurement(
        float(len(caught)),
        reference=1.0,
        exact=True,
        notes=("thin ice: a single comparison notices it",) if len(caught) == 1 else (),
        table={
            heading: tuple(str(row[column]) for row in rows)
            for column, heading in enumerate((_CASES, _GROUPS, _VERDICTS))
        },
    )


def _group(case: Case) -> str:
    return case.group or case.id


def _excuse(fault: Fault, context: Context) -> None:
    """Raise Skip for a fault in what this run does not use, with a good reason not to.

    Without one the fault has survived.
    """
    if "calculix" in fault.where:
        try:
            calculix_program()
        except CalculixMissing as missing:
            raise Skip(str(missing)) from None
    if context.preset == "quick":
        raise Skip(f"no comparison of preset quick uses {fault.where}; preset standard does")
    if context.robot_file.is_mechanism:
        raise Skip(f"no comparison of a mechanism uses {fault.where}; those of a biglide do")


def sound_run(robot_file: RobotFile, preset: Preset) -> SoundCases:
    """The run's cases without a fault."""
    cases = [
        task for task in catalogue(robot_file) if isinstance(task, Case) and preset in task.presets
    ]
    return sound_cases(cases, robot_file, preset, {fault.where for fault in FAULTS})
