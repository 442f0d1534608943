"""Intermediate models between a judged model and the reference, and the reference model itself.

Input: a robot along its path and a reading of its file. Output: statics (compliances and
displacements) or modes. Intermediate models replace each leg by the compliance of its tip, with one
more effect in each model: the couplings in the 6×6 compliance of the file, computed section
constants, restrained warping, restrained contraction. If the legs are serial chains, the
compliances are summed along them (virtual joint method), by code that is independent of the
assembler of the reference; otherwise the legs are assembled as links.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import Leg, LineLeg, given_compliance
from lumped.mechanism.mechanism import Posture
from lumped.model_choices import Ends, PartLegs
from lumped.models import serial_chains
from validation.context import Context, Preset
from validation.models.loads.solid_lines import solid_line_wrenches
from validation.models.loads.statics import (
    by_chains,
    displacements,
    displacements_by,
    interface_loads,
)
from validation.models.options import ModelName, ModelOptions
from validation.models.robot_models import answers
from validation.references.corners_and_steps import tip_changes
from validation.references.modes_on_path import (
    COMPUTED_SECTIONS,
    computed_beam_vibration,
    modes_by_model,
    modes_of_solids,
    solid_meshes,
)
from validation.references.reference import Remedy, Step
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    computed_spring,
    line_divisions,
    restrained_spring,
    shares_section,
    solid_tip,
    straight_spring,
    warping_spring,
)
from validation.references.reference_parts import assembled, solid_parts
from validation.references.responses import Model
from validation.references.robot_on_path import Holds, Reading, RobotOnPath, Springs
from validation.responses.statics_and_modes import PathModes, Statics
from validation.solids.leg_meshes import COARSEST_WALLS

# Function that returns the 6×6 tip compliance (SI, leg axes) of a leg with the given end condition.
Spring: TypeAlias = Callable[[Context, Leg, Ends], Array]


def model_statics(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> Statics:
    """Statics (compliances and load displacements) of a lumped or beam model in each posture."""
    solved = answers(model, postures, 0, options)
    return Statics(
        solved.compliances,
        displacements(model, postures, options),
        solved.idle,
    )


def formulation(name: str, kind: ModelName, options: ModelOptions) -> Model:
    """Model called `name` of a formulation, such as segments or beams, with fixed options."""
    return Model(
        name,
        statics=partial(_formulation_statics, kind, options),
        modes=partial(formulation_modes, kind, options),
        static_fields=("elements",),
        modal_fields=("elements",),
    )


def with_parts(parts: PartLegs) -> Model:
    """Beam model with CAD parts idealised by the method `parts`, such as stepped legs."""
    return formulation(f"beam, parts {parts}", "beam", ModelOptions(parts=parts))


def _formulation_statics(
    kind: ModelName, options: ModelOptions, robot: RobotOnPath, reading: Reading
) -> Statics:
    return model_statics(robot.postures, kind, with_elements(options, reading))


def formulation_modes(
    kind: ModelName, options: ModelOptions, robot: RobotOnPath, reading: Reading
) -> PathModes | None:
    """Modes of a formulation, with the element count of the options times `reading.elements`.

    None if nothing has mass.
    """
    return modes_by_model(robot, kind, with_elements(options, reading))


def with_elements(options: ModelOptions, reading: Reading) -> ModelOptions:
    """Options with their element count multiplied by `reading.elements`.

    A reading is one meaning of the robot file, with one choice of meshes and element counts.
    """
    return replace(options, elements=reading.elements * options.elements)


def solid_statics(robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with legs and CAD parts as solids. Legs given by a 6×6 compliance keep it."""
    tips = {
        body: solid_tip(robot.context, leg, reading.ends[body], mesh=reading.mesh)
        for body, leg in robot.legs.items()
    }
    parts = solid_parts(
        robot.reduction_postures, robot.computed_count, reading.ends, reading.part_mesh
    )

    def options(body: str, leg: LineLeg) -> ModelOptions:
        divisions = line_divisions(robot.context.meshes, leg)[reading.mesh]
        return ModelOptions(divisions=divisions, ends=reading.ends[body])

    lines = solid_line_wrenches(robot.mechanism, options)
    return assembled(robot.postures, tips, parts, reading.masses, lines)


