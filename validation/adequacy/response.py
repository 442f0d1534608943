"""Subjects of a judgement: models with their responses, references, and steps between them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from lumped.acceptance.quantities import Quantity
from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from validation.agreement.responses import PathModes, Statics, Unsolved
from validation.case import failure_reason
from validation.verdicts import Coordinate

# What legs known by their 6×6 leave open.
OPEN_MASSES = "where the legs' mass lies"
OPEN_INTERIOR = "how stiff the legs are between their ends"
# What neither models nor references know, all linear, and what would.
OPEN_LINEAR = "stiffness that the load takes or adds"
SAY_LINEAR = "needs large displacements: the load changes the stiffness, all models are linear"


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
class Response:
    """Response of one model in P poses, in two halves that are solved independently.

    A half is None if the model does not define it: without masses there are no modes.
    """

    statics: Statics | Unsolved | None = None
    modes: PathModes | Unsolved | None = None

    @property
    def solved_statics(self) -> Statics | None:
        """The statics. None if they are not defined or not solved."""
        return self.statics if isinstance(self.statics, Statics) else None

    @property
    def solved_modes(self) -> PathModes | None:
        """The modes. None if they are not defined or not solved."""
        return self.modes if isinstance(self.modes, PathModes) else None

    @property
    def fault(self) -> bool:
        """True if a half ended with an error of the program."""
        halves = (self.statics, self.modes)
        return any(isinstance(half, Unsolved) and half.fault for half in halves)

    def half(self, quantity: Quantity) -> Statics | PathModes | Unsolved | None:
        """The half that a quantity belongs to."""
        return self.statics if quantity.static else self.modes

    def unsolved(self, quantity: Quantity) -> str:
        """Reason why a quantity of the model cannot be computed. "" if there is none."""
        half = self.half(quantity)
        return half.reason if isinstance(half, Unsolved) else ""


@dataclass(frozen=True, eq=False)
class Alternative:
    """The reference under one reading of what the user left open ("ends rigid", say).

    Relative numerical uncertainties (half-widths, 95 %): `static` (p×(7+l), of the displacement
    that each static quantity is of, then each load), `dynamic` (p×m, of the frequencies). `digits`,
    as `static`, and `dynamic_digits`, as `dynamic`: what the printed digits of the robot's 6×6
    leave open; `masses`, as `static`: what plausible places of the legs' masses do, `linear`, as
    `static`: what loads change of the stiffness that they meet. `responses`: what is left open of
    those. `ends`: the name of the end conditions alone; `others`: that of all but the stiffness
    inside legs known by their 6×6, by which alternatives of one such name differ.
    """

    name: str
    response: Response
    static: Array | None = None
    dynamic: Array | None = None
    digits: Array | None = None
    dynamic_digits: Array | None = None
    masses: Array | None = None
    linear: Array | None = None
    responses: "ResponsesLeftOpen | None" = None
    ends: str = ""
    others: str = ""


@dataclass(frozen=True, eq=False)
class ResponsesLeftOpen:
    """What a reference leaves open of responses, relative (half-widths, 95 %), shapes as there.

    Of what is judged of them by `meshes` and by `digits`, of the `receptances` by both.
    """

    meshes: Array
    digits: Array
    receptances: Sequence[Array]


@dataclass(frozen=True, eq=False)
class Reference:
    """The best there is for a robot: one or more alternatives, where the user left something open.

    `title` says what it is, `open` what was left open and `decides` what would settle it, `masses`
    that of loads on the legs' masses, `interior` that of the stiffness inside legs; `finer` what
    would make it more certain. `remedy` names the model that computes the same, None if there is
    none. `supposed`: what the alternatives are taken to cover, where nothing that could be computed
    would tell.
    """

    title: str
    alternatives: Sequence[Alternative]
    open: str = ""
    decides: str = ""
    masses: str = ""
    interior: str = ""
    finer: str = "needs a finer reference"
    remedy: Remedy | None = None
    supposed: str = ""
    computed_by: tuple[str, ...] = ()


def by_interior(reference: Reference) -> list[list[int]]:
    """Numbers of the alternatives that differ in the stiffness inside the legs alone."""
    rows: dict[str, list[int]] = {}
    for number, one in enumerate(reference.alternatives):
        rows.setdefault(one.others, []).append(number)
    return list(rows.values())


# What solids of a leg may end with: walls too thin to mesh, a material that they lose in rounding.
UNSOLVED = (InputError, ComputationError)


def statics_of(solve: Callable[[], Statics]) -> Statics | Unsolved:
    """Statics that `solve` returns, or the reason why there are none.

    Any exception is the failure of this model alone: the others are judged.
    """
    try:
        return solve()
    except UNSOLVED as error:
        return Unsolved(str(error))
    except Exception as error:  # noqa: BLE001  one model's failure is its own result
        return Unsolved(failure_reason("statics of a model", error), fault=True)


def modes_of(solve: Callable[[], PathModes | None]) -> PathModes | Unsolved | None:
    """Modes that `solve` returns, or the reason why there are none, as `statics_of`.

    None if nothing has mass.
    """
    try:
        return solve()
    except UNSOLVED as error:
        return Unsolved(str(error))
    except Exception as error:  # noqa: BLE001  one model's failure is its own result
        return Unsolved(failure_reason("modes of a model", error), fault=True)


def no_reference(error: Exception) -> Reference:
    """What there is where solids cannot be made of a leg: nothing is decided, and it says why."""
    return Reference("none", (), decides=f"no reference: {error}")


def finer_by(preset: str) -> str:
    """What would make a reference finer: "--preset fine", say, or "no preset"."""
    return f"needs a finer reference: {preset} computes one"


NOT_FINER = finer_by("no preset")


@dataclass(frozen=True, eq=False)
class Step:
    """A step from a model towards the reference: one cause removed, the others left.

    `responses` holds what the model answers after this step and all before it, by alternative of
    the reference; `remedy` takes it, None if no option or model does; `source` what it is computed
    from.
    """

    cause: str
    source: str
    responses: Mapping[str, Response]
    remedy: Remedy | None = None


class StepTexts(NamedTuple):
    """Cause, source and remedy of a step, with words in braces that depend on the robot."""

    cause: str
    source: str
    remedy: Remedy | None = None


def ladders(
    models: Mapping[str, Sequence[str]],
    texts: Mapping[str, StepTexts],
    responses: Mapping[str, Mapping[str, Response]],
    **words: str,
) -> dict[str, tuple[Step, ...]]:
    """Steps by model: in the order that `models` name them, those that have `responses`.

    `texts` of every step contain `words` by their names.
    """
    steps = {}
    for name, found in responses.items():
        cause, source, remedy = texts[name]
        steps[name] = Step(
            cause.format(**words),
            source.format(**words),
            found,
            remedy and remedy.formatted(**words),
        )
    return {
        model: tuple(steps[name] for name in names if name in steps)
        for model, names in models.items()
    }


@dataclass(frozen=True, eq=False)
class Candidate:
    """A model that a designer might use: what it answers and what leads from it to the truth.

    `steps` for static quantities and for frequencies; `rigid` says why zeros in the compliance are
    there, `silent` what it says nothing of.
    """

    model: str
    title: str
    response: Response
    static_steps: Sequence[Step] = ()
    dynamic_steps: Sequence[Step] = ()
    rigid: str = ""
    silent: str = ""
    computed_by: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Subject:
    """A robot with everything that its models are judged by.

    `poses` (p×n) in `coordinates`; `notes` as in `Matrix`;
    `parts` are its parts alone (each leg, root clamped), `formulation` the models whose legs are
    others than the robot's, held against solids of those; `inputs` the robot with uncertain inputs
    off, where its file names any. `loads` are the quantities of its own loads, `responses` those of
    its responses, in their order. `faults` name what else than a model ended with an error of the
    program.
    """

    robot: str
    coordinates: tuple[Coordinate, ...]
    poses: Array
    candidates: Sequence[Candidate]
    statics: Reference
    dynamics: Reference
    notes: tuple[str, ...] = ()
    parts: "tuple[Subject, ...]" = ()
    formulation: "Subject | None" = None
    inputs: "InputsOff | None" = None
    loads: tuple[Quantity, ...] = ()
    responses: tuple[Quantity, ...] = ()
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class InputOff:
    """The robot as it is judged with one input one standard uncertainty below and above.

    `key` of the input in the robot file, `relative` its standard uncertainty.
    """

    key: str
    relative: float
    below: Subject
    above: Subject


@dataclass(frozen=True, eq=False)
class InputsOff:
    """Robots with one uncertain input off each, and `together` (c) with all off by `draws` (c×k).

    `draws` in standard uncertainties, inputs in the order of `alone`.
    """

    alone: Sequence[InputOff]
    draws: Array
    together: Sequence[Subject]
