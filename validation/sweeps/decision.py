"""Decisions by a model: the best relative leg length, and what it costs in another model's terms.

Whoever designs a robot with a model asks little of its absolute numbers: its order of the designs
must be right, and its best design must be good. So each model chooses α over the whole stroke, and
the solid legs say what the choice is worth.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.studies.quantities import deflections_of
from validation.sweeps.journal import Journal
from validation.sweeps.plans import SweptModel, member_units
from validation.sweeps.runner import Executor, in_turn, sweep
from validation.sweeps.units import PostureUnit, SolvedPostures

Objective: TypeAlias = Literal["deflection", "frequency"]
OBJECTIVES: tuple[Objective, ...] = ("deflection", "frequency")
UNITS: Mapping[Objective, str] = {"deflection": "µm", "frequency": "Hz"}
MEANING: Mapping[Objective, str] = {
    "deflection": "largest deflection over the stroke under 1000 N along x, y or z",
    "frequency": "smallest first frequency over the stroke",
}

# Designs whose objectives differ by less are equally good: rounding, and the reduction's error.
_INDIFFERENT = 1e-6
# The objective's maximum over the postures is smooth: its sampling error falls with their square.
_SAMPLING_ORDER_FACTOR = 3.0


@dataclass(frozen=True)
class Brief:
    """What is to be decided: `alphas` to choose from, `postures` of the stroke that are looked at.

    After the grid the neighbourhood of its best α is halved `halvings` times.
    """

    alphas: tuple[float, ...]
    postures: int
    halvings: int


@dataclass(frozen=True)
class Value:
    """Objectives of one design by one model over the stroke.

    `deflection` (µm): the largest under 1000 N along x or y (planar) and z; `frequency` (Hz): the
    smallest first one, NaN for a static model; `sampling` their errors by the number of postures.
    """

    deflection: float
    frequency: float
    sampling: Mapping[Objective, float]

    def of(self, objective: Objective) -> float:
        """One of both."""
        return self.deflection if objective == "deflection" else self.frequency


@dataclass(frozen=True)
class Choice:
    """What a model chooses by an objective.

    `best` is the α chosen. Where the model finds several equally good, `indifferent` is their
    range (first and last on the grid) and `best` the shortest legs among them. The optimum lies
    between `neighbours`, the α beside it that were looked at (the α itself at an end of the range).
    """

    best: float
    indifferent: tuple[float, float]
    neighbours: tuple[float, float]
    value: float


@dataclass(frozen=True)
class Decision:
    """All models' values of the feasible designs and their choices, by label of the model.

    `values[label][α]` covers the grid and whatever was looked at beside it; `impossible` says at
    which α the legs cannot meet.
    """

    alphas: tuple[float, ...]
    impossible: tuple[str, ...]
    values: Mapping[str, Mapping[float, Value]]
    choices: Mapping[tuple[str, Objective], Choice]

    def curve(self, label: str, objective: Objective) -> list[float]:
        """The objective over `alphas`, NaN where the model knows none."""
        return [self.values[label][alpha].of(objective) for alpha in self.alphas]

    def cost(self, label: str, objective: Objective, judge: str) -> float:
        """Relative loss in the judge's terms of following a model: 0.02 for 2 % worse.

        The deflection of the model's choice over the judge's best less 1; for frequencies 1 less
        the ratio. Slightly negative where the model chose better than the judge's own search.
        """
        return self.cost_at(self.choices[label, objective].best, objective, judge)

    def cost_at(self, alpha: float, objective: Objective, judge: str) -> float:
        """The same for a design that was looked at."""
        found = self.values[judge][alpha].of(objective)
        best = self.choices[judge, objective].value
        return found / best - 1.0 if objective == "deflection" else 1.0 - found / best

    def sampling(self, alpha: float, objective: Objective, judge: str) -> float:
        """Relative error of the judge's value at `alpha` by the number of postures."""
        value = self.values[judge][alpha]
        return value.sampling[objective] / value.of(objective)

    def resolution(self, objective: Objective, judge: str) -> float:
        """Relative error of the judge's best value by the last interval of its search.

        Half of what is lost at the worse neighbour: about a corner the objective is linear.
        """
        beside = self.choices[judge, objective].neighbours
        return 0.5 * max(self.cost_at(alpha, objective, judge) for alpha in beside)

    def spearman(self, label: str, objective: Objective, judge: str) -> float:
        """Rank correlation (Spearman's ρ) of the designs between a model and the judge."""
        return spearman(self.curve(label, objective), self.curve(judge, objective))

    def kendall(self, label: str, objective: Objective, judge: str) -> float:
        """Rank correlation (Kendall's τ-b) of the designs between a model and the judge."""
        return kendall(self.curve(label, objective), self.curve(judge, objective))


def decide(
    robot: Biglide,
    models: Sequence[SweptModel],
    brief: Brief,
    possible: tuple[tuple[float, ...], tuple[str, ...]],
    executor: Executor = in_turn,
    journal: Journal | None = None,
) -> Decision:
    """Each model's best α by both objectives, and every model's values at all of them.

    A grid, then halving about its best point, which finds the optimum if there is one between its
    neighbours; deterministic. `possible` are those of the brief's α at which the robot can be
    built, and why the others are not, as `feasible_alphas` has them.
    """
    kept = Journal() if journal is None else journal
    alphas, impossible = possible
    found = _Values(robot, tuple(models), brief, executor, kept)
    found.look_at({model: set(alphas) for model in models})
    sought = [(model, objective) for model in models for objective in objectives_of(model)]
    brackets = {
        (model, objective): _Bracket.about_the_best(found.by_model[model], alphas, objective)
        for model, objective in sought
    }
    for _ in range(brief.halvings):
        wanted: dict[SweptModel, set[float]] = {model: set() for model in models}
        for (model, _objective), bracket in brackets.items():
            wanted[model].update(bracket.midpoints())
        found.look_at(wanted)
        brackets = {
            (model, objective): bracket.halved(found.by_model[model], objective)
            for (model, objective), bracket in brackets.items()
        }
    choices = {
        (model.label, objective): _choice(found.by_model[model], bracket, alphas, objective)
        for (model, objective), bracket in brackets.items()
    }
    chosen = {choice.best for choice in choices.values()}
    found.look_at({model: set(chosen) for model in models})
    return Decision(
        alphas=alphas,
        impossible=impossible,
        values={model.label: found.by_model[model] for model in models},
        choices=choices,
    )


