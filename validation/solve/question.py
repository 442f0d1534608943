"""What is asked of a robot: a model, its options, where, how many modes; and its faults."""

from dataclasses import dataclass
from typing import Any

from lumped.errors import InputError, each
from lumped.legs import GivenLeg
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from validation.kinematics.poses import parsed_pose
from validation.models.options import STATIC, ModelName, ModelOptions

# What each model listens to; anything else given on the command line is a fault.
OPTIONS: dict[ModelName, tuple[str, ...]] = {
    "simplified": (),
    "vjm": ("legs", "theory", "equivalent"),
    "links": ("legs", "theory", "equivalent"),
    "segments": ("theory", "elements", "release", "layout", "equivalent", "parts"),
    "beam": ("theory", "elements", "equivalent", "parts"),
    "solid": ("ends", "divisions", "equivalent", "reduction"),
}
# Models of elements, solved dense.
OF_ELEMENTS: tuple[ModelName, ...] = ("segments", "beam")
DEFAULT_MODES = 6
# What only parts from files listen to, and what says how a 6×6 becomes a leg of constant section.
_OF_PARTS = ("parts", "reduction")
_OF_GIVEN_LEGS = ("legs", "equivalent")


@dataclass(frozen=True, eq=False)
class Question:
    """A `model` of a mechanism in the typed `poses` ("0.25,0.6"), or of one `body`.

    In the reference posture without poses. `modes`: how many, None for six; `given` are the
    options that were typed. The modes are paired with those of `against`. `numbered`: the file is
    of schema 1, whose poses are positions x and whose bodies are legs by number. `text` of the
    file, whose printed digits are looked at; "" where they are not in question.
    """

    model: ModelName
    modes: int | None
    given: dict[str, Any]
    mechanism: Mechanism
    poses: tuple[str, ...] = ()
    body: str | None = None
    against: ModelName | None = None
    numbered: bool = False
    text: str = ""

    @property
    def count(self) -> int:
        """Number of frequencies."""
        asked = DEFAULT_MODES if self.modes is None else self.modes
        return 0 if self.model in STATIC else asked

    @property
    def options(self) -> ModelOptions:
        """The options of the model, defaults for those that were not typed."""
        return ModelOptions(**self.given)

    @property
    def listens(self) -> tuple[str, ...]:
        """Names of the options that have something to act on."""
        unheard = self._unheard()
        return tuple(name for name in self._allowed() if name not in unheard)

    def postures(self) -> list[Posture]:
        """The postures that are asked about."""
        typed = [parsed_pose(self.mechanism, text) for text in self.poses]
        return [posture(self.mechanism, pose) for pose in typed] or [
            reference_posture(self.mechanism)
        ]

    def faults(self) -> list[str]:
        """Everything that is wrong with the question, one line each."""
        found = [*self._option_faults(), *self._mode_faults()]
        if self.body is not None:
            found += self._body_faults(self.body)
        found += self._against_faults()

        def closed(text: str) -> Posture:
            return posture(self.mechanism, parsed_pose(self.mechanism, text))

        outside = each(closed, self.poses)[1]
        return found + [
            f"--x: {fault}" if self.numbered and not fault.startswith("--") else fault
            for fault in outside
        ]

    def _allowed(self) -> tuple[str, ...]:
        # Eq. (25) as printed is a statement about the paper's own kind of robot.
        return tuple(n for n in OPTIONS[self.model] if self.numbered or n != "release")

    def _option_faults(self) -> list[str]:
        """Options that the model does not take, that change nothing, or whose value is wrong.

        What is typed and would change nothing is refused: whoever typed it expects that it does.
        """
        allowed, unheard = self._allowed(), self._unheard()
        listed = ", ".join(f"--{name}" for name in allowed) or "none"
        faults = [
            f"--{name}: not an option of the {self.model} model here; it takes {listed}"
            for name in self.given
            if name not in allowed
        ]
        faults += [
            f"--{name} = {self.given[name]}: must be 1 or more"
            for name in ("elements", "divisions")
            if self.given.get(name, 1) < 1
        ]
        return faults + [
            f"--{name}: {unheard[name]}, so nothing would change; leave it out"
            for name in self.given
            if name in allowed and name in unheard
        ]

    def _unheard(self) -> dict[str, str]:
        """Options that have nothing to act on here, and why."""
        unheard: dict[str, str] = {}
        legs = {n: leg for n, leg in legs_of(self.mechanism).items() if self.body in (None, n)}
        given = [isinstance(leg, GivenLeg) for leg in legs.values()]
        if not self.mechanism.parts:
            unheard |= dict.fromkeys(_OF_PARTS, "no body of the robot is a part from a file")
            if not any(given):
                what = "no leg that is asked about is given by a 6×6"
                unheard |= dict.fromkeys(_OF_GIVEN_LEGS, what)
            elif self.model in STATIC and self.options.legs == "given":
                what = f"the {self.model} model takes the legs as they are given"
                names = ("theory", "equivalent") if all(given) else ("equivalent",)
                unheard |= dict.fromkeys(names, what)
        if self.body is not None:
            unheard["release"] = "a leg alone has no joint to release"
        return unheard

    def _mode_faults(self) -> list[str]:
        if self.modes is not None and self.modes < 0:
            return [f"--modes = {self.modes}: must be 0 or more"]
        if self.modes and self.model in STATIC:
            return [f"--modes: the {self.model} model is static and has no frequencies"]
        return []

    def _body_faults(self, body: str) -> list[str]:
        mechanism, names = self.mechanism, list(legs_of(self.mechanism))
        faults = []
        if body not in names:
            rigid = body in mechanism.bodies and body != GROUND
            what = "is rigid" if rigid else "no such body"
            if body in mechanism.parts:
                what = "is a part from a file, see flexproof identify ROBOT --body"
            faults.append(f"--body {body}: {what}; must be one of {', '.join(names)}")
        pose, one = ("--x", "--leg") if self.numbered else ("--pose", "--body")
        if self.poses:
            faults.append(f"{pose}: a body alone has no pose; leave out {pose} or {one}")
        if self.model == "simplified":
            faults.append(f"{one}: the bodies of the simplified model are rigid")
        return faults

    def _against_faults(self) -> list[str]:
        if self.against is None:
            return []
        if self.against in STATIC:
            return [f"--against {self.against}: the model is static and has no modes"]
        if self.model in STATIC or not self.count or self.body is not None:
            return ["--against: there are no modes of the mechanism to be paired"]
        return []


