"""Natural modes of the biglide over its stroke: by solids, by beams between, by rigid legs."""

from functools import partial

import numpy as np

from fem.reduction.craig_bampton import craig_bampton
from lumped.arrays import Array
from lumped.biglide import Biglide, system, with_equivalent_legs
from lumped.legs import Ends, GivenLeg, Leg, equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.models import simplified
from lumped.system.solution import mode_count, solved
from validation.adequacy.biglide.statics import left_open
from validation.adequacy.legs import SECTION_DIVISIONS, own_elements
from validation.adequacy.mechanism.dynamics import reduced_title
from validation.adequacy.response import Vibration
from validation.adequacy.subject.given_masses import Masses, leg_with_masses
from validation.adequacy.subject.posed import Dynamics, Fineness, Holds
from validation.agreement.mode_pairing import centreline_samples
from validation.context import Context
from validation.models.biglide import highest_frequency
from validation.models.options import ModelName, ModelOptions
from validation.solids.robots import held_solid
from validation.studies.paired_robot_modes import (
    ELEMENTS,
    OFFERED,
    STATIONS,
    LegDivisions,
    SampledModes,
    divisions_of,
    model_modes,
    sample_weights,
    sampled_modes,
    solid_modes,
)


def biglide_dynamics(context: Context, robot: Biglide, judged: int, postures: int) -> Dynamics:
    """What computes natural modes in so many postures over the stroke, as the cases have them."""
    legs = {"leg1": robot.leg1, "leg2": robot.leg2}
    given = any(isinstance(leg, GivenLeg) for leg in legs.values())
    coarse, fine = divisions_of([equivalent_leg(leg) for leg in legs.values()], context.preset)

    def solid(mesh: Fineness, holds: Holds, masses: Masses | None, _: int) -> Vibration:
        divisions, ends = fine if mesh == "fine" else coarse, _of_both(holds)
        if masses is None:
            # As the cases ask for it, so that both share the solids.
            same: Ends | tuple[Ends, Ends] = ends[0] if ends[0] == ends[1] else ends
            return _vibration(context.get(solid_modes, robot, divisions, same, postures))
        asked = divisions, ends, masses, postures
        return _vibration(context.get(modes_with_masses, robot, *asked))

    def own(holds: Holds | None, divisions: LegDivisions = (SECTION_DIVISIONS,) * 2) -> Vibration:
        ends = None if holds is None else _of_both(holds)
        return _vibration(context.get(own_modes, robot, ends, divisions, postures))

    return Dynamics(
        context,
        reduced_title("robot", legs),
        legs,
        left_open(robot),
        None,
        judged=judged,
        weights=sample_weights(robot),
        ratio=min(one / other for other, one in zip(coarse, fine, strict=True)),
        answer=partial(model_vibration, context, robot, postures),
        solid=solid,
        own=own,
        sections=lambda holds: (own(holds, fine), own(holds)),
        rigid="legs and feet rigid",
        computed_by="validation.adequacy.subject.given_masses.leg_with_masses"
        if given
        else "validation.studies.paired_robot_modes.solid_modes",
    )


def model_vibration(
    context: Context, robot: Biglide, postures: int, model: ModelName, options: ModelOptions
) -> Vibration:
    """What one of the models that have masses says of natural modes."""
    if model == "simplified":
        return context.get(simplified_modes, robot, postures)
    asked = model, options.theory, options.elements, postures
    return _vibration(context.get(model_modes, robot, *asked))


def _vibration(modes: SampledModes) -> Vibration:
    return Vibration(modes.frequencies, modes.samples)


def _of_both(holds: Holds) -> tuple[Ends, Ends]:
    return holds["leg1"], holds["leg2"]


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


def own_modes(
    robot: Biglide, ends: tuple[Ends, Ends] | None, divisions: LegDivisions, postures: int
) -> SampledModes:
    """Modes by beams of the sections' own constants; with warping, held as `ends` say."""
    first, second = ends or (None, None)
    leg1 = own_elements(robot.leg1, first, ELEMENTS, divisions[0])
    leg2 = own_elements(robot.leg2, second, ELEMENTS, divisions[1])
    return sampled_modes(robot, (leg1, leg2), postures)


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
