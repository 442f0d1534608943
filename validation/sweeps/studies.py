"""The three sweeps of a run: over the stroke, over the family at three points, and the decision.

The cases and figures read them; with a cluster they are computed beforehand. What is finished is
in a journal, so that it does not matter who computes what first.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TypeAlias, TypeVar

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, scaled
from lumped.errors import InputError
from validation.agreement.convergence import step_factor
from validation.case import Skip
from validation.context import SWEEPS_FOLDER, Context, Preset
from validation.solids.legs import FORMAL_ORDER
from validation.solids.size import too_large
from validation.studies.quantities import Deflections, deflections_of
from validation.sweeps.decision import Brief, Decision, decide
from validation.sweeps.journal import Journal, journal_in
from validation.sweeps.plans import (
    COARSE,
    FREE,
    RIGID,
    SweptModel,
    feasible_alphas,
    lumped_models,
    member_units,
    solid_model,
    stroke_stations,
    stroke_units,
)
from validation.sweeps.runner import Executor, in_turn, sweep
from validation.sweeps.units import SolvedPostures

Sweep: TypeAlias = Callable[[Biglide, Preset, Journal, Executor], object]
STROKE_FREQUENCIES = 4
# Where Figs 6, 12 and 13 are drawn, as a fraction of the stroke.
POINTS: Mapping[str, float] = {"left": 0.0, "centre": 0.5, "right": 1.0}
# The family of Figs 6 and 13.
PAPER_RANGE = (1.0, 2.0)


@dataclass(frozen=True)
class Plan:
    """How finely a preset looks: the decision's brief, divisions of the solids, segments of a leg.

    `coarse` divisions show the solids' own error, None where there is no time for it.
    """

    brief: Brief
    divisions: int
    coarse: int | None
    segments: int
    stations: int

    @property
    def refinement(self) -> float:
        """Uncertainty of the finer solids over the step to them, infinite without coarser ones.

        Of fourth order, that of legs without contraction (ν = 0), which no face holds.
        """
        if self.coarse is None:
            return inf
        return step_factor(self.divisions / self.coarse, FORMAL_ORDER)

    def judges(self) -> tuple[SweptModel, ...]:
        """The solid with rigid end faces and, to show its error, a coarser one."""
        coarse = () if self.coarse is None else (solid_model(COARSE, "rigid", self.coarse),)
        return (solid_model(RIGID, "rigid", self.divisions), *coarse)


_FINE_ALPHAS = (
    *np.linspace(0.45, 0.95, 11).round(2).tolist(),
    *np.linspace(1.0, 2.0, 9).tolist(),
)
PLANS: Mapping[Preset, Plan] = {
    "quick": Plan(Brief((0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.4, 2.0), 11, 3), 1, None, 6, 11),
    "standard": Plan(
        Brief((0.4, 0.5, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.25, 1.5, 2.0), 21, 6),
        divisions=2,
        coarse=1,
        segments=20,
        stations=41,
    ),
    "fine": Plan(
        Brief((0.4, *_FINE_ALPHAS), 41, 7),
        divisions=3,
        coarse=2,
        segments=20,
        stations=81,
    ),
}


@dataclass(frozen=True)
class Curves:
    """What one model says along x or along α: deflections (µm) and frequencies (Hz, m×k)."""

    deflections: Deflections
    frequencies: Array


def stroke_study(
    robot: Biglide, preset: Preset, journal: Journal, executor: Executor = in_turn
) -> dict[str, Curves]:
    """All models over the stroke of the robot, at `stroke_stations(robot, plan.stations)`.

    Raises InputError where its legs are too large as solids for a run.
    """
    plan = PLANS[preset]
    _require_affordable(robot, preset)
    x = stroke_stations(robot, plan.stations)
    free = solid_model(FREE, "free", plan.divisions)
    models = (*lumped_models(plan.segments), free, *plan.judges()[:1])
    units = {model.label: stroke_units(model, robot, x, STROKE_FREQUENCIES) for model in models}
    flat = [unit for of_model in units.values() for unit in of_model]
    solved = iter(sweep(flat, executor, journal))
    return {label: _curves([next(solved) for _ in of]) for label, of in units.items()}


def alpha_study(
    robot: Biglide, preset: Preset, journal: Journal, executor: Executor = in_turn
) -> tuple[tuple[float, ...], dict[tuple[str, str], Curves]]:
    """α of the paper's range, and all models along it at each of `POINTS`, by (label, point).

    Raises InputError where no α of the range is possible, or legs are too large as solids.
    """
    plan = PLANS[preset]
    low, high = PAPER_RANGE
    asked = [alpha for alpha in plan.brief.alphas if low <= alpha <= high]
    alphas, _ = feasible_alphas(robot, asked)
    _require_affordable(scaled(robot, alphas[-1]), preset)
    models = (*lumped_models(plan.segments), *plan.judges())
    fractions = tuple(POINTS.values())
    units = [unit for alpha in alphas for unit in member_units(models, robot, alpha, fractions)]
    solved = sweep(units, executor, journal)
    curves = {}
    for number, model in enumerate(models):
        of_model = solved[number :: len(models)]
        for place, point in enumerate(POINTS):
            curves[model.label, point] = Curves(
                deflections_of(np.array([found.compliances[place] for found in of_model])),
                np.array([found.frequencies[place] for found in of_model]),
            )
    return alphas, curves


def decision_study(
    robot: Biglide, preset: Preset, journal: Journal, executor: Executor = in_turn
) -> Decision:
    """The best α by every model; raises InputError as `alpha_study` does."""
    plan = PLANS[preset]
    possible = feasible_alphas(robot, plan.brief.alphas)
    _require_affordable(scaled(robot, possible[0][-1]), preset)
    models = (*lumped_models(plan.segments), *plan.judges())
    return decide(robot, models, plan.brief, possible, executor, journal)


def _require_affordable(robot: Biglide, preset: Preset) -> None:
    """Raise InputError where a leg has more unknowns as a solid than the preset takes."""
    if reason := too_large((robot.leg1, robot.leg2), 2 * (PLANS[preset].divisions,), preset):
        raise InputError(reason)


def precompute(
    robot: Biglide,
    preset: Preset,
    folder: Path,
    executor: Executor,
    studies: Sequence[Sweep] = (decision_study, alpha_study, stroke_study),
) -> None:
    """Compute `studies` beforehand, with `executor`, into the journal in `folder`.

    What is impossible for this robot is left to the cases, which say why. Raises ComputationError
    where a unit or the executor fails; what was finished before is kept.
    """
    journal = journal_in(str(folder))
    for study in studies:
        with suppress(InputError):
            study(robot, preset, journal, executor)


def _curves(parts: list[SolvedPostures]) -> Curves:
    return Curves(
        deflections_of(np.concatenate([part.compliances for part in parts])),
        np.concatenate([part.frequencies for part in parts]),
    )


# Cases and figures of one group share the sweeps in one process.
GROUP = "decision"
# Some sixty robots with solid legs are looked at: too many for a quick answer.
DECIDED: tuple[Preset, ...] = ("standard", "fine")
PAPER = "Briot, Pashkevich, Chablat, §2.3, §3.3 and conclusions"
T = TypeVar("T")


def studies_read(preset: Preset) -> tuple[Sweep, ...]:
    """The sweeps that cases and figures of a preset read."""
    curves = alpha_study, stroke_study
    return (decision_study, *curves) if preset in DECIDED else curves


def decision_of(context: Context) -> Decision:
    """The decision of the run.

    Raises Skip where no robot of the family is possible or legs are too large as solids; so do the
    other two.
    """
    return _or_skip(context, decision_study)


def family_of(context: Context) -> tuple[tuple[float, ...], dict[tuple[str, str], Curves]]:
    """α of the paper's range and all models along it, by (label, point of the stroke)."""
    return _or_skip(context, alpha_study)


def stroke_of(context: Context) -> dict[str, Curves]:
    """All models over the stroke, by label."""
    return _or_skip(context, stroke_study)


def _or_skip(context: Context, study: Callable[[Biglide, Preset, Journal], T]) -> T:
    """A study of the run, from its journal as far as that goes."""
    journal = journal_in(context.options.get(SWEEPS_FOLDER, ""))
    try:
        return context.get(study, context.robot, context.preset, journal)
    except InputError as error:
        raise Skip("; ".join(error.faults)) from error