def objectives_of(model: SweptModel) -> tuple[Objective, ...]:
    """What a model can decide by: the virtual joints know no masses."""
    return ("deflection",) if model.model == "vjm" else OBJECTIVES


@dataclass(frozen=True)
class _Bracket:
    """Best α so far with its neighbours; at an end of the range it has one."""

    left: float
    best: float
    right: float

    @classmethod
    def about_the_best(
        cls, values: Mapping[float, Value], alphas: Sequence[float], objective: Objective
    ) -> "_Bracket":
        at = alphas.index(_best(values, alphas, objective))
        return cls(alphas[max(at - 1, 0)], alphas[at], alphas[min(at + 1, len(alphas) - 1)])

    def midpoints(self) -> tuple[float, ...]:
        middles = (0.5 * (self.left + self.best), 0.5 * (self.best + self.right))
        return tuple(alpha for alpha in middles if alpha != self.best)

    def halved(self, values: Mapping[float, Value], objective: Objective) -> "_Bracket":
        points = sorted({self.left, *self.midpoints(), self.best, self.right})
        return _Bracket.about_the_best(values, points, objective)


class _Values:
    """Values of designs by model, computed when they are first looked at."""

    def __init__(
        self,
        robot: Biglide,
        models: tuple[SweptModel, ...],
        brief: Brief,
        executor: Executor,
        journal: Journal,
    ) -> None:
        self.by_model: dict[SweptModel, dict[float, Value]] = {model: {} for model in models}
        self._robot, self._executor, self._journal = robot, executor, journal
        angles = np.linspace(0.0, np.pi, brief.postures)
        # As over the stroke: denser towards its ends, where deflections go like a root.
        self._fractions = tuple((0.5 * (1.0 - np.cos(angles))).tolist())

    def look_at(self, wanted: Mapping[SweptModel, set[float]]) -> None:
        new: list[tuple[SweptModel, float]] = []
        units: list[PostureUnit] = []
        for alpha in sorted(set().union(*wanted.values())):
            models = [m for m, asked in wanted.items() if alpha in asked - self.by_model[m].keys()]
            new += ((model, alpha) for model in models)
            units += member_units(models, self._robot, alpha, self._fractions)
        solved = sweep(units, self._executor, self._journal)
        for (model, alpha), found in zip(new, solved, strict=True):
            self.by_model[model][alpha] = value_of(found)


def value_of(solved: SolvedPostures) -> Value:
    """Objectives over the postures; their sampling error from every second posture alone."""
    found = deflections_of(solved.compliances)
    curves = np.array([found.planar_x, found.planar_y, found.along_z])
    largest, coarse = float(np.nanmax(curves)), float(np.nanmax(curves[:, ::2]))
    sampling: dict[Objective, float] = {"deflection": (largest - coarse) / _SAMPLING_ORDER_FACTOR}
    smallest = np.nan
    if solved.frequencies.shape[1]:
        first = solved.frequencies[:, 0]
        smallest = float(first.min())
        sampling["frequency"] = (float(first[::2].min()) - smallest) / _SAMPLING_ORDER_FACTOR
    return Value(largest, smallest, sampling)


def _best(values: Mapping[float, Value], alphas: Sequence[float], objective: Objective) -> float:
    """The best α; of several equally good ones the smallest."""
    return _equally_good(values, alphas, objective)[0]


def _equally_good(
    values: Mapping[float, Value], alphas: Sequence[float], objective: Objective
) -> list[float]:
    sign = 1.0 if objective == "deflection" else -1.0
    found = np.array([sign * values[alpha].of(objective) for alpha in alphas])
    good = found <= found.min() + _INDIFFERENT * abs(found.min())
    return [alpha for alpha, chosen in zip(alphas, good, strict=True) if chosen]


def _choice(
    values: Mapping[float, Value], bracket: _Bracket, alphas: Sequence[float], objective: Objective
) -> Choice:
    good = _equally_good(values, sorted({*alphas, bracket.best}), objective)
    return Choice(
        best=good[0],
        indifferent=(good[0], good[-1]),
        neighbours=(bracket.left, bracket.right),
        value=values[good[0]].of(objective),
    )


# scipy.stats takes half a second to import, in every process of a run: it waits for its use.
def spearman(one: Sequence[float] | Array, other: Sequence[float] | Array) -> float:
    """Spearman's ρ, −1 to 1; NaN where one of them is constant."""
    from scipy.stats import spearmanr  # noqa: PLC0415

    return float(spearmanr(one, other).statistic)


def kendall(one: Sequence[float] | Array, other: Sequence[float] | Array) -> float:
    """Kendall's τ-b, −1 to 1; NaN where one of them is constant."""
    from scipy.stats import kendalltau  # noqa: PLC0415

    return float(kendalltau(one, other).statistic)
