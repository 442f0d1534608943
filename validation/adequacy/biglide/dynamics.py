"""Natural modes of the biglide over its stroke: models, ladders of causes, and the reference."""

from collections.abc import Mapping
from functools import partial
from itertools import product

import numpy as np

from fem.beams.beam import beam_leg
from fem.beams.warping_beam import warping_beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.sections.section_constants import beam_properties
from lumped.arrays import Array
from lumped.biglide import Biglide, system, with_equivalent_legs
from lumped.legs import BeamProperties, ConstantLeg, Ends, GivenLeg, Leg, equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.models import simplified
from lumped.system.solution import mode_count, solved
from validation.adequacy.biglide.statics import SAY_ENDS, holds
from validation.adequacy.common.given_masses import MASSES, Masses, leg_with_masses
from validation.adequacy.common.ladders import Refined, dynamic_rungs, dynamic_upper_rungs
from validation.adequacy.common.references import (
    dynamic_reference_of,
    finer_preset,
    largest_change,
    meshed_alternative,
    why_unmeshed,
)
from validation.adequacy.legs import OPEN_ENDS, own_constants
from validation.adequacy.models import JUDGED
from validation.adequacy.response import (
    UNSOLVED,
    Reference,
    Response,
    Rung,
    Vibration,
    modes_of,
)
from validation.agreement.mode_pairing import centreline_samples
from validation.context import Context
from validation.models.biglide import highest_frequency
from validation.solids.robots import held_solid
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    OFFERED,
    STATIONS,
    LegDivisions,
    SampledModes,
    divisions_of,
    model_modes,
    own_beam_modes,
    sample_weights,
    sampled_modes,
    solid_modes,
)

# Second order in 1/n: twice the segments leave a quarter of the error.
FINER_SEGMENTS = 2 * ELEMENTS


def vibration(modes: SampledModes) -> Vibration:
    """Frequencies and samples of shapes of any model."""
    return Vibration(modes.frequencies, modes.samples)


def dynamic_reference(context: Context, robot: Biglide, modes: int, postures: int) -> Reference:
    """Solid legs reduced to their ends or, where legs are given, a bracket of plausible masses."""
    legs = robot.leg1, robot.leg2
    given = any(isinstance(leg, GivenLeg) for leg in legs)
    masses: tuple[Masses | None, ...] = MASSES if given else (None,)
    solid = any(isinstance(leg, ConstantLeg) for leg in legs)
    nothing_open: dict[str, tuple[Ends, Ends]] = {"": ("rigid", "rigid")}
    ends = holds(robot) if solid else nothing_open
    divisions = divisions_of([equivalent_leg(leg) for leg in legs], context.preset)
    if reason := why_unmeshed(legs, context.preset):
        return Reference("none", (), decides=reason)
    ratio = min(fine / coarse for coarse, fine in zip(*divisions, strict=True))
    if not solid:
        # Nothing is meshed: one solution serves for both.
        divisions = divisions[1], divisions[1]
    weights = sample_weights(robot)
    section = _section_uncertainty(context, robot, divisions[1], modes, postures) if solid else 0.0
    alternatives = []
    for (name, hold), mass in product(ends.items(), masses):
        coarse, fine = (
            vibration(_reference_modes(context, robot, number, hold, mass, postures))
            for number in divisions
        )
        said = ", ".join(part for part in (name, mass) if part)
        alternatives.append(meshed_alternative(said, coarse, fine, weights, modes, ratio, section))
    several = len(ends) > 1
    return dynamic_reference_of(
        "robot of the legs' own 6×6 and plausible masses"
        if given
        else "robot of solid legs, reduced to their ends",
        alternatives,
        "validation.adequacy.common.given_masses.leg_with_masses"
        if given
        else "validation.studies.paired_robot_modes.solid_modes",
        left_open=OPEN_ENDS if several else "",
        says=SAY_ENDS if several else "",
        finer=finer_preset(legs, context.preset),
        given=given,
    )


def _section_uncertainty(
    context: Context, robot: Biglide, divisions: LegDivisions, modes: int, postures: int
) -> Array:
    """What the section mesh of both solids leaves open of frequencies (p×1, relative).

    Walls keep one mesh across while elements become shorter. By beams of the constants of that
    mesh and of a finer one, the largest over the modes.
    """
    coarse = vibration(context.get(own_beam_modes, robot, divisions, postures))
    fine = vibration(context.get(own_modes, robot, None, postures))
    return largest_change(coarse, fine, sample_weights(robot), modes)


def _reference_modes(
    context: Context,
    robot: Biglide,
    divisions: LegDivisions,
    ends: tuple[Ends, Ends],
    masses: Masses | None,
    postures: int,
) -> SampledModes:
    if masses is None:
        # As the cases ask for it, so that both share the solids.
        same: Ends | tuple[Ends, Ends] = ends[0] if ends[0] == ends[1] else ends
        return context.get(solid_modes, robot, divisions, same, postures)
    return context.get(modes_with_masses, robot, divisions, ends, masses, postures)