@dataclass(frozen=True, eq=False)
class Asked:
    """What is typed of a `model`, of whatever robot: the options `given`, and where it is solved.

    At positions `x` (m) or in `poses`, or one `leg` or `body` alone; `modes`: how many, None for
    six, to be paired with those of the model `against`.
    """

    model: ModelName
    given: dict[str, Any]
    modes: int | None = None
    x: tuple[float, ...] = ()
    poses: tuple[str, ...] = ()
    leg: int | None = None
    body: str | None = None
    against: ModelName | None = None

    def of(self, robot_file: RobotFile) -> Question:
        """The question about a robot; raises InputError where it has no such place."""
        numbered = robot_file.schema == 1
        faults = []
        if self.x and not numbered:
            faults.append("--x: poses of a mechanism are typed as --pose")
        if self.leg is not None and not numbered:
            faults.append("--leg: bodies of a mechanism have names; take --body")
        elif self.leg not in (None, 1, 2):
            faults.append(f"--leg = {self.leg}: must be 1 or 2")
        if faults:
            raise InputError(faults)
        return Question(
            self.model,
            self.modes,
            self.given,
            robot_file.mechanism,
            (*(repr(x) for x in self.x), *self.poses),
            self.body if self.leg is None else f"leg{self.leg}",
            self.against,
            numbered,
            robot_file.text,
        )
