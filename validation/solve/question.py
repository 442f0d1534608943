"""Request to `solve`, with its checks: model, options, poses or body, number of modes.

Input: arguments of the command line or of Python. Output: postures and model options, or a list of
faults. Rule: an option that would change nothing is a fault.
"""

from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from typing import Any

from lumped.errors import collect_faults
from lumped.legs import GivenLeg, SectionedLeg
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from validation.kinematics.poses import parsed_pose
from validation.models.options import MODELS, STATIC, ModelName, ModelOptions
from validation.models.robot_bodies import sectioned_legs
from validation.uncertainty.refinement import accuracy_faults

DEFAULT_MODES = 6
# Largest number of modes. Beams get enough elements for them, and are solved dense.
_LARGEST_COUNT = 1000
# Options that affect CAD parts only, and options that affect legs known by a 6×6.
_OF_PARTS = ("parts", "reduction")
_OF_GIVEN_LEGS = ("legs", "equivalent")


def split_ends(model: ModelName, options: dict[str, Any]) -> tuple[dict[str, Any], bool]:
    """Options of a model for a leg, and True if the option `ends` is "free-free".

    "free-free" is removed from the options. For a solid, "free" replaces it: the end faces of the
    unsupported leg are free to warp.
    """
    if options.get("ends") != "free-free":
        return options, False
    remaining = {name: value for name, value in options.items() if name != "ends"}
    return remaining | ({"ends": "free"} if model == "solid" else {}), True


