"""Choice of the best of n designs by a model, and its loss by the reference.

Input: values of an objective (deflection or frequency) for n designs, by each model and by the
reference. Output: the design that a model chooses, its relative loss, and the rank correlation of
the model's ranking. For a design decision, absolute values matter little: the ranking must be
right, and the chosen design must be good. All arrays have n entries.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from lumped.arrays import Array

Objective: TypeAlias = Literal["deflection", "frequency"]
OBJECTIVES: tuple[Objective, ...] = ("deflection", "frequency")
UNITS: Mapping[Objective, str] = {"deflection": "µm", "frequency": "Hz"}
MEANING: Mapping[Objective, str] = {
    "deflection": "largest deflection over the path under 1000 N along x, y or z",
    "frequency": "smallest first frequency over the path",
}
# Relative difference from the best value below which designs count as equal. Round-off and the
# error of reduced models are smaller.
INDIFFERENT = 1e-6


@dataclass(frozen=True)
class Choice:
    """Index of the `design` that a model chooses, and its relative `loss` by the reference.

    `equally_good`: ascending indices of the best designs by the model, which it rates as equal. Of
    these, `design` is the one that the reference rates best.
    """

    design: int
    equally_good: tuple[int, ...]
    loss: float


@dataclass(frozen=True, eq=False)
class Decision:
    """Values (n) of an objective for n designs, by each of the `models` and by the reference.

    `references`: values of the reference under each interpretation of the robot file, by name; the
    first one evaluates the choices. `uncertainties`: their relative half-widths (n).
    """

    objective: Objective
    models: Mapping[str, Array]
    references: Mapping[str, Array]
    uncertainties: Mapping[str, Array]

    @property
    def reference(self) -> Array:
        """Values (n) of the reference under its first interpretation.

        Shapes: n designs.
        """
        return next(iter(self.references.values()))

    @property
    def best(self) -> int:
        """Index of the best design by the reference."""
        return choice(self.reference, self.reference, self.objective).design

    def choice(self, model: str) -> Choice:
        """Design that a model chooses, with its loss by the reference."""
        return choice(self.models[model], self.reference, self.objective)

    def loss_uncertainty(self, design: int) -> float:
        """Half-width of the loss of a design.

        The reference's value of the design is changed by its half-width in one direction, the
        values of all other designs in the opposite direction, and conversely. The half-width also
        covers the losses under the other interpretations of the robot file.
        """
        signs = np.full(len(self.reference), -1.0)
        signs[design] = 1.0
        return self._half_width(lambda values: losses(values, self.objective)[design], signs)

    def correlation(self, model: str) -> tuple[float, float]:
        """Spearman's ρ between the rankings by a model and by the reference, and its half-width.

        For the half-width, the reference's value of each design is changed by a factor from −1 to 1
        times the value's half-width. The factor grows linearly with the design's rank by the model,
        so that the reference's ranking moves towards that of the model. The opposite changes move
        it away. The half-width also covers ρ under the other interpretations of the robot file.
        """
        model_values = self.models[model]
        ranks = _ranks(model_values)
        directions = ranks / max(ranks.max(), 1.0) * 2.0 - 1.0
        correlation = spearman(model_values, self.reference)
        half_width = self._half_width(lambda values: spearman(model_values, values), directions)
        return correlation, half_width

    def _half_width(self, number: Callable[[Array], float], directions: Array) -> float:
        """Largest change of `number` if the values of the reference change by their half-widths.

        `number` is a function of these values (n). `directions` (n, from −1 to 1) are factors on
        the half-widths. The values under the other interpretations also count as changes.

        Shapes: n designs.
        """
        nominal = number(self.reference)
        return max(
            abs(number(values * np.exp(sign * directions * self.uncertainties[name])) - nominal)
            for name, values in self.references.items()
            for sign in (-1.0, 0.0, 1.0)
        )


def choice(values: Array, reference: Array, objective: Objective) -> Choice:
    """Design that a model chooses by its `values` (n), and its loss by the `reference` (n).

    Shapes: n designs.
    """
    candidates, relative_losses = equally_good(values, objective), losses(reference, objective)
    design = int(candidates[np.argmin(relative_losses[candidates])])
    return Choice(design, tuple(candidates.tolist()), float(relative_losses[design]))


def equally_good(values: Array, objective: Objective) -> NDArray[np.intp]:
    """Ascending indices of the best designs: those within `INDIFFERENT` of the best value."""
    costs = values if objective == "deflection" else -values
    lowest = costs.min()
    return np.flatnonzero(costs <= lowest + INDIFFERENT * abs(lowest))


def losses(reference: Array, objective: Objective) -> Array:
    """Relative loss (n) of each design by the reference: 0.02 if it is 2 % worse than the best.

    For deflections, the ratio to the smallest minus 1. For frequencies, 1 minus the ratio to the
    largest. Shapes: n designs.
    """
    if objective == "deflection":
        return np.asarray(reference / reference.min() - 1.0)
    return np.asarray(1.0 - reference / reference.max())


def spearman(first: Array, second: Array) -> float:
    """Rank correlation (Spearman's ρ, −1 to 1) of two sets of values (n) of the designs.

    Designs of equal value share their mean rank. NaN if all values of one set are equal.
    Shapes: n designs.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.corrcoef(_ranks(first), _ranks(second))[0, 1])


def _ranks(values: Array) -> Array:
    """Ranks (n) from 0.

    Values within `INDIFFERENT` of the next smaller one share their mean rank. Shapes: n designs.
    """
    order = np.argsort(values, kind="stable")
    ascending, ties = values[order], np.zeros(len(values), dtype=int)
    ties[order[1:]] = np.cumsum(np.diff(ascending) > INDIFFERENT * np.abs(ascending[1:]))
    return np.asarray(scipy.stats.rankdata(ties) - 1.0)
