"""Mechanism in the postures in which it is judged, and readings of an incomplete robot file."""

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

# End conditions, and tip compliances (6×6, SI, leg axes), by body.
Holds: TypeAlias = Mapping[str, Ends]
Springs: TypeAlias = Mapping[str, Array]
# Relative changes of uncertain inputs by their keys in the robot file.
Factors: TypeAlias = tuple[tuple[str, float], ...]
# Fields of a reading that choose a mesh.
MeshKind: TypeAlias = Literal["mesh", "section_mesh", "part_mesh"]

# Most poses of a path, such as a grid; of a longer path, poses in even steps are computed.
MOST_POSES: Mapping[Preset, int] = {"quick": 9, "standard": 25, "fine": 81}
HOLD: tuple[Ends, Ends] = ("rigid", "free")
_SAY_PARTS = 'how faces are held: coupling = "rigid", "average" or "pin" in the interfaces of'
_SAY_ENDS = 'how end faces are held: ends = "rigid" (bolted flat) or ends = "free" (to warp) in'


@dataclass(frozen=True)
class Reading:
    """Reading of a robot file with open information filled in, and one mesh of each kind.

    `ends` of each leg and part. `masses` and `interior` of the legs known by their 6×6. `mesh` of
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
        values = [
            getattr(self, reading_field.name)
            for reading_field in fields(self)
            if reading_field.name != "ends"
        ]
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
        """True if the robot differs from that of its file."""
        return bool(self.factors) or self.rounding is not None

    @property
    def unperturbed(self) -> "Reading":
        """Reading without perturbations: the robot as its file describes it."""
        return replace(self, factors=(), rounding=None)

    def restricted(self, names: Collection[str]) -> "Reading":
        """Reading with the default in all fields except `names`."""
        return replace(NOMINAL, **{name: getattr(self, name) for name in names})


# Reading of models that do not depend on information missing from a robot file.
NOMINAL = Reading({})


@dataclass(frozen=True)
class Holding:
    """End conditions of legs and of interfaces of parts.

    `alternatives`: ends of each leg and part by the alternative's name ("free" ones of parts are
    averaged). There is one if the robot file specifies all. `unsaid`: text on the conditions that
    the file does not specify. `decides`: instruction that specifies them. Both are "" if the file
    specifies all.
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
    """Mechanism in its postures, with the inputs of its references.

    `legs` by body; equal prisms are the same object. `printed`: the 6×6 of its file with half a
    unit of their last digits. Empty if digits are not a source of uncertainty.
    """

    context: Context
    postures: tuple[Posture, ...]
    legs: Mapping[str, Leg]
    holding: Holding
    printed: tuple[Printed, ...]

    @property
    def mechanism(self) -> Mechanism:
        """Mechanism, common to all postures."""
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
        """True if any body is a solid in the reference."""
        return bool(self.prisms or self.mechanism.parts)

    @property
    def say_masses(self) -> str:
        """Instruction that settles the given legs' mass distribution. "" without such legs."""
        return say_masses(self.given, self.context.robot_file.schema)

    @property
    def say_interior(self) -> str:
        """Instruction that settles the stiffness inside the given legs. "" without such legs."""
        return say_interior(self.given, self.context.robot_file.schema)

    @property
    def first_reading(self) -> Reading:
        """Reading used for the mesh study of CAD parts."""
        return Reading(self.holding.first)

    @property
    def judged(self) -> int:
        """Number of judged frequencies."""
        return self.context.robot_file.requirement.modes

    @property
    def offered(self) -> int:
        """Number of computed modes of each model."""
        return offered(self.judged)

    @cached_property
    def samples(self) -> Samples:
        """Sampling points of the shapes of all models."""
        return samples_of(self.mechanism)

    @cached_property
    def roundings(self) -> list[Rounding]:
        """Robots with one printed digit of a 6×6 off each."""
        return roundings_of(self.printed, self.postures)

    @cached_property
    def climbs(self) -> str:
        """Model that computes causes in statics: vjm, or links if vjm cannot."""
        return "links" if self.mechanism.parts or why_not_serial(self.postures) else "vjm"


def robot_on_path(context: Context) -> RobotOnPath:
    """The run's robot in the postures of its path."""
    return robot_at(context, path_postures(context))


def robot_at(context: Context, postures: Sequence[Posture]) -> RobotOnPath:
    """Mechanism of the run's robot, or of a part of it, in these postures."""
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