@dataclass(frozen=True, eq=False)
class Question:
    """A `model` of a robot, the options `given` by the user, and the poses or body to be solved.

    Positions `x` (m), or `poses` ("0.25,0.6"), or one `leg` or `body` alone; if none of these is
    set, the reference posture. `modes`: number of modes, None for six. `against`: another model,
    with whose modes those of `model` are paired. `digits`: True to add half-widths due to the
    printed digits of the 6×6. `accuracy`: largest relative half-width due to meshes of solids. A
    body alone is clamped at its first point, or unsupported if `free`.
    """

    robot_file: RobotFile
    model: ModelName
    given: dict[str, Any]
    modes: int | None = None
    x: tuple[float, ...] = ()
    poses: tuple[str, ...] = ()
    leg: int | None = None
    body: str | None = None
    against: ModelName | None = None
    digits: bool = True
    accuracy: float | None = None
    free: bool = False

    @property
    def mechanism(self) -> Mechanism:
        """Mechanism of the robot."""
        return self.robot_file.mechanism

    @cached_property
    def numbered(self) -> bool:
        """True for schema 1, in which poses are positions x and legs have numbers."""
        return self.robot_file.schema == 1

    @property
    def alone(self) -> str | None:
        """Name of the body that is solved without the robot. None for the whole robot."""
        return self.body if self.leg is None else f"leg{self.leg}"

    @property
    def count(self) -> int:
        """Number of frequencies. 0 for static models."""
        requested = DEFAULT_MODES if self.modes is None else self.modes
        return 0 if self.model in STATIC else requested

    @cached_property
    def options(self) -> ModelOptions:
        """Options of the model, with defaults for those not given."""
        return ModelOptions(**self.given)

    def with_divisions(self, divisions: int) -> "Question":
        """Copy of the question with these `divisions` of the mesh of prisms."""
        return replace(self, given={**self.given, "divisions": divisions})

    @property
    def effective_options(self) -> dict[str, Any]:
        """Options that affect the answer, with their values."""
        allowed, ignored = self._allowed(), self._ignored()
        return {
            name: value
            for name, value in asdict(self.options).items()
            if name in allowed and name not in ignored
        }

    @cached_property
    def legs(self) -> list[SectionedLeg]:
        """Distinct prisms of the answer: of several equal legs, the list contains one."""
        legs = sectioned_legs(self.mechanism, self.options)
        return list({leg: None for name, leg, _ in legs if self.alone in (None, name)})

    def postures(self) -> list[Posture]:
        """Postures of the given poses, or the reference posture."""
        mechanism = self.mechanism
        poses = [parsed_pose(mechanism, text) for text in self._typed]
        return [posture(mechanism, pose) for pose in poses] or [reference_posture(mechanism)]

    @property
    def _typed(self) -> tuple[str, ...]:
        return (*(repr(x) for x in self.x), *self.poses)

    def faults(self) -> list[str]:
        """Faults of the request, one line each."""
        if misplaced := self._place_faults():
            return misplaced
        faults = [*self._option_faults(), *self._mode_faults()]
        if self.accuracy is not None:
            faults += accuracy_faults(self.accuracy)
            if self.model != "solid":
                faults.append(
                    f"--accuracy: only for models with meshes, not for {self.model}; leave it out"
                )
        if self.alone is not None:
            faults += self._body_faults(self.alone)
        if self.free:
            faults += self._free_faults()
        poses, unreadable = collect_faults(partial(parsed_pose, self.mechanism), self._typed)
        _, unreachable = collect_faults(partial(posture, self.mechanism), poses)
        option = "--x: " if self.numbered else ""
        return [*faults, *unreadable, *(f"{option}{fault}" for fault in unreachable)]

    def _allowed(self) -> tuple[str, ...]:
        # Eq. (25) as printed is defined for the paper's kind of robot only.
        return tuple(n for n in MODELS[self.model].options if self.numbered or n != "release")

    def _place_faults(self) -> list[str]:
        """Faults due to poses or legs that a robot file of this schema cannot have."""
        faults = []
        if self.x and not self.numbered:
            faults.append("--x: only for robot files of schema 1; give poses as --pose")
        if self.leg is not None and not self.numbered:
            faults.append("--leg: only for robot files of schema 1; name a body with --body")
        elif self.leg not in (None, 1, 2):
            faults.append(f"--leg = {self.leg}: must be 1 or 2")
        elif self.leg is not None and self.body is not None:
            faults.append("--leg and --body: each names a body; leave out one of them")
        return faults

    def _option_faults(self) -> list[str]:
        """Faults of options: unknown to the model, without effect, or with a wrong value.

        An option that would change nothing is refused, because the user expects that it does.
        """
        allowed, ignored = self._allowed(), self._ignored()
        listed = ", ".join(f"--{name}" for name in allowed) or "none"
        faults = [
            (f"--{name}: has no effect on model {self.model} here; options of this model: {listed}")
            for name in self.given
            if name not in allowed
        ]
        faults += [
            f"--{name} = {self.given[name]}: must be a whole number of at least 1"
            for name in ("elements", "divisions")
            if self.given.get(name, 1) < 1
        ]
        return faults + [
            f"--{name}: no effect, because {ignored[name]}; leave it out"
            for name in self.given
            if name in allowed and name in ignored
        ]

    def _ignored(self) -> dict[str, str]:
        """Options without effect on this request, with the reason."""
        ignored: dict[str, str] = {}
        legs = {n: leg for n, leg in legs_of(self.mechanism).items() if self.alone in (None, n)}
        known_by_matrix = [isinstance(leg, GivenLeg) for leg in legs.values()]
        if not self.mechanism.parts:
            ignored |= dict.fromkeys(_OF_PARTS, "no body of the robot is a part from a file")
            if not any(known_by_matrix):
                reason = "no leg of this answer is specified by a 6×6 compliance"
                ignored |= dict.fromkeys(_OF_GIVEN_LEGS, reason)
            elif self.model in STATIC and self.options.legs == "given":
                reason = f"model {self.model} uses the legs as specified"
                names = ("theory", "equivalent") if all(known_by_matrix) else ("equivalent",)
                ignored |= dict.fromkeys(names, reason)
        if self.alone is not None:
            ignored["release"] = "a single leg has no joint to release"
        return ignored

    def _mode_faults(self) -> list[str]:
        faults = []
        if self.modes is not None and not 0 <= self.modes <= _LARGEST_COUNT:
            faults.append(f"--modes = {self.modes}: must be from 0 to {_LARGEST_COUNT}")
        elif self.modes and self.model in STATIC:
            faults.append(
                f"--modes: model {self.model} is static and has no frequencies; leave --modes "
                "out or choose another --model"
            )
        if self.against in STATIC:
            faults.append(
                f"--against {self.against}: the model is static and has no modes; choose a "
                "model with masses"
            )
        elif self.against and (not self.count or self.alone is not None):
            faults.append(
                "--against: without modes of the whole robot there is nothing to pair; leave the "
                "option out"
            )
        return faults

    def _free_faults(self) -> list[str]:
        """Faults of a request about a free body."""
        faults = []
        if self.alone is None:
            faults.append("--ends free-free: only for a single body; name it with --body")
        if self.model in STATIC or self.model == "simplified":
            faults.append(
                f"--ends free-free: model {self.model} of a body has no frequencies; choose "
                "another --model"
            )
        if self.accuracy is not None:
            faults.append("--accuracy: not for a free body (--ends free-free); leave it out")
        if self.modes == 0 and self.model not in STATIC:
            faults.append(
                "--modes 0: a free body has only frequencies as results; must be at least 1"
            )
        return faults

    def _body_faults(self, body: str) -> list[str]:
        mechanism, names = self.mechanism, list(legs_of(self.mechanism))
        faults = []
        if body not in names:
            rigid = body in mechanism.bodies and body != GROUND
            reason = "is a rigid body" if rigid else "does not exist"
            if body in mechanism.parts:
                reason = "is a CAD part; use flexproof identify ROBOT --body"
                if self.free:
                    reason = "is a part from a file, which is a solid; take --model solid"
            if not (self.free and self.model == "solid" and body in mechanism.parts):
                faults.append(f"--body {body}: {reason}; must be one of {', '.join(names)}")
        pose, body_option = ("--x", "--leg") if self.numbered else ("--pose", "--body")
        if self._typed:
            faults.append(f"{pose}: a single body has no pose; leave out {pose} or {body_option}")
        if self.model == "simplified":
            faults.append(
                f"{body_option}: not for model simplified, whose bodies are rigid; choose "
                "another --model"
            )
        return faults
