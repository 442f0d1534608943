"""What value and reference of a comparison rest on, heard while they are computed.

A case takes its expensive results from the memo of its context, one entry for each of its sides.
Which functions of the project make an entry is heard while it is made. Which side an entry belongs
to is tried: each of its numbers is disturbed by itself, and what then moves rests on it. What both
sides rest on is left; the robot's data, meshes and the algebra of small matrices are named basics.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import islice
from types import FrameType
from typing import Any, ParamSpec, TypeVar

import numpy as np

from lumped.caches import forget
from lumped.errors import ComputationError
from lumped.robot_file import RobotFile
from validation.case import Case, Measurement, Skip
from validation.context import Context, Preset, memo_key

P = ParamSpec("P")
T = TypeVar("T")

# Shared by right: data, geometry, meshes, small algebra; comparing itself.
BASICS: Mapping[str, str] = {
    "lumped.arrays": "types",
    "lumped.caches": "keeping what was computed",
    "lumped.errors": "messages",
    "lumped.acceptance": "what is asked",
    "lumped.robot_file": "reading the file",
    "lumped.legs": "the legs' data",
    "lumped.sections": "the legs' data",
    "lumped.biglide": "the robot's data and its postures",
    "lumped.mechanism.body": "the mechanism's data",
    "lumped.mechanism.joint": "the mechanism's data",
    "lumped.mechanism.mechanism": "the mechanism's data",
    "lumped.mechanism.placing": "the mechanism's data",
    "lumped.mechanism.free_twists": "where joints are and what their kinds let free; polynomials "
    "have a list of their own",
    "lumped.mechanism.kinematics": "postures, of which polynomials measure that they close",
    "lumped.models.bodies": "the legs' data",
    "lumped.screws": "moving and turning twists",
    "fem.couplings.end_coupling:rigid_motions": "moving the nodes of a face",
    "lumped.dense.modes": "eigenvalues of small dense matrices",
    "meshes": "one mesh for both",
    "validation": "asking and comparing",
}
# Of named basics what is a way of its own to a number.
_OWN = (
    "validation.studies.ritz",
    "lumped.legs:tip_compliance",
    "lumped.models.bodies:tip_compliances",
)
# A number disturbed by this share, so little that no other pose or mode is farthest off for it; a
# side moves if it does by more than this. What is not disturbed is the same to the last bit.
_DISTURBED, _MOVED = 1e-9, 1e-13
# The packages of this program.
_FLOORS = ("lumped", "meshes", "fem", "validation")
# Arrays of one entry that are tried.
_TRIED = 60
# What both sides are about: the robot's data and its postures.
DATA = ("lumped.legs.equivalent_leg ", "validation.adequacy.mechanism.path._postures ")


@dataclass(frozen=True)
class Independence:
    """Functions ("module:function") that the value and the reference of a case rest on."""

    case: Case
    value: frozenset[str]
    reference: frozenset[str]

    @property
    def independent(self) -> bool:
        """Whether both sides are told, and share named basics alone."""
        return bool(self.value and self.reference and not self.shared)

    @property
    def shared(self) -> frozenset[str]:
        """What both rest on beyond the named basics."""
        return frozenset(one for one in self.value & self.reference if not is_basic(one))


@dataclass(frozen=True)
class Asked(Context):
    """A context that notes which entries of its memo are asked for, and lets one be exchanged."""

    asked: set[str] = field(default_factory=set, repr=False, compare=False)

    def get(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """As that of a context."""
        self.asked.add(memo_key(function, args, kwargs))
        return super().get(function, *args, **kwargs)

    def with_other(self, key: str, value: object) -> Context:
        """A plain context with one entry exchanged."""
        return Context(self.robot_file, self.preset, self.options, {**self._memo, key: value})

    def entry(self, key: str) -> object:
        """What the memo holds."""
        return self._memo[key]


@dataclass(frozen=True)
class Watched(Asked):
    """A context that hears which functions make its memo's entries, too."""

    made_by: dict[str, set[str]] = field(default_factory=dict, repr=False, compare=False)

    def get(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """As that of a context."""
        key = memo_key(function, args, kwargs)
        if key in self._memo:
            return super().get(function, *args, **kwargs)
        # What another entry left in a cache would not be heard.
        forget()
        with _heard(self.made_by.setdefault(key, set())):
            return super().get(function, *args, **kwargs)


def is_basic(function: str) -> bool:
    """Whether a function ("module:function") belongs to a named basic."""
    return any(_is_of(function, basic) for basic in BASICS) and not any(
        _is_of(function, own) for own in _OWN
    )


def _is_of(function: str, named: str) -> bool:
    """Whether it is the function, or in the module or room, of that name."""
    return function == named or function.startswith((f"{named}:", f"{named}."))


def independence(
    cases: Sequence[Case], robot_file: RobotFile, preset: Preset
) -> list[Independence]:
    """What the cases rest on; cases that are skipped here are left out."""
    context = Watched(robot_file, preset)
    found = []
    for case in cases:
        with suppress(Skip):
            found.append(_of_case(case, context))
    return found


def _of_case(case: Case, context: Watched) -> Independence:
    context.asked.clear()
    sound = case.measure(context)
    sides: tuple[set[str], set[str]] = set(), set()
    for key in sorted(key for key in context.asked if not key.startswith(DATA)):
        for moved, side in zip(_moved(case, context, key, sound), sides, strict=True):
            side.update(context.made_by.get(key, set()) if moved else ())
    return Independence(case, frozenset(sides[0]), frozenset(sides[1]))


def _moved(case: Case, context: Watched, key: str, sound: Measurement) -> tuple[bool, bool]:
    """Whether value and reference (or an allowance) rest on an entry of the memo."""
    value = reference = False
    for other in islice(disturbed(context.entry(key)), _TRIED):
        with suppress(Skip, ComputationError, ValueError):
            wrong = case.measure(context.with_other(key, other))
            if wrong.pose != sound.pose:
                # Another pose is farthest off now, which moves both numbers.
                continue
            value |= _differs(wrong.value, sound.value)
            reference |= _differs(wrong.reference, sound.reference) or any(
                _differs(one.amount, two.amount)
                for one, two in zip(wrong.allowances, sound.allowances, strict=True)
            )
    return value, reference


def _differs(one: float, two: float) -> bool:
    return abs(one - two) > _MOVED * max(abs(one), abs(two))


def disturbed(value: Any, share: float = _DISTURBED) -> Iterator[Any]:
    """The value with one of its arrays or numbers larger by `share`, each in turn."""
    if isinstance(value, float | np.floating):
        yield value * (1.0 + share)
    elif isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and value.size:
            yield value * (1.0 + share)
    elif isinstance(value, dict):
        for key in value:
            yield from ({**value, key: other} for other in disturbed(value[key], share))
    elif type(value) in (tuple, list):
        for place, item in enumerate(value):
            for other in disturbed(item, share):
                yield type(value)([*value[:place], other, *value[place + 1 :]])
    elif is_dataclass(value) and not isinstance(value, type):
        for name in (one.name for one in fields(value) if one.init):
            for other in disturbed(getattr(value, name), share):
                yield replace(value, **{name: other})


@contextmanager
def _heard(functions: set[str]) -> Iterator[None]:
    """The project's functions that are called, as "module:function"."""

    def listen(frame: FrameType, event: str, _argument: object) -> None:
        if event == "call":
            module = frame.f_globals.get("__name__", "")
            if module.partition(".")[0] in _FLOORS:
                functions.add(f"{module}:{frame.f_code.co_name}")

    former = sys.getprofile()
    sys.setprofile(listen)
    try:
        yield
    finally:
        sys.setprofile(former)
