"""Detection power: each fault a case, which claims that the comparisons of the run notice it."""

from collections.abc import Sequence
from functools import partial

from fem.calculix.run import calculix_program
from lumped.robot_file import RobotFile
from validation.case import Absolute, Case, Measurement, Relation, Skip
from validation.catalogue import catalogue
from validation.context import Context, Preset
from validation.faults.catalogue import FAULTS
from validation.faults.fault import Fault
from validation.faults.sound import SoundCases, sound_cases
from validation.faults.trial import catchers, tried
from validation.report.detection import CASES, GROUPS, NONE, PREFIX, VERDICTS
from validation.results.tasks import Task

SECTION = "Detection power"
# Time (s) of one fault, mostly in groups of lumped models.
_EFFORT = 3.0


def with_faults(robot_file: RobotFile) -> Sequence[Task]:
    """Everything a run can compute, and the faults to be noticed by it."""
    return (*catalogue(robot_file), *fault_cases())


def fault_cases() -> tuple[Case, ...]:
    """One case for each fault."""
    return tuple(
        Case(
            id=f"{PREFIX}{fault.id}",
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
            subject="faults",
            row=fault.id,
            effort=_EFFORT,
        )
        for fault in FAULTS
    )


def _detect(context: Context, fault: Fault) -> Measurement:
    sound = context.get(sound_run, context.robot_file, context.preset)
    said = tried(fault, sound)
    if not said:
        _excuse(fault, context)
    caught = catchers(said)
    missed = {_group(case) for case in said} - {_group(case) for case in caught}
    rows = [(case.id, _group(case), said[case]) for case in caught]
    rows += [(NONE, group, "agree") for group in sorted(missed)]
    return Measurement(
        float(len(caught)),
        reference=1.0,
        exact=True,
        notes=("thin ice: a single comparison notices it",) if len(caught) == 1 else (),
        table={
            heading: tuple(str(row[column]) for row in rows)
            for column, heading in enumerate((CASES, GROUPS, VERDICTS))
        },
    )


def _group(case: Case) -> str:
    return case.group or case.id


def _excuse(fault: Fault, context: Context) -> None:
    """Raise Skip, or CalculixMissing, for a fault in what this run has a reason not to use.

    Without one the fault has survived.
    """
    if "calculix" in fault.where:
        calculix_program()
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
