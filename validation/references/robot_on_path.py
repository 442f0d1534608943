"""A robot in the postures in which it is judged, and the readings that its file allows.

Input: the robot file and the preset of a run. Output: `RobotOnPath`, the mechanism in at most
`MOST_POSES` postures of its path with its legs and end conditions, and `Reading`, one choice for
everything that the file leaves open together with one mesh of each kind. Rule: if the file does not
specify the condition of end faces or interfaces, both the rigid and the free one are computed.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np

from fem.beams.interior import Interior
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import GivenLeg, Leg, LineLeg, SectionedLeg
from lumped.mechanism.mechanism import UNITS_OF_MOVES, Mechanism, Posture
from lumped.model_choices import Ends
from lumped.models import serial_chains
from lumped.models.bodies import legs_of, tip_compliances
from lumped.robot_file.reading import Printed
from validation.context import Context, Preset
from validation.kinematics.poses import postures_on_path
from validation.models.loads.leg_masses import MASSES, Inside, Masses
from validation.models.options import DEFAULT_OPTIONS
from validation.models.part_legs import part_springs, require_legs
from validation.models.reduced_parts import has_specified_couplings
from validation.models.robot_bodies import sectioned_legs
from validation.models.roundings import Rounding, roundings_of
from validation.parts.meshes import FINEST
from validation.references.mode_samples import Samples, samples_of
from validation.verdicts import Coordinate

# End condition of each body by name, and 6×6 tip compliance (SI, leg axes) of each leg by name.
Holds: TypeAlias = Mapping[str, Ends]
Springs: TypeAlias = Mapping[str, Array]
# Relative change of each uncertain input, with its key in the robot file.
Factors: TypeAlias = tuple[tuple[str, float], ...]
# Fields of a reading that select a mesh.
MeshKind: TypeAlias = Literal["mesh", "section_mesh", "part_mesh"]

# Largest number of computed poses. Of a longer path, evenly spaced poses are computed.
MOST_POSES: Mapping[Preset, int] = {"quick": 9, "standard": 25, "fine": 81}
HOLD: tuple[Ends, Ends] = ("rigid", "free")
_PARTS_INSTRUCTION = (
    'the coupling of the interfaces, coupling = "rigid", "average" or "pin" in the interfaces of'
)
_ENDS_INSTRUCTION = (
    'the end condition, ends = "rigid" (bolted flat) or ends = "free" (free to warp), in'
)


@dataclass(frozen=True)
class Reading:
    """One choice for everything that a robot file leaves open, and one mesh of each kind.

    `ends`: end condition of each leg and CAD part. `masses`, `interior`: distribution of mass and
    of stiffness in legs specified by their 6×6 compliance. `mesh`: mesh of solid legs,
    `section_mesh`: mesh for section constants; 1 is the fine, 0 the coarse mesh. `part_mesh`: mesh
    level of CAD parts. `elements`: factor on the element count of models. `factors`: relative
    changes of the robot's inputs. `rounding`: index, in `RobotOnPath.roundings`, of the printed
    number that is slightly changed. It is None if no number is changed.
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
        """Distribution of mass and of stiffness inside legs specified by their 6×6 compliance."""
        return Inside(self.masses, self.interior)

    def on_mesh(self, kind: MeshKind, level: int) -> "Reading":
        """Copy with another mesh `level` of one `kind` of mesh."""
        mesh: dict[str, Any] = {kind: level}
        return replace(self, **mesh)

    @property
    def unperturbed(self) -> "Reading":
        """Copy of the reading with the inputs and printed numbers of the robot file."""
        return replace(self, factors=(), rounding=None)

    def restricted(self, names: Collection[str]) -> "Reading":
        """Copy with default values in all fields except `names`."""
        return replace(NOMINAL, **{name: getattr(self, name) for name in names})


# Reading for models that do not depend on anything that a robot file leaves open.
NOMINAL = Reading({})


@dataclass(frozen=True)
class Holding:
    """End conditions of legs and of CAD parts' interfaces that the robot file allows.

    `alternatives`: end condition of each leg and part, by name of the alternative. For parts,
    "free" means averaged. There is one alternative if the file specifies all conditions, otherwise
    a rigid and a free one. `unspecified`: text on the conditions that the file does not specify;
    `decides`: instruction to specify them. Both are "" if the file specifies all conditions.
    """

    alternatives: Mapping[str, Holds]
    unspecified: str = ""
    decides: str = ""

    @property
    def first(self) -> Holds:
        """End conditions of the stiffest alternative."""
        return next(iter(self.alternatives.values()))


