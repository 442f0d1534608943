"""The first screen's reference: robots and legs of solids, once more by CalculiX and polynomials.

CalculiX gives the 6×6 of every leg on tetrahedra of its own, Ritz's method joins them: neither the
solid elements here, nor doubling, nor the assembler has a part in it. Rigid end faces, for which
solids are stiffest. Where the legs are known by a 6×6, the robot of those is what others are held
against, and polynomials join them.
"""

import numpy as np

from fem.calculix.leg import compliance_and_frequencies
from fem.calculix.run import calculix_program
from lumped.acceptance.requirement import AXES
from lumped.arrays import Array
from lumped.biglide import Biglide, postures
from lumped.legs import ConstantLeg, Ends, GivenLeg, given_compliance
from lumped.sections import Circle, Rectangle
from meshes.prism.tetrahedra import tetrahedra
from validation.adequacy.biglide.dynamics import modes_with_masses
from validation.adequacy.biglide.subject import POSTURES
from validation.adequacy.legs import UNKNOWNS
from validation.adequacy.mechanism.statics import assembled
from validation.adequacy.subject.given_masses import MASSES, Masses
from validation.agreement.convergence import PROVEN, step_factor
from validation.case import Measurement, Relative, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.anchors.quantities import RITZ, SHOWN, TITLE, in_shown_units, statics
from validation.context import Context, Preset
from validation.exhibits import SOLID_ROBOT
from validation.models.legs import constant_leg_of
from validation.solids.legs import CORNER_ORDER, doubled_tip, formal_order, static_ladder
from validation.solids.robots import mesh_pair
from validation.solids.size import skip_too_large
from validation.studies.paired_robot_modes import divisions_of
from validation.studies.quantities import farthest
from validation.studies.ritz import biglide as ritz

# Divisions of the tetrahedra across the smaller side, coarse and fine.
DIVISIONS: dict[Preset, tuple[int, int]] = {"quick": (1, 2), "standard": (1, 2), "fine": (2, 3)}
_ALONE = "CalculiX CrunchiX, C3D10, six unit wrenches on a rigid face"
_JOINED = f"{_ALONE}; the legs' 6×6 joined by Ritz's method (validation.studies.ritz)"
_TOLERANCE = Relative(0.03)
_REASON = (
    "two families of meshes that share nothing but the shape: torsion on tetrahedra, one or two "
    "across the smaller side, is 2.4 and 1 % off"
)


_LATER: tuple[Preset, ...] = ("standard", "fine")
_AT = "{said}, posture of the largest difference"
cases = statics.like(section=SOLID_ROBOT)
cases_of_legs = statics.like(section="Leg {number}")
# Of the robot of the legs' own 6×6 with each of the plausible masses.
cases_of_masses = CaseGroup(section=SOLID_ROBOT)


def solid_tips(leg: ConstantLeg, most: int) -> Array:
    """Tip compliances (2×6×6, coarse and fine, SI, leg axes) as the first screen has them."""
    return np.array([doubled_tip(leg, *mesh, "rigid") for mesh in mesh_pair(leg, most)])


def calculix_tips(leg: ConstantLeg, divisions: tuple[int, int]) -> Array:
    """The same by CalculiX on two meshes. Raises CalculixMissing without it."""
    calculix_program()
    meshes = (tetrahedra(leg.section, leg.length, number) for number in divisions)
    return np.array([compliance_and_frequencies(mesh, leg.material, 1)[0] for mesh in meshes])


def assembled_statics(robot: Biglide, first: Array, second: Array) -> Array:
    """Diagonals of the 6×6 (2 meshes × postures × 6) of the robot of such legs."""
    return np.array([_assembled(robot, *pair) for pair in zip(first, second, strict=True)])


def _assembled(robot: Biglide, first: Array, second: Array) -> Array:
    """Diagonals of the 6×6 (postures × 6) of the robot of legs of such tips."""
    places = postures(robot, robot.stations(POSTURES))
    return np.diagonal(assembled(places, {"leg1": first, "leg2": second}), axis1=1, axis2=2)


