"""A mechanism in the postures in which it is judged, and what its robot file leaves unsaid."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np

from fem.beams.interior import Interior
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, tip_compliances
from lumped.robot_file.reading import Printed
from validation.context import Context, Preset
from validation.kinematics.poses import postures_on_path
from validation.models.loads.leg_masses import MASSES, Inside, Masses
from validation.models.options import DEFAULT_OPTIONS
from validation.models.part_legs import part_springs, require_legs
from validation.models.reduced_parts import is_held_as_said
from validation.models.robot_models import constant_legs
from validation.models.roundings import Rounding, roundings_of
from validation.parts.meshes import FINEST
from validation.references.mode_samples import Samples, samples_of
from validation.verdicts import Coordinate

# How ends are held, and tip compliances (6×6, SI, leg axes), by body.
Holds: TypeAlias = Mapping[str, Ends]
Springs: TypeAlias = Mapping[str, Array]
# Relative changes of uncertain inputs by their keys in the robot file.
Factors: TypeAlias = tuple[tuple[str, float], ...]
# Fields of a reading that choose a mesh.
MeshKind: TypeAlias = Literal["mesh", "section_mesh", "part_mesh"]

# Poses of a long path, of a grid say, are looked at in even steps.
MOST_POSES: Mapping[Preset, int] = {"quick": 9, "standard": 25, "fine": 81}
HOLD: tuple[Ends, Ends] = ("rigid", "free")
_SAY_PARTS = 'how faces are held: coupling = "rigid", "average" or "pin" in the interfaces of'
_SAY_ENDS = 'how end faces are held: ends = "rigid" (bolted flat) or ends = "free" (to warp) in'


@dataclass(frozen=True)
class Reading:
    """Reading of a robot file where it leaves something open, on one mesh of each kind.

    `ends` of every leg and part. `masses` and `interior` of the legs known by their 6×6. `mesh` of
    solid legs, and `section_mesh` of the constants of their sections: 1 is the fine one, 0 the
    coarse one. `part_mesh`: level of CAD parts. `elements`: factor on the element count of
    formulations. The robot itself is perturbed by `factors` of its inputs and by `rounding`, the
    number of a printed digit that is off (`roundings_of`); None if none is.
    """

    ends: Holds
    masses: Masses = MASSES[0]
    interior: Interior = "uniform"
    mesh: Literal[0, 1] = 1
    section_mesh: Literal[0, 1] = 1
    part_mesh: int = FINEST
    elements: int = 1
    factors: Factors = ()
    rounding: int | None = None

    def __hash__(self) -> int:
        values = [getattr(self, one.name) for one in fields(self) if one.name != "ends"]
        return hash((frozenset(self.ends.items()), *values))

    @property
    def inside(self) -> Inside:
        """Inside of the legs known by their 6×6."""
        return Inside(self.masses, self.interior)

    def on_mesh(self, kind: MeshKind, level: int) -> "Reading":
        """Reading with another mesh of one kind."""
        mesh: dict[str, Any] = {kind: level}
        return replace(self, **mesh)

    @property
    def is_perturbed(self) -> bool:
        """Whether the robot differs from that of its file."""
        return bool(self.factors) or self.rounding is not None

    @property
    def unperturbed(self) -> "Reading":
        """The same reading of the robot as its file describes it."""
        return replace(self, factors=(), rounding=None)

    def restricted(self, names: Collection[str]) -> "Reading":
        """Reading with the default in all fields but those named."""
        return replace(NOMINAL, **{name: getattr(self, name) for name in names})


# Reading of models that depend on nothing that a robot file leaves open.
NOMINAL = Reading({})


@dataclass(frozen=True)
class Holding:
    """How ends of legs and interfaces of parts are held.

    `alternatives`: the ends of every leg and part by the alternative's name ("free" ones of parts
    are averaged), one where all is said. `unsaid` what the robot file leaves open, in words,
    `decides` what would settle it; both empty where it says all.
    """

    alternatives: Mapping[str, Holds]
    unsaid: str = ""
    decides: str = ""

    @property
    def first(self) -> Holds:
        """The stiffest alternative."""
        return next(iter(self.alternatives.values()))


@dataclass(frozen=True, eq=False)
class RobotOnPath:
    """A mechanism in its postures, with what every reference of it is computed from.

    `legs` by body, prisms that are alike the same. `printed`: the 6×6 of its file with half a unit
    of their digits. Empty if these are not in question.
    """

    context: Context
    postures: tuple[Posture, ...]
    legs: Mapping[str, Leg]
    holding: Holding
    printed: tuple[Printed, ...]

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism, the same in all postures."""
        return self.postures[0].mechanism

    @property
    def prisms(self) -> list[ConstantLeg]:
        """The legs that are solids in the reference."""
        return [leg for leg in self.legs.values() if isinstance(leg, ConstantLeg)]

    @property
    def given(self) -> dict[str, GivenLeg]:
        """The legs that are known by their 6×6 alone."""
        return {name: leg for name, leg in self.legs.items() if isinstance(leg, GivenLeg)}

    @property
    def has_solids(self) -> bool:
        """Whether any body is a solid in the reference."""
        return bool(self.prisms or self.mechanism.parts)

    @property
    def say_masses(self) -> str:
        """What would say where the mass of these lies."""
        return say_masses(self.given, self.context.robot_file.schema)

    @property
    def say_interior(self) -> str:
        """Instruction that settles the stiffness inside these; "" without such legs."""
        return say_interior(self.given, self.context.robot_file.schema)

    @property
    def first_reading(self) -> Reading:
        """The reading by which the meshes of CAD parts are studied."""
        return Reading(self.holding.first)

    @property
    def judged(self) -> int:
        """How many frequencies are judged."""
        return self.context.robot_file.requirement.modes

    @property
    def offered(self) -> int:
        """How many modes of each model are looked at."""
        return offered(self.judged)

    @cached_property
    def samples(self) -> Samples:
        """Where the shapes of all models are sampled."""
        return samples_of(self.mechanism)

    @cached_property
    def roundings(self) -> list[Rounding]:
        """The robot with each printed digit of its 6×6 off in turn."""
        return roundings_of(self.printed, self.postures)

    @cached_property
    def climbs(self) -> str:
        """The model by whose code causes in statics are computed: links where vjm cannot."""
        return "links" if self.mechanism.parts or why_not_serial(self.postures) else "vjm"


