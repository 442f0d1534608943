"""References of a robot with their uncertainty, and steps that lead from models to them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple, TypeAlias

import numpy as np

from lumped.acceptance.quantities import Quantity, QuantityKind
from lumped.arrays import Array
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Factors, Reading
from validation.verdicts import Coordinate

# Remedy against linear models and references.
SAY_LINEAR = "needs large displacements: the load changes the stiffness, all models are linear"


class Source(StrEnum):
    """Sources of uncertainty, by their names in results."""

    MESHES = "meshes"
    DIGITS = "digits of the file"
    PAIRING = "modes whose shapes mix"
    # Mass and stiffness inside legs known by their 6×6.
    MASSES = "where the legs' mass lies"
    INTERIOR = "how stiff the legs are between their ends"
    LINEARITY = "stiffness that the load takes or adds"


@dataclass(frozen=True)
class Remedy:
    """Change of the model, or of an option, that removes a cause of an error; `text` states it.

    `model`: the model to use instead, with which all remedies before are void. `option`: the option
    of the command line, of which a later value replaces an earlier one. "" if there is none.
    """

    text: str
    option: str = ""
    model: str = ""

    def formatted(self, **words: str) -> "Remedy":
        """The remedy with `words` in place of their names in braces."""
        return Remedy(self.text.format(**words), self.option, self.model.format(**words))


def use(model: str, how: str = "", option: str = "") -> Remedy:
    """Remedy that replaces the model, with an `option` stated by `how`."""
    return Remedy(f"use {model}{how}", option, model)


# The solid model of `solve` computes the same as a reference of solids.
USE_SOLID = use("solid")
TIMOSHENKO = Remedy("take Timoshenko's beams: --theory timoshenko", "--theory")


@dataclass(frozen=True, eq=False)
class HalfWidths:
    """Half-widths (95 %) of a reference due to one source, relative to its numbers.

    `displacements` (P×(7+L)): of the displacement that each static quantity is of, columns as
    `Quantity.static_column`. `frequencies` (P×K), `peaks` (P×q) and `receptances` (P×n each) of
    the modes. None if the source does not change them.
    """

    displacements: Array | None = None
    frequencies: Array | None = None
    peaks: Array | None = None
    receptances: Sequence[Array] = ()

    def of(self, quantity: Quantity) -> Array | None:
        """Half-widths (P) of a quantity. None if the source does not change it."""
        if quantity.static:
            values, column = self.displacements, quantity.static_column
        else:
            frequency = quantity.kind is QuantityKind.FREQUENCY
            values, column = self.frequencies if frequency else self.peaks, quantity.column
        return None if values is None else np.asarray(values[:, column])


# Half-widths by their source; linear sums of them are the half-width of the whole.
Budget: TypeAlias = Mapping[Source, HalfWidths]


@dataclass(frozen=True, eq=False)
class Interpretation:
    """Reading of the robot file that the reference is solved under, with its uncertainty."""

    name: str
    reading: Reading
    budget: Budget = field(default_factory=dict)

    def frequency_half_widths(self, count: int) -> Array | None:
        """Half-widths (P×`count`) of the first frequencies by all sources. None without any."""
        by_source = [
            half_widths.frequencies
            for half_widths in self.budget.values()
            if half_widths.frequencies is not None
        ]
        return (
            np.asarray(np.sum([half_widths[:, :count] for half_widths in by_source], axis=0))
            if by_source
            else None
        )


@dataclass(frozen=True, eq=False)
class Reference:
    """Most accurate model of a robot, under all `interpretations` of what its file leaves open.

    `open`: name of the information missing in the file. Instructions: `decides` supplies this
    information, `masses` that for loads on the legs' masses, `interior` that for the stiffness
    inside legs, and `finer` makes the reference more certain. `remedy`
    replaces a model by the reference's. None if there is none.
    `supposed`: range that the interpretations are assumed to cover. "" if nothing is assumed.
    Without a model there is no reference, and `decides` is the reason.
    """

    title: str
    model: Model | None = None
    interpretations: Sequence[Interpretation] = ()
    open: str = ""
    decides: str = ""
    masses: str = ""
    interior: str = ""
    finer: str = "needs a finer reference"
    remedy: Remedy | None = None
    supposed: str = ""
    computed_by: tuple[str, ...] = ()

    @property
    def by_interior(self) -> list[list[int]]:
        """Numbers of the interpretations that differ in the stiffness inside the legs alone."""
        rows: dict[Reading, list[int]] = {}
        for number, interpretation in enumerate(self.interpretations):
            rows.setdefault(interpretation.reading.restricted(("ends", "masses")), []).append(
                number
            )
        return list(rows.values())


def no_reference(error: Exception | str) -> Reference:
    """Reference of a robot without one, with the reason."""
    return Reference("none", decides=f"no reference: {error}")


def finer_by(preset: str) -> str:
    """Instruction that makes a reference finer, by "--preset fine" or "no preset"."""
    return f"needs a finer reference: {preset} computes one"


NOT_FINER = finer_by("no preset")


@dataclass(frozen=True, eq=False)
class Step:
    """Step from a model towards the reference that removes one cause and keeps the others.

    `model` has neither this cause nor those of the steps before. `source`: computation that it
    comes from. `remedy`: change that takes the step. None if no option or model does.
    """

    cause: str
    source: str
    model: Model
    remedy: Remedy | None = None


class StepTexts(NamedTuple):
    """Cause, source and remedy of a step, with words in braces that depend on the robot."""

    cause: str
    source: str
    remedy: Remedy | None = None


# By name of the judged model.
Steps: TypeAlias = dict[str, Sequence[Step]]


def ladders(
    orders: Mapping[str, Sequence[str]],
    texts: Mapping[str, StepTexts],
    models: Mapping[str, Model],
    **words: str,
) -> Steps:
    """Steps by name of the judged model: those of its order that have one of the `models`.

    `texts` of each step contain `words` by their names.
    """
    steps = {
        name: Step(
            texts[name].cause.format(**words),
            texts[name].source.format(**words),
            model,
            remedy and remedy.formatted(**words),
        )
        for name, model in models.items()
        for remedy in [texts[name].remedy]
    }
    return {
        judged: tuple(steps[name] for name in names if name in steps)
        for judged, names in orders.items()
    }


@dataclass(frozen=True, eq=False)
class Subject:
    """A robot with its judged `models`, references, and steps between them.

    `poses` (P×n) in `coordinates`. `notes` as in `Matrix`. `parts`: each leg alone, root clamped.
    `formulation`: models on legs other than the robot's, compared with solids of the same legs.
    `inputs`: uncertain inputs. None if the file names none. `loads`: quantities of its loads.
    `harmonics`: quantities of its responses to harmonic forces, in their order. `faults`: names of
    computations, other than models, that failed by an error of the program.
    """

    robot: str
    coordinates: tuple[Coordinate, ...]
    poses: Array
    responses: Responses
    models: Sequence[Model]
    statics: Reference
    dynamics: Reference
    static_steps: Steps = field(default_factory=dict)
    modal_steps: Steps = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    parts: "tuple[Subject, ...]" = ()
    formulation: "Subject | None" = None
    inputs: "InputUncertainties | None" = None
    loads: tuple[Quantity, ...] = ()
    harmonics: tuple[Quantity, ...] = ()
    faults: tuple[str, ...] = ()

    def steps(self, model: Model, quantity: Quantity) -> Sequence[Step]:
        """Steps from a model to the reference of a quantity."""
        steps = self.static_steps if quantity.static else self.modal_steps
        return steps.get(model.name, ())

    def reference(self, quantity: Quantity) -> Reference:
        """Reference of a quantity."""
        return self.statics if quantity.static else self.dynamics


@dataclass(frozen=True, eq=False)
class InputUncertainties:
    """Uncertain inputs of a robot, and the perturbations of them under which it is solved.

    `relative`: standard uncertainties by the keys of the inputs. `draws` (c×k, in standard
    uncertainties) perturb all inputs at once.
    """

    relative: Mapping[str, float]
    draws: Array

    def alone(self, direction: int) -> list[Factors]:
        """Perturbations of one input each by a standard uncertainty, up (1) or down (−1)."""
        return [((key, direction * share),) for key, share in self.relative.items()]

    @property
    def together(self) -> list[Factors]:
        """Perturbations of all inputs at once, one for each draw."""
        return [
            tuple((key, share * draw) for (key, share), draw in zip(shares, row, strict=True))
            for shares in [self.relative.items()]
            for row in self.draws.tolist()
        ]
