"""The numbers that a reader takes away, and which comparisons are about each of them."""

from collections.abc import Iterator
from dataclasses import dataclass

from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import RobotFile
from validation.adequacy.biglide import leg, subject
from validation.adequacy.mechanism.subject import mechanism_candidates
from validation.case import Case
from validation.models.options import STATIC

_SCREEN = "first screen and summary"
_PAPER = "paper's table"
_STATICS = "deflections and rotations"
# What else is about the numbers of a model.
_ALSO_STATIC = {
    "vjm-equivalent": ("robot.anchor.vjm.",),
    "segments": ("robot.statics.segments-vjm.",),
    "beam": ("robot.anchor.beam.planar", "robot.anchor.beam.along", "robot.statics.beam-vjm."),
}
_ALSO_DYNAMIC = {
    "segments": ("robot.anchor.segments.frequency", "robot.frequency.segments-"),
    "beam": ("robot.anchor.beam.frequency",),
}


@dataclass(frozen=True)
class HeadlineNumber:
    """A `number`, where it is `shown`, and the beginnings of the ids of `cases` that compare it.

    `model` is that of the matrix, empty for a reference and the paper's table; `static` tells
    compliances from frequencies. `calculix`: what is independent of it is CalculiX.
    """

    shown: str
    number: str
    cases: tuple[str, ...]
    model: str = ""
    static: bool = True
    calculix: bool = False

    def is_compared_by(self, case: Case) -> bool:
        """Whether a case is about this number."""
        return case.id.startswith(self.cases)


def headline_numbers(robot_file: RobotFile) -> tuple[HeadlineNumber, ...]:
    """All of them for a robot."""
    if robot_file.is_mechanism:
        return tuple(_of_mechanism(robot_file.mechanism))
    return (*_of_biglide(), *_of_legs(), *_of_paper())


def _of_biglide() -> Iterator[HeadlineNumber]:
    for model, (kind, _, _) in subject.CANDIDATES.items():
        statics = (f"robot.anchor.statics[{model}, ", *_ALSO_STATIC.get(model, ()))
        yield HeadlineNumber(_SCREEN, f"{_STATICS} by {model}", statics, model)
        if kind not in STATIC:
            dynamics = (f"robot.anchor.frequencies[{model}, ", *_ALSO_DYNAMIC.get(model, ()))
            yield HeadlineNumber(_SCREEN, f"frequencies by {model}", dynamics, model, static=False)
    yield HeadlineNumber(
        _SCREEN,
        f"{_STATICS} of the reference: legs by their own 6×6",
        ("robot.anchor.own[",),
    )
    yield HeadlineNumber(
        _SCREEN,
        f"{_STATICS} of the reference: solid legs",
        ("robot.anchor.reference[", "robot.solid.statics-", "robot.solid.calculix.statics"),
        calculix=True,
    )
    yield HeadlineNumber(
        _SCREEN,
        "frequencies of the reference: legs by their own 6×6, plausible masses",
        ("robot.anchor.masses[",),
        static=False,
    )
    yield HeadlineNumber(
        _SCREEN,
        "frequencies of the reference: solid legs",
        ("robot.solid.calculix.frequencies", "robot.solid.frequency["),
        static=False,
        calculix=True,
    )


def _of_legs() -> Iterator[HeadlineNumber]:
    for number in (1, 2):
        for model in leg.MODELS:
            yield HeadlineNumber(
                f"{_SCREEN}, leg {number} alone",
                f"{_STATICS} by {model}",
                (f"leg{number}.anchor[{model}, ", f"leg{number}.compliance.{model}["),
                model,
            )
        yield HeadlineNumber(
            f"{_SCREEN}, leg {number} alone",
            f"{_STATICS} of the reference: a solid",
            (f"leg{number}.anchor.reference[", f"leg{number}.compliance.solid"),
            calculix=True,
        )


def _of_paper() -> Iterator[HeadlineNumber]:
    yield HeadlineNumber(
        _PAPER,
        "simplified model: largest deflection, frequencies",
        ("robot.anchor.simplified", "robot.anchor.frequencies[simplified, "),
    )
    yield HeadlineNumber(
        _PAPER,
        "virtual joints: deflections, legs as printed and equivalent ones",
        ("robot.anchor.statics[vjm, ", "robot.anchor.statics[vjm-equivalent, "),
    )
    yield HeadlineNumber(
        _PAPER, "segments: frequencies, as corrected", ("robot.anchor.segments.frequency",)
    )
    yield HeadlineNumber(
        _PAPER, "segments: frequencies, eq. (25) as printed", ("robot.anchor.printed.",)
    )
    yield HeadlineNumber(
        _PAPER, "leg 1 alone: frequencies in segments", ("leg1.frequency.segments[",)
    )


def _of_mechanism(mechanism: Mechanism) -> Iterator[HeadlineNumber]:
    for model, (kind, _, _) in mechanism_candidates(mechanism).items():
        own = {"simplified": ("mechanism.simplified",)}.get(model, (f"mechanism.statics.{model}",))
        yield HeadlineNumber(
            _SCREEN, f"{_STATICS} by {model}", (f"mechanism.anchor.statics[{model}, ", *own), model
        )
        if kind not in STATIC:
            others = {
                "simplified": ("mechanism.inertia",),
                "segments": ("mechanism.frequency.segments[",),
            }.get(model, ())
            yield HeadlineNumber(
                _SCREEN,
                f"frequencies by {model}",
                (f"mechanism.anchor.frequencies[{model}, ", *others),
                model,
                static=False,
            )
    yield HeadlineNumber(
        _SCREEN,
        f"{_STATICS} of the reference: solid legs",
        ("mechanism.calculix.statics", "mechanism.statics.solid"),
        calculix=True,
    )
    yield HeadlineNumber(
        _SCREEN,
        "frequencies of the reference: solid legs",
        ("mechanism.calculix.frequencies", "mechanism.reduction"),
        static=False,
        calculix=True,
    )
