"""A robot as it is judged: by which models, in which postures, and what computes their answers.

The answers are each kind of robot's own; what they are held against, and how one climbs there from
a model, is the same for all of them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import LegSprings
from validation.adequacy.matrix import Coordinate
from validation.adequacy.models import JudgedModel
from validation.adequacy.response import Vibration
from validation.adequacy.subject.given_masses import Masses
from validation.context import Context
from validation.models.options import ModelName, ModelOptions

# Tip compliances (6×6, SI, leg axes), and how ends are held, by body.
Springs: TypeAlias = Mapping[str, Array]
Holds: TypeAlias = Mapping[str, Ends]
# Which of the two meshes of solid legs.
Fineness: TypeAlias = Literal["coarse", "fine"]


@dataclass(frozen=True)
class Open:
    """What a robot file leaves open of how ends and interfaces are held.

    `what` in words, `says` what would settle it, both empty where all is said; `holds`: ends of
    every leg and of every part by the name of the alternative ("free" ones of parts averaged).
    """

    what: str
    says: str
    holds: Mapping[str, Holds]


@dataclass(frozen=True, eq=False)
class Legs:
    """The legs by body and what is open of their ends; `parts`: the mechanism, where it has some.

    `title` says what robots of them are.
    """

    context: Context
    title: str
    legs: Mapping[str, Leg]
    open: Open
    parts: Mechanism | None

    @property
    def prisms(self) -> list[ConstantLeg]:
        """The legs that are solids in the reference."""
        return [leg for leg in self.legs.values() if isinstance(leg, ConstantLeg)]

    @property
    def given(self) -> bool:
        """Whether any leg is known by its 6×6 alone."""
        return any(isinstance(leg, GivenLeg) for leg in self.legs.values())


@dataclass(frozen=True, eq=False)
class Statics(Legs):
    """What computes compliances (p×6×6, SI) in the postures.

    `answer` of a model, `unanswered` why one cannot answer at all, or ""; `assembled` of the legs'
    tips, with parts held so and on that rung of their meshes; `climbed` of the legs' springs, by
    the code of the model that `climbs` names, which is the assembler's only where legs are no
    serial chains; `tips` of the legs as given or equivalent. `rigid` says what is so in the
    simplified model, `computed_by` what the reference comes from. `digits`: what the printed digits
    of the robot file leave open (p×7, relative, 95 %), None where they are not in question.
    """

    answer: Callable[[ModelName, ModelOptions], Array]
    unanswered: Callable[[ModelName, ModelOptions], str]
    assembled: Callable[[Springs, Holds, int], Array]
    climbed: Callable[[Springs], Array]
    climbs: Literal["vjm", "links", ""]
    tips: Callable[[LegSprings], Springs]
    rigid: str
    computed_by: tuple[str, ...]
    digits: Callable[[], Array] | None = None


@dataclass(frozen=True, eq=False)
class Dynamics(Legs):
    """What computes natural modes in the postures, sampled with `weights` (k, kg); some are judged.

    `answer` of a model, None where nothing has mass; `solid` of solid legs on one of two meshes,
    whose sizes are as `ratio`, held so, given legs with such masses, and parts on that rung of
    theirs; `own` by beams of the sections' own constants, with warping where ends are
    held; `sections` by such beams held so, of constants from the solids' section mesh and from a
    finer one.
    """

    judged: int
    weights: Array
    ratio: float
    answer: Callable[[ModelName, ModelOptions], Vibration | None]
    solid: Callable[[Fineness, Holds, Masses | None, int], Vibration]
    own: Callable[[Holds | None], Vibration]
    sections: Callable[[Holds | None], tuple[Vibration, Vibration]]
    rigid: str
    computed_by: str


@dataclass(frozen=True, eq=False)
class Posed:
    """A robot in the postures of `poses` (p×n), and the models that are judged by name.

    `rigid` says why there are zeros in the simplified model's compliance, `middle` where the middle
    posture is; `equivalent` are the statics of a robot of given legs on equivalent ones.
    """

    name: str
    coordinates: tuple[Coordinate, ...]
    poses: Array
    models: Mapping[str, JudgedModel]
    statics: Statics
    dynamics: Dynamics
    equivalent: Statics | None
    rigid: str
    middle: str
    computed_by: str
    notes: tuple[str, ...] = ()