def robot_on_path(context: Context) -> RobotOnPath:
    """The run's robot in the postures of its path."""
    return robot_at(context, path_postures(context))


def robot_at(context: Context, postures: Sequence[Posture]) -> RobotOnPath:
    """A mechanism, of the run's robot or a part of it, in these postures."""
    mechanism = postures[0].mechanism
    return RobotOnPath(
        context,
        tuple(postures),
        known_legs(mechanism),
        holding(mechanism, context.robot_file.schema),
        context.robot_file.printed_compliances,
    )


def path_postures(context: Context) -> tuple[Posture, ...]:
    """The postures of the path, first and last among them, once per run and process."""
    return context.get(_postures, context.robot_file.mechanism, MOST_POSES[context.preset])


def _postures(mechanism: Mechanism, most: int) -> tuple[Posture, ...]:
    count = len(mechanism.poses)
    chosen = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))
    return tuple(postures_on_path(mechanism, mechanism.poses[chosen]))


def offered(judged: int) -> int:
    """How many modes of each model are looked at to judge so many.

    Legs that are alike have theirs in clusters, which a model must not show in part.
    """
    return max(12, 6 * judged)


def coordinates(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """What a pose prescribes."""
    return tuple(Coordinate(move, UNITS_OF_MOVES[move]) for move in mechanism.tool.moves)


def holding(mechanism: Mechanism, schema: int = 2) -> Holding:
    """How legs and parts are held: as is said, and where it is not in both ways.

    `schema` of the robot file, whose tables are named in what would decide it.
    """
    # The 6×6 of a given leg has its ends in it.
    legs = {
        name: leg.ends if isinstance(leg, ConstantLeg) else "rigid"
        for name, leg in legs_of(mechanism).items()
    }
    parts: dict[str, Ends | None] = {
        name: "rigid" if is_held_as_said(body) else None for name, body in mechanism.parts.items()
    }
    said = {**legs, **parts}
    unsaid = [
        (name, question, f"say in the robot file {say} {_tables(of_kind, schema)}")
        for name, question, say, of_kind in (
            ("ends", "how the ends are held", _SAY_ENDS, legs),
            ("interfaces", "how the parts' interfaces are held", _SAY_PARTS, parts),
        )
        if not all(of_kind.values())
    ]
    if not unsaid:
        name = "interfaces as given" if parts and not legs else "ends as given"
        return Holding({name: {body: ends or "rigid" for body, ends in said.items()}})
    names, questions, decides = (tuple(one) for one in zip(*unsaid, strict=True))
    loose = "free" if "ends" in names else "averaged"
    return Holding(
        {
            f"{' and '.join(names)} {'rigid' if hold == 'rigid' else loose}": {
                body: ends or hold for body, ends in said.items()
            }
            for hold in HOLD
        },
        " and ".join(questions),
        "; ".join(decides),
    )


def say_masses(legs: Mapping[str, GivenLeg], schema: int = 2) -> str:
    """What would say where the mass of legs known by their 6×6 lies: the keys that are left out.

    Where none is, nothing but what the legs are made of does; "" without such legs.
    """
    lacking: dict[str, dict[str, None]] = {}
    for name, leg in legs.items():
        keys = [key for key in ("mass_centre", "inertia") if getattr(leg, key) is None]
        lacking.setdefault(" and ".join(keys), {})[name] = None
    if untold := [f"{keys} in {_tables(of, schema)}" for keys, of in lacking.items() if keys]:
        return f"give the legs' mass distribution beside the 6×6: {', '.join(untold)}"
    return say_interior(legs, schema)


def say_interior(legs: Iterable[str], schema: int = 2) -> str:
    """Instruction that settles all about legs known by their 6×6; "" without such legs."""
    made = _tables(dict.fromkeys(legs), schema)
    return f"give the section or the solid in place of the 6×6 in {made}" if made else ""


def _tables(held: Mapping[str, Ends | None], schema: int) -> str:
    """Tables of the robot file of bodies of which something is not said."""
    head = "" if schema == 1 else "bodies."
    return ", ".join(f"[{head}{name}]" for name, ends in held.items() if ends is None)


def known_legs(mechanism: Mechanism) -> dict[str, Leg]:
    """Every leg by name, prisms that are alike the same."""
    prisms = {name: leg for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS)}
    return {
        name: leg if isinstance(leg, GivenLeg) else prisms[name]
        for name, leg in legs_of(mechanism).items()
    }


def distinct_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """The legs by name, of those that are alike the first alone."""
    first: dict[object, str] = {}
    for name, leg in known_legs(mechanism).items():
        first.setdefault(leg if isinstance(leg, ConstantLeg) else name, name)
    return tuple(first.values())


def why_not_serial(postures: Sequence[Posture]) -> str:
    """Why virtual joints cannot be summed along every leg; "" where they can."""
    mechanism = postures[0].mechanism
    try:
        require_legs(mechanism)
        springs = tip_compliances(mechanism) | part_springs(mechanism, DEFAULT_OPTIONS)
        serial_chains.serial_chains(postures[0], springs)
    except serial_chains.NoChainError as error:
        return error.reason
    except InputError as error:
        return str(error)
    return ""
