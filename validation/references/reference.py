"""Data records: a reference, its uncertainty by source, and the steps from a model to it.

A `Reference` is the most accurate model of a robot, with one `Interpretation` for each meaning that
the robot file leaves possible. Each interpretation has a `Budget`: half-widths by `Source`. A
`Step` is an intermediate model that removes one cause of a judged model's error. A `Subject`
combines all of this for one robot, which `validation.adequacy` then judges.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

import numpy as np

from lumped.acceptance.quantities import Quantity, QuantityKind
from lumped.arrays import Array
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Factors, Reading
from validation.verdicts import Coordinate

# Remedy if a load changes the stiffness noticeably: models and references are linear.
SAY_LINEAR = (
    "needs a geometrically nonlinear model: the load changes the stiffness, and all models "
    "here are linear"
)


class Source(StrEnum):
    """Sources of uncertainty of a reference. The values are the names in results and reports.

    `remedy`: reason for an undecided verdict if this source has the largest half-width, with what
    would decide it. "" if that depends on the reference; `reason_of` then has the instruction.
    """

    remedy: str

    def __new__(cls, name: str, remedy: str = "") -> "Source":
        """Source with a name and a `remedy`, from the value of a member."""
        source = str.__new__(cls, name)
        source._value_ = name
        source.remedy = remedy
        return source

    MESHES = "meshes"
    DIGITS = (
        "digits of the file",
        "specify the 6×6 compliance in the robot file with more digits",
    )
    PAIRING = (
        "modes with mixed shapes",
        "mode shapes of nearly equal frequency mix, so that their pairing is ambiguous",
    )
    # Distribution of mass and stiffness along legs that are specified by their 6×6 only.
    MASSES = "mass distribution of the legs"
    INTERIOR = "stiffness distribution of the legs"
    LINEARITY = "geometric stiffness due to the load", SAY_LINEAR


@dataclass(frozen=True)
class Remedy:
    """Change of a model or of its options that removes a cause of error; `text` is the instruction.

    `model` is the model to use instead; remedies listed before it then do not apply. `option` is
    the option of the command line to be changed; of two remedies with the same option the later
    applies. Both are "" if there is no such model or option.
    """

    text: str
    option: str = ""
    model: str = ""


def use(model: str, how: str = "", option: str = "") -> Remedy:
    """Remedy that replaces the judged model by `model`.

    `how` is a text on the `option` of that model, such as "with free ends".
    """
    return Remedy(f"use {model}{how}", option, model)


# The model "solid" of the command `solve` equals a reference made of solids.
USE_SOLID = use("solid")
TIMOSHENKO = Remedy("include shear deformation: --theory timoshenko", "--theory")


@dataclass(frozen=True, eq=False)
class SourceHalfWidths:
    """Half-widths (95 %) of a reference's results due to one source, relative to these results.

    `displacements` (P×(7+L)): of the displacements under 7 unit loads and L loads of the robot
    file, in the columns of `Quantity.static_column`. `frequencies` (P×K), `peaks` (P×q) and
    `receptances` (one P×n for each excitation) are half-widths of the fields of `PathModes` with
    these names. A field is None if the source does not affect the numbers of this field. Array
    sizes: P poses, K judged frequencies, q judged quantities of harmonic responses, n frequencies
    of an excitation.
    """

    displacements: Array | None = None
    frequencies: Array | None = None
    peaks: Array | None = None
    receptances: Sequence[Array] = ()

    def of(self, quantity: Quantity) -> Array | None:
        """Half-widths (P) of a quantity in all poses. None if the source does not affect it.

        Array sizes: P poses.
        """
        if quantity.static:
            values, column = self.displacements, quantity.static_column
        else:
            frequency = quantity.kind is QuantityKind.FREQUENCY
            values, column = self.frequencies if frequency else self.peaks, quantity.column
        return None if values is None else np.asarray(values[:, column])


# Half-widths by source of uncertainty. Their sum is the half-width of the reference.
Budget: TypeAlias = Mapping[Source, SourceHalfWidths]


@dataclass(frozen=True, eq=False)
class Interpretation:
    """One reading of the robot file for which the reference is solved, and its uncertainty."""

    name: str
    reading: Reading
    budget: Budget = field(default_factory=dict)

    def frequency_half_widths(self, count: int) -> Array | None:
        """Half-widths (P×`count`) of the first frequencies, summed over all sources.

        None if no source affects frequencies.
        """
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
    """Most accurate model of a robot, under each interpretation that the robot file allows.

    `open`: text on the information that the robot file lacks; `decides`: instruction to add this
    information. Further instructions: `masses`, to add the mass distribution, if loads act on
    masses; `interior`, to add the stiffness inside legs; `finer`, to reduce the uncertainty.
    `remedy`: replacement of a judged model by that of the reference, None if no model of the
    program equals it. `supposed`: text on the range that the interpretations are assumed to cover,
    "" if nothing is assumed. `computed_by`: names of the functions that compute the reference. If
    `model` is None there is no reference, and `decides` is the reason.
    """

    title: str
    model: Model | None = None
    interpretations: Sequence[Interpretation] = ()
    open: str = ""
    decides: str = ""
    masses: str = ""
    interior: str = ""
    finer: str = "undecided because of the mesh uncertainty of the reference; refine its meshes"
    remedy: Remedy | None = None
    supposed: str = ""
    computed_by: tuple[str, ...] = ()

    @property
    def by_interior(self) -> list[list[int]]:
        """Indices of interpretations, grouped if only the stiffness inside the legs differs."""
        groups: dict[Reading, list[int]] = {}
        for index, interpretation in enumerate(self.interpretations):
            groups.setdefault(interpretation.reading.restricted(("ends", "masses")), []).append(
                index
            )
        return list(groups.values())


def no_reference(error: Exception | str) -> Reference:
    """Record for a robot that has no reference; `decides` is the reason."""
    return Reference("none", decides=f"no reference: {error}")


def finer_by(preset: str) -> str:
    """Instruction that reduces the uncertainty of a reference.

    `preset`: text on the preset with finer meshes: "--preset fine", or "no preset" if there is
    none.
    """
    return f"undecided because of the mesh uncertainty of the reference; {preset} has a finer one"


NOT_FINER = finer_by("no preset")


@dataclass(frozen=True, eq=False)
class Step:
    """One step from a judged model towards the reference: a model that lacks one `cause` of error.

    `model` has neither this cause nor those of all earlier steps. `source`: text on the computation
    that evaluates the effect of the cause. `remedy`: option or model that avoids the cause, None if
    there is none.
    """

    cause: str
    source: str
    model: Model
    remedy: Remedy | None = None


# Steps of each judged model, by its name.
Steps: TypeAlias = dict[str, Sequence[Step]]


@dataclass(frozen=True, eq=False)
class Subject:
    """Data for judging the models of one robot: models, references and the steps between them.

    `poses` (P×n) are values of the n `coordinates`. `notes` are remarks for the report. `parts`:
    each leg as a subject of its own, clamped at its root. `formulation`: if legs of the robot are
    specified by their 6×6 compliance, a subject with equivalent prisms, on which the formulations
    are judged against solids; otherwise None. `inputs`: uncertain inputs, None if the file names
    none. `loads` and `harmonics`: quantities of the file's loads and of its harmonic responses, in
    order. `faults`: names of computations (other than models) that failed by an error of the
    program. Array sizes: P poses.
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
        """Steps from a judged model to the reference of a quantity."""
        steps = self.static_steps if quantity.static else self.modal_steps
        return steps.get(model.name, ())

    def reference(self, quantity: Quantity) -> Reference:
        """Reference by which a quantity is judged: that of the statics or of the modes."""
        return self.statics if quantity.static else self.dynamics


@dataclass(frozen=True, eq=False)
class InputUncertainties:
    """Uncertain inputs of a robot, and the combinations of changed inputs for which it is solved.

    `relative`: relative standard uncertainty of each input by its key. `draws` (c×k): c random
    samples of all k inputs together, in units of their standard uncertainties.
    """

    relative: Mapping[str, float]
    draws: Array

    def alone(self, direction: int) -> list[Factors]:
        """Relative changes of the inputs, one input at a time by one standard uncertainty.

        `direction` is 1 for an increase and −1 for a decrease.
        """
        return [((key, direction * share),) for key, share in self.relative.items()]

    @property
    def together(self) -> list[Factors]:
        """Relative changes of all inputs at once, one set for each random sample."""
        return [
            tuple((key, share * draw) for (key, share), draw in zip(shares, row, strict=True))
            for shares in [self.relative.items()]
            for row in self.draws.tolist()
        ]
