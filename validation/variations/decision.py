"""Decisions by a model among n designs, and what they cost in the terms of a better one.

Whoever designs with a model asks little of its absolute numbers: its order of the designs must be
right, and its best design must be good. All tables of values here are arrays (n) over the designs.
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
# Of the best value: designs whose values are closer are equally good. Rounding and the error of a
# reduction to the ends are below it.
INDIFFERENT = 1e-6


@dataclass(frozen=True)
class Choice:
    """The number of the `design` that a model chooses, and its `loss` in the reference's terms.

    Of all designs that are `equally_good` to the model (in their order) it is the one that the
    reference finds best.
    """

    design: int
    equally_good: tuple[int, ...]
    loss: float


@dataclass(frozen=True, eq=False)
class Decision:
    """An objective of n designs (each number an array of n) by `models` and by a reference.

    `references` has it by every reading of what the robot file leaves open, by name, the first of
    which is told; `uncertainties` are their relative half-widths.
    """

    objective: Objective
    models: Mapping[str, Array]
    references: Mapping[str, Array]
    uncertainties: Mapping[str, Array]

    @property
    def reference(self) -> Array:
        """The reading that is told."""
        return next(iter(self.references.values()))

    @property
    def best(self) -> int:
        """The number of the design that the reference chooses."""
        return choice(self.reference, self.reference, self.objective).design

    def choice(self, model: str) -> Choice:
        """What a model chooses."""
        return choice(self.models[model], self.reference, self.objective)

    def loss_uncertainty(self, design: int) -> float:
        """What the reference leaves open of the loss at a design.

        Its uncertainty moves the design one way, and all others the other way.
        """
        apart = np.full(len(self.reference), -1.0)
        apart[design] = 1.0
        return self._left_open(lambda one: losses(one, self.objective)[design], apart)

    def correlation(self, model: str) -> tuple[float, float]:
        """Spearman's ρ of a model's order with the reference's, and what that leaves open.

        Its uncertainty moves each design by its rank: towards the model's order, and away from it.
        """
        own = self.models[model]
        ranks = _ranks(own)
        apart = ranks / max(ranks.max(), 1.0) * 2.0 - 1.0
        found = spearman(own, self.reference)
        return found, self._left_open(lambda one: spearman(own, one), apart)

    def _left_open(self, number: Callable[[Array], float], apart: Array) -> float:
        told = number(self.reference)
        return max(
            abs(number(values * np.exp(way * apart * self.uncertainties[name])) - told)
            for name, values in self.references.items()
            for way in (-1.0, 0.0, 1.0)
        )


def choice(values: Array, reference: Array, objective: Objective) -> Choice:
    """What a model chooses by its values; `reference` are those of a better one."""
    good, lost = equally_good(values, objective), losses(reference, objective)
    design = int(good[np.argmin(lost[good])])
    return Choice(design, tuple(good.tolist()), float(lost[design]))


def equally_good(values: Array, objective: Objective) -> NDArray[np.intp]:
    """Numbers of the designs that a model finds best, ascending: `INDIFFERENT` of each other."""
    better = values if objective == "deflection" else -values
    best = better.min()
    return np.flatnonzero(better <= best + INDIFFERENT * abs(best))


def losses(reference: Array, objective: Objective) -> Array:
    """Relative loss (n) of each design in the reference's terms: 0.02 for 2 % worse.

    Its deflection over the smallest, less 1; of frequencies 1 less the ratio to the largest.
    """
    if objective == "deflection":
        return np.asarray(reference / reference.min() - 1.0)
    return np.asarray(1.0 - reference / reference.max())


def spearman(one: Array, other: Array) -> float:
    """Rank correlation (Spearman's ρ, −1 to 1) of two orders of the designs.

    Designs equally good to one of them share their mean rank; NaN where all are.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.corrcoef(_ranks(one), _ranks(other))[0, 1])


def _ranks(values: Array) -> Array:
    """Mean ranks from 0; neighbours in order that are `INDIFFERENT` to each other share theirs."""
    order = np.argsort(values, kind="stable")
    ascending, ties = values[order], np.zeros(len(values), dtype=int)
    ties[order[1:]] = np.cumsum(np.diff(ascending) > INDIFFERENT * np.abs(ascending[1:]))
    counts = np.bincount(ties)
    return np.asarray((np.cumsum(counts) - 0.5 * (counts + 1.0))[ties])
