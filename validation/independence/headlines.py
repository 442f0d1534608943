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


@dataclass(frozen=True)
class HeadlineNumber:
    """A `number`, where it is `shown`, and the `name` by which cases say that they compare it.

    `model` is that of the matrix, empty for a reference and the paper's table; `static` tells
    compliances from frequencies. `calculix`: what is independent of it is CalculiX.
    """

    name: str
    shown: str
    number: str
    model: str = ""
    static: bool = True
    calculix: bool = False

    def is_compared_by(self, case: Case) -> bool:
        """Whether a case is about this number."""
        return self.name in case.headlines


def headline_numbers(robot_file: RobotFile) -> tuple[HeadlineNumber, ...]:
    """All of them for a robot."""
    if robot_file.is_mechanism:
        return tuple(_of_mechanism(robot_file.mechanism))
    return (*_of_biglide(), *_of_legs(), *_of_paper())


def _of_biglide() -> Iterator[HeadlineNumber]:
    for model, (kind, _, _) in subject.CANDIDATES.items():
        yield from _of_model(model, dynamic=kind not in STATIC)
    yield HeadlineNumber(
        "robot.statics.own", _SCREEN, f"{_STATICS} of the reference: legs by their own 6×6"
    )
    yield HeadlineNumber(
        "robot.frequencies.own",
        _SCREEN,
        "frequencies of the reference: legs by their own 6×6, plausible masses",
        static=False,
    )
    yield from _of_solids()


def _of_model(model: str, *, dynamic: bool) -> Iterator[HeadlineNumber]:
    yield HeadlineNumber(f"robot.statics.{model}", _SCREEN, f"{_STATICS} by {model}", model)
    if dynamic:
        yield HeadlineNumber(
            f"robot.frequencies.{model}", _SCREEN, f"frequencies by {model}", model, static=False
        )


def _of_solids() -> Iterator[HeadlineNumber]:
    for what, number in (("statics", _STATICS), ("frequencies", "frequencies")):
        yield HeadlineNumber(
            f"robot.{what}.solid",
            _SCREEN,
            f"{number} of the reference: solid legs",
            static=number == _STATICS,
            calculix=True,
        )


def _of_legs() -> Iterator[HeadlineNumber]:
    for number in (1, 2):
        shown = f"{_SCREEN}, leg {number} alone"
        for model in leg.MODELS:
            yield HeadlineNumber(
                f"leg{number}.statics.{model}", shown, f"{_STATICS} by {model}", model
            )
        yield HeadlineNumber(
            f"leg{number}.statics.solid",
            shown,
            f"{_STATICS} of the reference: a solid",
            calculix=True,
        )


def _of_paper() -> Iterator[HeadlineNumber]:
    for name, number in (
        ("paper.simplified", "simplified model: largest deflection, frequencies"),
        ("paper.vjm", "virtual joints: deflections, legs as printed and equivalent ones"),
        ("paper.segments", "segments: frequencies, as corrected"),
        ("paper.printed", "segments: frequencies, eq. (25) as printed"),
        ("paper.leg1", "leg 1 alone: frequencies in segments"),
    ):
        yield HeadlineNumber(name, _PAPER, number)


def _of_mechanism(mechanism: Mechanism) -> Iterator[HeadlineNumber]:
    for model, (kind, _, _) in mechanism_candidates(mechanism).items():
        yield from _of_model(model, dynamic=kind not in STATIC)
    yield from _of_solids()