def _postures(mechanism: Mechanism, largest: int) -> tuple[Posture, ...]:
    count = len(mechanism.poses)
    rows = np.unique(np.linspace(0, count - 1, min(count, largest)).round().astype(int))
    return tuple(postures_on_path(mechanism, mechanism.poses[rows]))


def offered(judged: int) -> int:
    """Number of modes of each model that are computed to judge `judged` ones.

    Modes of equal legs come in clusters, which must not be cut.
    """
    return max(12, 6 * judged)


def coordinates(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """Coordinates that a pose prescribes."""
    return tuple(Coordinate(move, UNITS_OF_MOVES[move]) for move in mechanism.tool.moves)


def holding(mechanism: Mechanism, schema: int = 2) -> Holding:
    """End conditions of legs and parts: as specified in the robot file, otherwise both variants.

    `schema` of the robot file, for the table names in the instruction.
    """
    # The 6×6 of a given leg has its ends in it.
    legs = {
        name: leg.ends if isinstance(leg, ConstantLeg) else "rigid"
        for name, leg in legs_of(mechanism).items()
    }
    parts: dict[str, Ends | None] = {
        name: "rigid" if is_held_as_said(body) else None for name, body in mechanism.parts.items()
    }
    specified = {**legs, **parts}
    unspecified = [
        (name, question, f"say in the robot file {say} {_tables(bodies, schema)}")
        for name, question, say, bodies in (
            ("ends", "how the ends are held", _SAY_ENDS, legs),
            ("interfaces", "how the parts' interfaces are held", _SAY_PARTS, parts),
        )
        if not all(bodies.values())
    ]
    if not unspecified:
        name = "interfaces as given" if parts and not legs else "ends as given"
        return Holding({name: {body: ends or "rigid" for body, ends in specified.items()}})
    names, questions, decides = (tuple(column) for column in zip(*unspecified, strict=True))
    loose = "free" if "ends" in names else "averaged"
    return Holding(
        {
            f"{' and '.join(names)} {'rigid' if hold == 'rigid' else loose}": {
                body: ends or hold for body, ends in specified.items()
            }
            for hold in HOLD
        },
        " and ".join(questions),
        "; ".join(decides),
    )


def say_masses(legs: Mapping[str, GivenLeg], schema: int = 2) -> str:
    """Instruction that settles the mass distribution of legs known by their 6×6: missing keys.

    If no key is missing, the instruction is to give the legs' section or solid. "" without such
    legs.
    """
    lacking: dict[str, dict[str, None]] = {}
    for name, leg in legs.items():
        keys = [key for key in ("mass_centre", "inertia") if getattr(leg, key) is None]
        lacking.setdefault(" and ".join(keys), {})[name] = None
    if missing := [
        f"{keys} in {_tables(bodies, schema)}" for keys, bodies in lacking.items() if keys
    ]:
        return f"give the legs' mass distribution beside the 6×6: {', '.join(missing)}"
    return say_interior(legs, schema)


def say_interior(legs: Iterable[str], schema: int = 2) -> str:
    """Instruction that settles the inside of legs known by their 6×6. "" without such legs."""
    tables = _tables(dict.fromkeys(legs), schema)
    return f"give the section or the solid in place of the 6×6 in {tables}" if tables else ""


def _tables(ends_by_body: Mapping[str, Ends | None], schema: int) -> str:
    """Table names in the robot file of the bodies with unspecified ends."""
    head = "" if schema == 1 else "bodies."
    return ", ".join(f"[{head}{name}]" for name, ends in ends_by_body.items() if ends is None)


def known_legs(mechanism: Mechanism) -> dict[str, Leg]:
    """Legs by name; equal prisms are the same object."""
    prisms = {name: leg for name, leg, _ in constant_legs(mechanism, DEFAULT_OPTIONS)}
    return {
        name: leg if isinstance(leg, GivenLeg) else prisms[name]
        for name, leg in legs_of(mechanism).items()
    }


def distinct_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of distinct legs: the first of each group of equal legs."""
    first: dict[object, str] = {}
    for name, leg in known_legs(mechanism).items():
        first.setdefault(leg if isinstance(leg, ConstantLeg) else name, name)
    return tuple(first.values())


def why_not_serial(postures: Sequence[Posture]) -> str:
    """Reason why virtual joints cannot be summed along each leg. "" if they can."""
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