def polynomial_statics(robot: Biglide, first: Array, second: Array) -> Array:
    """The same by polynomials."""
    x = robot.stations(POSTURES).tolist()
    return np.array(
        [
            [np.diag(ritz.of_springs(robot, at, *pair)) for at in x]
            for pair in zip(first, second, strict=True)
        ]
    )


def own_statics(robot: Biglide) -> Array:
    """Diagonals of the 6×6 (postures × 6) of the robot assembled from its legs' own 6×6."""
    return _assembled(robot, given_compliance(robot.leg1), given_compliance(robot.leg2))


def joined_statics(robot: Biglide) -> Array:
    """The same by polynomials."""
    return np.array(
        [np.diag(ritz.compliance(robot, x, "given")) for x in robot.stations(POSTURES).tolist()]
    )


def expected_swinging(robot: Biglide, masses: Masses, count: int) -> Array:
    """Frequencies (postures × count, Hz) by polynomials."""
    lumped = masses != MASSES[0]
    return np.array(
        [
            ritz.frequencies_with_masses(robot, x, count, lumped=lumped)
            for x in robot.stations(POSTURES).tolist()
        ]
    )


@cases_of_masses.case(
    "robot.anchor.masses[{masses}, {mode}]",
    "The robot of its legs' own 6×6, {masses}: frequency {mode}, obtained once more without its "
    "code",
    over={"masses": MASSES, "index, mode": numbered},
    headlines=("robot.frequencies.own",),
    quantity="natural frequency {mode}, posture of the largest difference",
    unit="Hz",
    reference_kind="independent-solver",
    citation=RITZ,
    tolerance=Relative(1e-4),
    tolerance_reason="20 beam elements between the ends, reduced: below 1e-5",
    group="robot.solid.modes",
    effort=0.2,
)
def _swinging(context: Context, masses: Masses, index: int, modes: int) -> Measurement:
    robot = context.robot
    if not all(isinstance(leg, GivenLeg) for leg in (robot.leg1, robot.leg2)):
        raise Skip("the legs are prisms, whose masses are known")
    # As the first screen asks for them: no leg is meshed.
    _, fine = divisions_of([constant_leg_of(context, number) for number in (1, 2)], context.preset)
    held: tuple[Ends, Ends] = ("rigid", "rigid")
    found = context.get(modes_with_masses, robot, fine, held, masses, POSTURES).frequencies
    expected = context.get(expected_swinging, robot, masses, modes)[:, index]
    at = farthest(found[:, index], expected)
    return Measurement(
        float(found[at, index]),
        float(expected[at]),
        # What elements and reduction leave is what is judged, against polynomials that leave none.
        judged_uncertainty=0.0,
        pose=(float(robot.stations(POSTURES)[at]),),
    )


def _require_affordable(context: Context, *legs: ConstantLeg) -> None:
    hollow = {leg.section.shape for leg in legs if not isinstance(leg.section, Rectangle | Circle)}
    if hollow:
        raise Skip(
            f"{', '.join(sorted(hollow))}: tetrahedra as small as walls would keep CalculiX for "
            "minutes"
        )

    finest = [DIVISIONS[context.preset][1]] * len(legs)
    skip_too_large(legs, finest, context.preset)
    if not all(context.get(static_ladder, leg, _most(context)) for leg in legs):
        raise Skip(f"the section meshes of preset {context.preset} are too coarse for two of them")


def _most(context: Context) -> int:
    return UNKNOWNS[context.preset][0]


