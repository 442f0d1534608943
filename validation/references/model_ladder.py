"""Models of the ladder: formulations, legs as springs with more and more effects, and solids.

Statics of springs are solved by virtual joints if legs are serial chains, which share no code with
the assembler of the reference, and by links otherwise.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import Ends, Leg, given_compliance
from lumped.mechanism.mechanism import Posture
from lumped.models import serial_chains
from validation.models.loads.displacements import (
    by_chains,
    displacements,
    displacements_by,
    masses_of,
)
from validation.models.options import ModelName, ModelOptions, PartLegs
from validation.models.robot_models import answers
from validation.references.modes_on_path import (
    OWN_SECTIONS,
    LegMesh,
    modes_by_model,
    modes_of_own_beams,
    modes_of_solids,
    solid_meshes,
)
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    held_spring,
    own_spring,
    restrained_spring,
    shares_section,
    solid_tip,
    straight_spring,
)
from validation.references.reference_parts import assembled, solid_parts
from validation.references.responses import Model
from validation.references.robot_on_path import Reading, RobotOnPath, Springs
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solids.solid_legs import COARSEST_WALLS

# Compliance (6×6, SI, leg axes) of the tip of a leg of the robot with such ends.
Spring: TypeAlias = Callable[[RobotOnPath, Leg, Ends], Array]


def model_statics(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> Statics:
    """Statics of a model."""
    compliances = np.array([answer.compliance for answer in answers(model, postures, 0, options)])
    return Statics.of(compliances, displacements(model, postures, options))


def formulation(name: str, kind: ModelName, options: ModelOptions) -> Model:
    """Model of a kind with options."""
    return Model(
        name,
        statics=partial(_formulation_statics, kind, options),
        modes=partial(formulation_modes, kind, options),
        static_fields=("elements",),
        modal_fields=("elements",),
    )


def with_parts(parts: PartLegs) -> Model:
    """Beams with CAD parts idealised in one of three ways."""
    return formulation(f"beam, parts {parts}", "beam", ModelOptions(parts=parts))


def _formulation_statics(
    kind: ModelName, options: ModelOptions, robot: RobotOnPath, reading: Reading
) -> Statics:
    return model_statics(robot.postures, kind, with_elements(options, reading))


def formulation_modes(
    kind: ModelName, options: ModelOptions, robot: RobotOnPath, reading: Reading
) -> PathModes | None:
    """Modes of a kind of model, whose element count is that of the options times the reading's."""
    return modes_by_model(robot, kind, with_elements(options, reading))


def with_elements(options: ModelOptions, reading: Reading) -> ModelOptions:
    """Options with their element count times the factor of the reading."""
    return replace(options, elements=reading.elements * options.elements)


def solid_statics(robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with solid legs and parts, legs known by their 6×6 as they are."""
    tips = {
        body: solid_tip(robot.context, leg, reading.ends[body], mesh=reading.mesh)
        for body, leg in robot.legs.items()
    }
    parts = solid_parts(robot.postures, robot.offered, reading.ends, reading.part_mesh)
    return assembled(robot.postures, tips, parts, reading.masses)


def own_statics(robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with legs of their sections' own constants.

    On the coarse section mesh, legs whose solids share one section mesh have its constants.
    """

    def divisions(leg: Leg) -> int:
        coarse = not reading.section_mesh and shares_section(robot.context, leg)
        return COARSEST_WALLS if coarse else SECTION_DIVISIONS

    springs = {
        body: own_spring(robot.context, leg, divisions(leg)) for body, leg in robot.legs.items()
    }
    return _by_springs(robot, springs)


def _spring_statics(spring: Spring, robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with each leg as a spring at its tip."""
    # Readings without ends belong to models whose springs do not depend on them.
    ends = reading.ends or dict.fromkeys(robot.legs, "rigid")
    springs = {body: spring(robot, leg, ends[body]) for body, leg in robot.legs.items()}
    return _by_springs(robot, springs)


def _by_springs(robot: RobotOnPath, springs: Springs) -> Statics:
    return (_summed if robot.climbs == "vjm" else assembled)(robot.postures, springs)


def _summed(postures: Sequence[Posture], springs: Springs) -> Statics:
    """Statics by virtual joints along serial chains, each leg by its tip's compliance."""
    compliances = np.array([serial_chains.compliance(posture, springs) for posture in postures])
    masses = masses_of(postures[0].mechanism)
    return Statics.of(compliances, displacements_by(by_chains(springs), postures, masses))


def _given(_robot: RobotOnPath, leg: Leg, _ends: Ends) -> Array:
    return given_compliance(leg)


def _equivalent(_robot: RobotOnPath, leg: Leg, _ends: Ends) -> Array:
    return given_compliance(equivalent_leg(leg))


def _straight(_robot: RobotOnPath, leg: Leg, _ends: Ends) -> Array:
    return straight_spring(leg)


def _held(robot: RobotOnPath, leg: Leg, ends: Ends) -> Array:
    return held_spring(robot.context, leg, ends)


def _restrained(robot: RobotOnPath, leg: Leg, ends: Ends) -> Array:
    return restrained_spring(robot.context, leg, ends)


def _own_modes(robot: RobotOnPath, reading: Reading) -> PathModes:
    return modes_of_own_beams(robot, None, _section_mesh(robot, reading))


def _held_modes(robot: RobotOnPath, reading: Reading) -> PathModes:
    return modes_of_own_beams(robot, reading.ends, _section_mesh(robot, reading))


def _section_mesh(robot: RobotOnPath, reading: Reading) -> LegMesh:
    """Mesh of the sections: their own fine one, or that of the solids."""
    if reading.section_mesh:
        return OWN_SECTIONS
    fine = solid_meshes(robot.context.meshes).fine
    return fine._replace(walls=max(fine.walls, COARSEST_WALLS))


# Legs of their sections' own constants, without and with warping held at the ends.
OWN = Model(
    "own constants",
    statics=own_statics,
    modes=_own_modes,
    static_fields=("section_mesh",),
    modal_fields=("section_mesh",),
)
HELD = Model(
    "warping held",
    statics=partial(_spring_statics, _held),
    modes=_held_modes,
    static_fields=("ends",),
    modal_fields=("ends", "section_mesh"),
)
# The reference of both halves. Solids change as beams do if inputs are a few per cent off.
SOLID = Model(
    "solid",
    statics=solid_statics,
    modes=modes_of_solids,
    static_fields=("ends", "masses", "mesh", "part_mesh"),
    modal_fields=("ends", "masses", "interior", "mesh", "part_mesh"),
    stand_in=HELD,
)
# Legs of own constants, less the compliance lost by rigid end faces.
RESTRAINED = Model(
    "contraction held", statics=partial(_spring_statics, _restrained), static_fields=("ends",)
)
# Legs by the 6×6 of the file, by its entries that a straight leg has, and by their equivalent legs.
GIVEN = Model("legs as given", statics=partial(_spring_statics, _given))
STRAIGHT = Model("straight legs", statics=partial(_spring_statics, _straight))
EQUIVALENT = Model("equivalent legs", statics=partial(_spring_statics, _equivalent))