def computed_statics(robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with beams whose section constants are computed by finite elements of the section.

    The constants are computed on the fine section mesh. If `reading` selects the coarse section
    mesh, there is an exception for legs whose coarse and fine solid have the same section mesh:
    their constants are computed on that mesh of the solids.
    """

    def divisions(leg: Leg) -> int:
        coarse = not reading.section_mesh and shares_section(robot.context, leg)
        return COARSEST_WALLS if coarse else SECTION_DIVISIONS

    springs = {
        body: computed_spring(robot.context, leg, divisions(leg))
        for body, leg in robot.legs.items()
    }
    return _by_springs(robot, springs)


def _spring_statics(spring: Spring, robot: RobotOnPath, reading: Reading) -> Statics:
    """Statics with each leg replaced by the tip compliance that `spring` returns."""
    # `reading.ends` is empty if the model does not depend on end conditions; "rigid" then has no
    # effect.
    ends = reading.ends or dict.fromkeys(robot.legs, "rigid")
    springs = {body: spring(robot.context, leg, ends[body]) for body, leg in robot.legs.items()}
    return _by_springs(robot, springs)


def _by_springs(robot: RobotOnPath, springs: Springs) -> Statics:
    return (_summed if robot.static_model == "vjm" else assembled)(robot.postures, springs)


def _summed(postures: Sequence[Posture], springs: Springs) -> Statics:
    """Statics by the virtual joint method along serial chains.

    Each leg is represented by its tip compliance in `springs`.
    """
    compliances = np.array([serial_chains.compliance(posture, springs) for posture in postures])
    bodies = interface_loads(postures[0].mechanism)
    return Statics(compliances, displacements_by(by_chains(springs), postures, bodies))


def _given(_context: Context, leg: Leg, _ends: Ends) -> Array:
    return given_compliance(leg)


def _equivalent(_context: Context, leg: Leg, _ends: Ends) -> Array:
    return given_compliance(equivalent_leg(leg))


def _straight(_context: Context, leg: Leg, _ends: Ends) -> Array:
    return straight_spring(leg)


def _with_jumps(context: Context, leg: Leg, ends: Ends) -> Array:
    spring = restrained_spring(context, leg, ends)
    if isinstance(leg, LineLeg):
        divisions = line_divisions(context.meshes, leg)[1]
        for change in context.get(tip_changes, leg, divisions).values():
            spring = spring + change
    return spring


def _computed_modes(robot: RobotOnPath, reading: Reading) -> PathModes:
    return _beam_modes(robot, None, reading)


def _warping_modes(robot: RobotOnPath, reading: Reading) -> PathModes:
    return _beam_modes(robot, reading.ends, reading)


def _modes_with_jumps(robot: RobotOnPath, reading: Reading) -> PathModes:
    return _beam_modes(robot, reading.ends, reading, robot.context.meshes)


def _beam_modes(
    robot: RobotOnPath, ends: Holds | None, reading: Reading, preset: Preset | None = None
) -> PathModes:
    """Modes by beams whose section constants are computed on the mesh `reading.section_mesh`.

    1 is the fine section mesh, 0 the section mesh of the reference's solids. `ends`: end condition
    by body name; warping is restrained at rigid ends. If `ends` is None, warping is free. `preset`
    selects the solids of corners and steps. If it is None, beams are without them.
    """
    mesh = COMPUTED_SECTIONS
    if not reading.section_mesh:
        fine = solid_meshes(robot.context.meshes).fine
        mesh = fine._replace(walls=max(fine.walls, COARSEST_WALLS))
    return robot.context.get(
        computed_beam_vibration, robot.postures, mesh, ends, preset, robot.computed_count
    )


# Beams with computed section constants: first free to warp at their ends, then with warping
# restrained at rigid ends.
COMPUTED_BEAMS = Model(
    "constants from the section's mesh",
    statics=computed_statics,
    modes=_computed_modes,
    static_fields=("section_mesh",),
    modal_fields=("section_mesh",),
)
WARPING_BEAMS = Model(
    "restrained warping",
    statics=partial(_spring_statics, warping_spring),
    modes=_warping_modes,
    static_fields=("ends",),
    modal_fields=("ends", "section_mesh"),
)
# The reference model of statics and modes. If uncertain inputs change by a few per cent, it is not
# solved anew: the changes of WARPING_BEAMS are applied to its solution.
SOLID = Model(
    "solid",
    statics=solid_statics,
    modes=modes_of_solids,
    static_fields=("ends", "masses", "mesh", "part_mesh"),
    modal_fields=("ends", "masses", "interior", "mesh", "part_mesh"),
    stand_in=WARPING_BEAMS,
)
# Beams with computed section constants, stiffened by rigid end faces that hinder contraction.
RESTRAINED = Model(
    "restrained contraction",
    statics=partial(_spring_statics, restrained_spring),
    static_fields=("ends",),
)
# Beams with the compliance and the mass of solids at corners and steps: in statics those of
# `RESTRAINED`, in modes those of `WARPING_BEAMS`.
WITH_JUMPS = Model(
    "corners and steps",
    statics=partial(_spring_statics, _with_jumps),
    modes=_modes_with_jumps,
    static_fields=("ends",),
    modal_fields=("ends", "section_mesh"),
)
# Three models with one tip compliance per leg: the 6×6 of the file; this 6×6 with only the entries
# that a straight prismatic leg has; the 6×6 of the equivalent prism.
GIVEN = Model("specified legs", statics=partial(_spring_statics, _given))
STRAIGHT = Model("straight legs", statics=partial(_spring_statics, _straight))
EQUIVALENT = Model("equivalent legs", statics=partial(_spring_statics, _equivalent))
# Steps that remove the errors of parts modelled as equivalent legs, in order.
PART_STEPS: Mapping[str, Step] = {
    "stepped": Step(
        "part replaced by a leg of one constant section",
        "ten prismatic beam pieces with the sections of the part",
        with_parts("stepped"),
        Remedy("divide the parts into prismatic pieces: --parts stepped", "--parts"),
    ),
    "condensed": Step(
        "part replaced by prismatic beam pieces",
        "part condensed to its interfaces",
        with_parts("condensed"),
        Remedy("condense the parts to their interfaces: --parts condensed", "--parts"),
    ),
}