@cases.case(
    "robot.anchor.reference[{entry}]",
    TITLE,
    over={
        "of, model": [("The robot of solid legs, rigid faces", "solid")],
        "entry, said, unit": SHOWN,
    },
    headlines=("robot.statics.solid",),
    quantity=_AT,
    citation=_JOINED,
    tolerance=_TOLERANCE,
    tolerance_reason=_REASON,
    presets=_LATER,
    group="robot.anchor.reference",
)
def _robot(context: Context, entry: str) -> Measurement:
    robot, index = context.robot, AXES.index(entry)
    legs = constant_leg_of(context, 1), constant_leg_of(context, 2)
    _require_affordable(context, *legs)
    solid = [context.get(solid_tips, leg, _most(context)) for leg in legs]
    theirs = [_by_calculix(context, leg) for leg in legs]
    found = context.get(assembled_statics, robot, solid[0], solid[1])
    expected = context.get(polynomial_statics, robot, theirs[0], theirs[1])
    at = farthest(found[1, :, index], expected[1, :, index])
    return _measured(found[:, at, index], expected[:, at, index], entry, legs, context)


@cases.case(
    "robot.anchor.own[{entry}]",
    TITLE,
    over={
        "of, model": [("The robot of its legs' own 6×6", "assembled")],
        "entry, said, unit": SHOWN,
    },
    headlines=("robot.statics.own",),
    quantity=_AT,
    citation="the legs' 6×6 joined by Ritz's method (validation.studies.ritz)",
    group="robot.anchor",
)
def _own(context: Context, entry: str) -> Measurement:
    robot, index = context.robot, AXES.index(entry)
    if not all(isinstance(leg, GivenLeg) for leg in (robot.leg1, robot.leg2)):
        raise Skip("the legs are prisms: the robot of solids is what others are held against")
    found = context.get(own_statics, robot)[:, index]
    expected = context.get(joined_statics, robot)[:, index]
    at = farthest(found, expected)
    return Measurement(
        in_shown_units(found[at], entry),
        in_shown_units(expected[at], entry),
        exact=True,
        pose=(float(robot.stations(POSTURES)[at]),),
    )


@cases_of_legs.case(
    "leg{number}.anchor.reference[{entry}]",
    TITLE,
    over={
        "number, of, model": tuple(
            (number, f"Leg {number} as a solid, rigid faces, root clamped", "solid")
            for number in (1, 2)
        ),
        "entry, said, unit": SHOWN,
    },
    headlines=("leg{number}.statics.solid",),
    citation=_ALONE,
    tolerance=_TOLERANCE,
    tolerance_reason=_REASON,
    presets=_LATER,
    group="robot.anchor.reference",
)
def _leg(context: Context, number: int, entry: str) -> Measurement:
    index, leg = AXES.index(entry), constant_leg_of(context, number)
    _require_affordable(context, leg)
    found = context.get(solid_tips, leg, _most(context))[:, index, index]
    expected = _by_calculix(context, leg)[:, index, index]
    return _measured(found, expected, entry, (leg,), context)


def _by_calculix(context: Context, leg: ConstantLeg) -> Array:
    return context.get(calculix_tips, leg, DIVISIONS[context.preset])


def _measured(
    found: Array,
    expected: Array,
    entry: str,
    legs: tuple[ConstantLeg, ...],
    context: Context,
) -> Measurement:
    """From numbers of two meshes each, coarse and fine."""
    order = min(formal_order(leg, "rigid") for leg in legs)
    coarse_across, across = DIVISIONS[context.preset]
    pairs = [mesh_pair(leg, _most(context)) for leg in legs]
    ratio = min(fine / coarse for (_, coarse), (_, fine) in pairs)
    value, reference = (in_shown_units(numbers[1], entry) for numbers in (found, expected))
    steps = [abs(in_shown_units(numbers[1] - numbers[0], entry)) for numbers in (found, expected)]
    return Measurement(
        value,
        reference,
        value_uncertainty=step_factor(ratio, order) * steps[0],
        # So few elements across are before the range of fourth order: 1.3 is what they show.
        reference_uncertainty=PROVEN / ((across / coarse_across) ** CORNER_ORDER - 1.0) * steps[1],
    )
