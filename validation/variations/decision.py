"""Decisions by a model among n designs, and their loss by a better model, the reference.

For a design decision the absolute values of a model matter little. Its ranking of the designs must
be right, and its best design must be good. All values are arrays (n) over the designs.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array

Objective: TypeAlias = Literal["deflection", "frequency"]
OBJECTIVES: tuple[Objective, ...] = ("deflection", "frequency")
UNITS: Mapping[Objective, str] = {"deflection": "µm", "frequency": "Hz"}
MEANING: Mapping[Objective, str] = {
    "deflection": "largest deflection over the path under 1000 N along x, y or z",
    "frequency": "smallest first frequency over the path",
}
# Relative difference from the best value below which designs are equally good. Rounding and the
# error of a reduction to the ends are smaller.
INDIFFERENT = 1e-6


@dataclass(frozen=True)
class Choice:
    """Number of the `design` that a model chooses, and its relative `loss` by the reference.

    Among the designs that are `equally_good` by the model (ascending numbers) it is the best by the
    reference.
    """

    design: int
    equally_good: tuple[int, ...]
    loss: float


@dataclass(frozen=True, eq=False)
class Decision:
    """Values (n) of an objective for n designs, by `models` and by the reference.

    `references` contains the values under each reading that the robot file allows, by name. The
    first is the one that decides. `uncertainties` are their relative half-widths (n).
    """

    objective: Objective
    models: Mapping[str, Array]
    references: Mapping[str, Array]
    uncertainties: Mapping[str, Array]

    @property
    def reference(self) -> Array:
        """Values (n) under the first reading."""
        return next(iter(self.references.values()))

    @property
    def best(self) -> int:
        """Number of the best design by the reference."""
        return choice(self.reference, self.reference, self.objective).design

    def choice(self, model: str) -> Choice:
        """Design that a model chooses, with its loss."""
        return choice(self.models[model], self.reference, self.objective)

    def loss_uncertainty(self, design: int) -> float:
        """Half-width of the loss at a design.

        The reference changes by its half-width: the design in one direction, all others in the
        opposite one. Other readings count as well.
        """
        signs = np.full(len(self.reference), -1.0)
        signs[design] = 1.0
        return self._half_width(lambda values: losses(values, self.objective)[design], signs)

    def correlation(self, model: str) -> tuple[float, float]:
        """Spearman's ρ of the rankings by a model and by the reference, and its half-width.

        The reference changes by its half-width in proportion to the rank of each design: towards
        the model's ranking, and away from it. Other readings count as well.
        """
        model_values = self.models[model]
        ranks = _ranks(model_values)
        directions = ranks / max(ranks.max(), 1.0) * 2.0 - 1.0
        correlation = spearman(model_values, self.reference)
        half_width = self._half_width(lambda values: spearman(model_values, values), directions)
        return correlation, half_width

    def _half_width(self, number: Callable[[Array], float], directions: Array) -> float:
        """Largest change of a number if the reference varies along `directions` (n, −1 to 1)."""
        nominal = number(self.reference)
        return max(
            abs(number(values * np.exp(sign * directions * self.uncertainties[name])) - nominal)
            for name, values in self.references.items()
            for sign in (-1.0, 0.0, 1.0)
        )


def choice(values: Array, reference: Array, objective: Objective) -> Choice:
    """Design that a model chooses by its `values`, with its loss by the `reference` values."""
    candidates, relative_losses = equally_good(values, objective), losses(reference, objective)
    design = int(candidates[np.argmin(relative_losses[candidates])])
    return Choice(design, tuple(candidates.tolist()), float(relative_losses[design]))


def equally_good(values: Array, objective: Objective) -> NDArray[np.intp]:
    """Numbers of the best designs, ascending: those within `INDIFFERENT` of the best value."""
    costs = values if objective == "deflection" else -values
    lowest = costs.min()
    return np.flatnonzero(costs <= lowest + INDIFFERENT * abs(lowest))


def losses(reference: Array, objective: Objective) -> Array:
    """Relative loss (n) of each design by the reference: 0.02 if it is 2 % worse than the best.

    For deflections the ratio to the smallest, less 1. For frequencies 1 less the ratio to the
    largest.
    """
    if objective == "deflection":
        return np.asarray(reference / reference.min() - 1.0)
    return np.asarray(1.0 - reference / reference.max())


def spearman(first: Array, second: Array) -> float:
    """Rank correlation (Spearman's ρ, −1 to 1) of two sets of values (n) of the designs.

    Equally good designs share their mean rank. NaN if all designs are equally good by one set.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.corrcoef(_ranks(first), _ranks(second))[0, 1])


def _ranks(values: Array) -> Array:
    """Ranks from 0. Values within `INDIFFERENT` of the next smaller one share their mean rank."""
    order = np.argsort(values, kind="stable")
    ascending, ties = values[order], np.zeros(len(values), dtype=int)
    ties[order[1:]] = np.cumsum(np.diff(ascending) > INDIFFERENT * np.abs(ascending[1:]))
    counts = np.bincount(ties)
    return np.asarray((np.cumsum(counts) - 0.5 * (counts + 1.0))[ties])