def modes_with_masses(
    robot: Biglide,
    divisions: LegDivisions,
    ends: tuple[Ends, Ends],
    masses: Masses,
    postures: int,
) -> SampledModes:
    """Modes of the robot with its given legs' own 6×6 and `masses`; other legs are solids."""
    first, last = robot.stroke
    places = first, robot.centre, last
    highest = 2.0 * max(highest_frequency(robot, at, OFFERED) for at in places)

    def built(leg: Leg, number: int, hold: Ends) -> LegMatrices:
        if isinstance(leg, GivenLeg):
            return leg_with_masses(leg, masses, highest)
        return craig_bampton(held_solid(leg, number, hold), highest).matrices

    legs = built(robot.leg1, divisions[0], ends[0]), built(robot.leg2, divisions[1], ends[1])
    # Lumps that are points have no more modes than they and the platform have ways to go.
    known = mode_count(solved(system(with_equivalent_legs(robot), robot.centre, *legs)))
    return sampled_modes(robot, legs, postures, min(OFFERED, known))


def own_modes(robot: Biglide, ends: tuple[Ends, Ends] | None, postures: int) -> SampledModes:
    """Modes by beams of the sections' own constants; with warping, held as `ends` say."""

    def built(leg: Leg, which: int) -> LegMatrices:
        constant = equivalent_leg(leg)
        constants, material = own_constants(constant), constant.material
        if ends is None:
            properties: BeamProperties = beam_properties(constants, material)
            return beam_leg(properties, constant.length, ELEMENTS)
        hold = ends[which]
        return warping_beam_leg(constants, material, constant.length, ELEMENTS, hold)

    return sampled_modes(robot, (built(robot.leg1, 0), built(robot.leg2, 1)), postures)


def simplified_modes(robot: Biglide, postures: int) -> Vibration:
    """Both modes of the simplified model, legs turning as rigid bodies between slides and B.

    NaN and zeros for the mode that it does not have at an end of the stroke, where it is rigid.
    """
    frequencies, samples = [], []
    for x in robot.stations(postures).tolist():
        jacobian = simplified.jacobian(robot, x)
        # J K⁻¹ Jᵀ M of one stiffness and one mass: modes of B are the left singular vectors of J.
        velocities, sizes, slides = np.linalg.svd(jacobian)
        found = simplified.frequencies(robot, x)
        known = np.isfinite(found)
        rates = [_rigid_legs(robot, x, velocities[:, k] * sizes[k], slides[k]) for k in range(2)]
        frequencies.append(np.where(known, found, np.nan))
        samples.append(np.column_stack(rates))
    return Vibration(np.array(frequencies), np.array(samples))


def _rigid_legs(robot: Biglide, x: float, velocity: Array, slides: Array) -> Array:
    """What is sampled of a motion: B moves with `velocity` (x, y), the slides along y."""
    posture = robot.posture(x)
    tip = np.array([velocity[0], velocity[1], 0.0])
    rows = [tip]
    ends = ((posture.rotation1, robot.leg1, slides[0]), (posture.rotation2, robot.leg2, slides[1]))
    for rotation, leg, slide in ends:
        root = np.array([0.0, slide, 0.0])
        stations, _ = centreline_samples(leg.length, STATIONS)
        own_root, own_tip = rotation.T @ root, rotation.T @ tip
        share = (stations / leg.length)[:, None]
        twists = np.zeros((len(stations), 6))
        twists[:, :3] = (1.0 - share) * own_root + share * own_tip
        twists[:, 5] = (own_tip[1] - own_root[1]) / leg.length
        rows.append(twists.ravel())
    return np.concatenate(rows)


_WITH_MASSES = (
    "simplified",
    "segments",
    "beam",
    "segments-euler-bernoulli",
    "beam-euler-bernoulli",
)


def vibrations(context: Context, robot: Biglide, postures: int) -> dict[str, Response]:
    """What every model says of natural modes, by name: nothing where it has no masses."""
    return {"vjm": Response(), "vjm-equivalent": Response()} | {
        name: modes_of(partial(vibration_of, context, robot, name, postures))
        for name in _WITH_MASSES
    }


def vibration_of(context: Context, robot: Biglide, name: str, postures: int) -> Vibration:
    """What one of the models that have masses says of natural modes."""
    if name == "simplified":
        return context.get(simplified_modes, robot, postures)
    model, _, options = JUDGED[name]
    theory = options.theory
    return vibration(context.get(model_modes, robot, model, theory, ELEMENTS, postures))


def dynamic_ladders(
    context: Context,
    robot: Biglide,
    found: Mapping[str, Response],
    reference: Reference,
    postures: int,
) -> dict[str, tuple[Rung, ...]]:
    """Rungs for frequencies by name of the model, each ladder from the model upwards."""
    names = [one.name for one in reference.alternatives]
    if not names:
        return {}
    finer = modes_of(
        lambda: vibration(
            context.get(model_modes, robot, "segments", "timoshenko", FINER_SEGMENTS, postures)
        )
    )
    upper = () if reference.bracket else _upper(context, robot, names, postures)
    return dynamic_rungs(names, found, Refined(ELEMENTS, finer), upper, "legs and feet rigid")


def _upper(context: Context, robot: Biglide, names: list[str], postures: int) -> tuple[Rung, ...]:
    def own(ends: tuple[Ends, Ends] | None) -> Response:
        return modes_of(lambda: vibration(context.get(own_modes, robot, ends, postures)), UNSOLVED)

    warping = {name: own(ends) for name, ends in holds(robot).items()}
    return dynamic_upper_rungs(names, own(None), warping)
