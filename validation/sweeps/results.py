"""The sweeps of a run as its cases and figures read them: computed once, or beforehand."""

from collections.abc import Callable
from typing import TypeVar

from lumped.biglide import Biglide
from lumped.errors import InputError
from validation.case import Skip
from validation.context import SWEEPS_FOLDER, Context, Preset
from validation.studies.decision import Decision
from validation.sweeps.studies import (
    Curves,
    Study,
    alpha_study,
    decision_study,
    journal_in,
    stroke_study,
)

# Cases and figures of one group share the sweeps in one process.
GROUP = "decision"
# Some sixty robots with solid legs are looked at: too many for a quick answer.
DECIDED: tuple[Preset, ...] = ("standard", "fine")
PAPER = "Briot, Pashkevich, Chablat, §2.3, §3.3 and conclusions"
T = TypeVar("T")


def studies_read(preset: Preset) -> tuple[Study, ...]:
    """The sweeps that cases and figures of a preset read."""
    curves = alpha_study, stroke_study
    return (decision_study, *curves) if preset in DECIDED else curves


def decision_of(context: Context) -> Decision:
    """The decision of the run; skips the case where no robot of the family is possible."""
    return _or_skip(context, decided)


def family_of(context: Context) -> tuple[tuple[float, ...], dict[tuple[str, str], Curves]]:
    """α of the paper's range and all models along it, by (label, point of the stroke)."""
    return _or_skip(context, family)


def stroke_of(context: Context) -> dict[str, Curves]:
    """All models over the stroke, by label."""
    return context.get(stroke, *_arguments(context))


def decided(robot: Biglide, preset: Preset, folder: str) -> Decision:
    """The decision for a robot, from the journal in `folder` as far as it goes."""
    return decision_study(robot, preset, journal_in(folder))


def family(
    robot: Biglide, preset: Preset, folder: str
) -> tuple[tuple[float, ...], dict[tuple[str, str], Curves]]:
    """The family at three points of the stroke, likewise."""
    return alpha_study(robot, preset, journal_in(folder))


def stroke(robot: Biglide, preset: Preset, folder: str) -> dict[str, Curves]:
    """All models over the stroke, likewise."""
    return stroke_study(robot, preset, journal_in(folder))


def _arguments(context: Context) -> tuple[Biglide, Preset, str]:
    return context.robot, context.preset, context.options.get(SWEEPS_FOLDER, "")


def _or_skip(context: Context, study: Callable[[Biglide, Preset, str], T]) -> T:
    try:
        return context.get(study, *_arguments(context))
    except InputError as error:
        raise Skip("; ".join(error.faults)) from error