@dataclass(frozen=True, eq=False)
class RobotOnPath:
    """A mechanism in its postures, with all data from which its references are built.

    `printed`: each 6×6 compliance of the robot file with half a unit of the last digit of its
    entries. Empty if digits are not a source of uncertainty. `path`: postures in which bodies are
    reduced: their cut-off frequency follows from the highest frequency in these postures. Empty if
    the cut-off frequencies follow from `postures`.
    """

    context: Context
    postures: tuple[Posture, ...]
    printed: tuple[Printed, ...]
    path: tuple[Posture, ...] = ()

    def at(self, postures: Sequence[Posture]) -> "RobotOnPath":
        """Copy of the robot in other postures, with bodies reduced for the original postures."""
        return replace(self, postures=tuple(postures), path=self.reduction_postures)

    @property
    def reduction_postures(self) -> tuple[Posture, ...]:
        """Postures from whose frequencies the cut-off frequency of reduced bodies follows."""
        return self.path or self.postures

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism, which all postures have in common."""
        return self.postures[0].mechanism

    @cached_property
    def legs(self) -> dict[str, Leg]:
        """Legs by body name. Legs with equal prisms share one object."""
        return known_legs(self.mechanism)

    @cached_property
    def holding(self) -> Holding:
        """End conditions of legs and parts that the robot file allows."""
        return holding(self.mechanism, self.context.robot_file.schema)

    @property
    def prisms(self) -> list[SectionedLeg]:
        """Legs with a constant or varying cross-section, which are solids in the reference.

        All legs are included except those specified by their 6×6 compliance only.
        """
        return [leg for leg in self.legs.values() if not isinstance(leg, GivenLeg)]

    @property
    def given(self) -> dict[str, GivenLeg]:
        """Legs specified by their 6×6 compliance only, by body name."""
        return {name: leg for name, leg in self.legs.items() if isinstance(leg, GivenLeg)}

    @property
    def has_solids(self) -> bool:
        """True if the reference contains a solid: a leg with a cross-section or a CAD part."""
        return bool(self.prisms or self.mechanism.parts)

    @property
    def masses_instruction(self) -> str:
        """Instruction to add keys for the mass distribution of legs given by a compliance alone.

        If no key is missing, the instruction is to replace the compliance by a section or solid. ""
        if there are no such legs.
        """
        lacking: dict[str, list[str]] = {}
        for name, leg in self.given.items():
            keys = [key for key in ("mass_centre", "inertia") if getattr(leg, key) is None]
            if keys:
                lacking.setdefault(" and ".join(keys), []).append(name)
        if not lacking:
            return self.interior_instruction
        schema = self.context.robot_file.schema
        listed = ", ".join(f"{keys} in {_tables(names, schema)}" for keys, names in lacking.items())
        return (
            f"specify the mass distribution of the legs in addition to the 6×6 compliance: {listed}"
        )

    @property
    def interior_instruction(self) -> str:
        """Instruction to specify how stiffness is distributed along legs given by a compliance.

        "" if there are no such legs.
        """
        tables = _tables(self.given, self.context.robot_file.schema)
        return (
            f"specify the section or the solid instead of the 6×6 compliance in {tables}"
            if tables
            else ""
        )

    @property
    def first_reading(self) -> Reading:
        """Reading with the stiffest end conditions, for the mesh studies of CAD parts."""
        return Reading(self.holding.first)

    @property
    def judged_count(self) -> int:
        """Number of natural frequencies that are judged in each pose."""
        return self.context.robot_file.requirement.modes

    @property
    def computed_count(self) -> int:
        """Number of modes computed by each model, of which the first `judged_count` are judged."""
        return computed_count(self.judged_count)

    @cached_property
    def samples(self) -> Samples:
        """Points at which mode shapes of all models are compared."""
        return samples_of(self.mechanism)

    @cached_property
    def roundings(self) -> list[Rounding]:
        """Robots in each of which one printed number of a 6×6 compliance is slightly changed."""
        return roundings_of(self.printed, self.postures)

    @cached_property
    def static_model(self) -> str:
        """Name of the model by which causes of static errors are computed.

        "vjm" (virtual joint method) if the legs are serial chains without CAD parts, otherwise
        "links".
        """
        return "links" if self.mechanism.parts or why_not_serial(self.postures) else "vjm"


def robot_on_path(context: Context) -> RobotOnPath:
    """The robot of a run in the postures of its path."""
    return robot_at(context, path_postures(context))


def robot_at(context: Context, postures: Sequence[Posture]) -> RobotOnPath:
    """The robot of a run in the given `postures`, which may be those of a modified mechanism."""
    return RobotOnPath(context, tuple(postures), context.robot_file.printed_compliances)


def path_postures(context: Context) -> tuple[Posture, ...]:
    """At most `MOST_POSES` postures of the path, among them those of its first and last pose.

    They are computed once per run and process.
    """
    return context.get(_postures, context.robot_file.mechanism, MOST_POSES[context.preset])


def _postures(mechanism: Mechanism, largest: int) -> tuple[Posture, ...]:
    count = len(mechanism.poses)
    rows = np.unique(np.linspace(0, count - 1, min(count, largest)).round().astype(int))
    return tuple(postures_on_path(mechanism, mechanism.poses[rows]))


def computed_count(judged: int) -> int:
    """Number of modes to compute for each model if `judged` frequencies are judged.

    It is larger than `judged`, since equal legs have clusters of close modes that must all be
    computed.
    """
    return max(12, 6 * judged)


def coordinates(mechanism: Mechanism) -> tuple[Coordinate, ...]:
    """Coordinates of the tool that a pose prescribes, with their units."""
    return tuple(Coordinate(move, UNITS_OF_MOVES[move]) for move in mechanism.tool.moves)


def holding(mechanism: Mechanism, schema: int = 2) -> Holding:
    """End conditions of legs and parts: those of the robot file, otherwise rigid and free ones.

    `schema`: version of the robot file's format, on which the table names in the instruction
    depend.
    """
    # A leg specified by its 6×6 has no open end condition: it is part of the 6×6.
    legs = {
        name: "rigid" if isinstance(leg, GivenLeg) else leg.ends
        for name, leg in legs_of(mechanism).items()
    }
    parts: dict[str, Ends | None] = {
        name: "rigid" if has_specified_couplings(body) else None
        for name, body in mechanism.parts.items()
    }
    specified = {**legs, **parts}
    unspecified = [
        (name, question, f"specify in the robot file {instruction} {_tables(bodies, schema)}")
        for name, question, instruction, ends_by_body in (
            ("ends", "end conditions of the legs", _ENDS_INSTRUCTION, legs),
            ("interfaces", "coupling of the parts' interfaces", _PARTS_INSTRUCTION, parts),
        )
        if (bodies := [body for body, ends in ends_by_body.items() if ends is None])
    ]
    if not unspecified:
        name = (
            "interfaces as in the robot file" if parts and not legs else "ends as in the robot file"
        )
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


def _tables(bodies: Iterable[str], schema: int) -> str:
    """Names of the robot file's tables for bodies, such as "[bodies.leg1], [bodies.leg2]"."""
    head = "" if schema == 1 else "bodies."
    return ", ".join(f"[{head}{name}]" for name in bodies)


def known_legs(mechanism: Mechanism) -> dict[str, Leg]:
    """Legs by body name. Legs with equal prisms share one object."""
    prisms = {name: leg for name, leg, _ in sectioned_legs(mechanism, DEFAULT_OPTIONS)}
    return {
        name: leg if isinstance(leg, GivenLeg) else prisms[name]
        for name, leg in legs_of(mechanism).items()
    }


def distinct_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """Body names of the distinct legs: the first of each group of equal legs."""
    first: dict[object, str] = {}
    for name, leg in known_legs(mechanism).items():
        first.setdefault(name if isinstance(leg, GivenLeg) else leg, name)
    return tuple(first.values())


def prismatic_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """Body names of the distinct legs that are prisms or can be replaced by equivalent prisms.

    All distinct legs are listed except tapered, stepped and curved ones.
    """
    legs = legs_of(mechanism)
    return tuple(name for name in distinct_legs(mechanism) if not isinstance(legs[name], LineLeg))


def why_not_serial(postures: Sequence[Posture]) -> str:
    """Reason why the virtual joint method cannot be used because a leg is not a serial chain.

    "" if all legs are serial chains.
    """
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
