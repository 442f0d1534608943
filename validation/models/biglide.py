"""The models of the biglide behind one name each, as `solve` and the cases use them."""

from dataclasses import replace
from functools import partial

from lumped.arrays import Array
from lumped.biglide import Biglide, postures, printed, system
from lumped.errors import InputError
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.models import simplified, vjm
from lumped.models.bodies import tip_compliances
from lumped.models.links import links
from lumped.models.segments import static_leg
from lumped.system.assembly import System, assemble
from lumped.system.solution import compliance, modes, rounding, solved
from validation.models.legs import cached_leg, condensed_leg, filled, leg_chain, reduced_leg
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.solids.robots import half_octave_above, renewed_where_needed

# Of closed sections: the faces of open ones may restrain torsion by far more.
_STIFFER_THAN_BEAMS = 1.2


def robot_legs(
    model: ModelName, robot: Biglide, options: ModelOptions = DEFAULT_OPTIONS
) -> tuple[LegMatrices, LegMatrices]:
    """Both equivalent legs as the robot by `segments` or `beam` uses them.

    With `release="printed"` leg 2 carries the joint at its tip as eq. (25) prints it. Raises
    InputError for any other model.
    """
    leg1, leg2 = _equivalent_legs(robot, options)
    own = replace(options, release="condensed")
    return cached_leg(model, leg1, own), cached_leg(model, leg2, options)


def _equivalent_legs(robot: Biglide, options: ModelOptions) -> tuple[ConstantLeg, ConstantLeg]:
    return (
        equivalent_leg(robot.leg1, options.equivalent),
        equivalent_leg(robot.leg2, options.equivalent),
    )


def _static_legs(robot: Biglide, options: ModelOptions) -> tuple[LegMatrices, LegMatrices]:
    """Both legs in segments, condensed to their ends."""
    leg1, leg2 = _equivalent_legs(robot, options)
    own = replace(options, release="condensed")
    return static_leg(leg_chain(leg1, own)), static_leg(leg_chain(leg2, options))


def robot_system(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions = DEFAULT_OPTIONS
) -> System:
    """The whole robot by `segments` or `beam` with B at `x` (m), equivalent legs."""
    return _joined(model, robot, x, robot_legs(model, robot, options), options)


def static_system(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions = DEFAULT_OPTIONS
) -> System:
    """What the statics by `links`, `segments`, `beam` or `solid` are solved on.

    Equivalent legs, but by `links` where the 6×6 as given is asked for.
    """
    if model == "links":
        (at,) = postures(robot, (x,))
        springs = tip_compliances(at.mechanism, options.legs, options.theory, options.equivalent)
        return assemble(at, links(at.mechanism, springs))
    if model == "segments":
        return _joined(model, robot, x, _static_legs(robot, options), options)
    if model == "solid":
        leg1, leg2 = (
            condensed_leg("solid", leg, options) for leg in _equivalent_legs(robot, options)
        )
        return system(robot, x, filled(leg1), filled(leg2))
    return robot_system(model, robot, x, options)


def _joined(
    model: ModelName,
    robot: Biglide,
    x: float,
    legs: tuple[LegMatrices, LegMatrices],
    options: ModelOptions,
) -> System:
    (at,) = postures(robot, (x,))
    if model == "segments" and options.release == "printed":
        at = replace(at, mechanism=printed(at.mechanism))
    return assemble(at, {"leg1": filled(legs[0]), "leg2": filled(legs[1])})


def robot_compliance(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Compliance (SI, robot axes) at the loaded point: 6×6, or 2×2 (x, y) for `simplified`."""
    if model == "simplified":
        return simplified.compliance(robot, x)
    if model == "vjm":
        return vjm.compliance(robot, x, _leg_springs(robot, options))
    return compliance(solved(static_system(model, robot, x, options)))


def rounded_compliance(model: ModelName, robot: Biglide, x: float, options: ModelOptions) -> Array:
    """What rounding leaves open of it (95 %, of both signs), but by `simplified`."""
    if model == "vjm":
        return vjm.rounding(vjm.biglide_chains(robot, x, _leg_springs(robot, options)))
    system = static_system(model, robot, x, options)
    return rounding(system, solved(system).displacements(system.tool.T))


def _leg_springs(robot: Biglide, options: ModelOptions) -> tuple[Array, Array]:
    if options.legs == "given":
        return vjm.given_leg_springs(robot)
    return vjm.equivalent_leg_springs(robot, options.theory, options.equivalent)


def robot_frequencies(
    model: ModelName, robot: Biglide, x: float, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """First natural frequencies (Hz, ascending); `simplified` has two.

    Raises InputError for `vjm` and `links`, which have no mass.
    """
    if model in STATIC:
        raise InputError(f"--modes: the {model} model is static and has no frequencies")
    if model == "simplified":
        return simplified.frequencies(robot, x)[:count]
    if model == "solid":
        return renewed_where_needed(
            highest_frequency(robot, x, count, options),
            partial(_solid_frequencies, robot, x, count, options),
            frequencies=lambda found: found,
        )
    return modes(solved(robot_system(model, robot, x, options)), count).frequencies


def _solid_frequencies(
    robot: Biglide, x: float, count: int, options: ModelOptions, highest: float
) -> Array:
    leg1, leg2 = (
        reduced_leg("solid", leg, options, highest) for leg in _equivalent_legs(robot, options)
    )
    return modes(solved(system(robot, x, filled(leg1), filled(leg2))), count).frequencies


def highest_frequency(
    robot: Biglide, x: float, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> float:
    """Frequency (Hz) up to which solid legs should be good for the first `count` of the robot.

    The beam model's with a margin, rounded up in steps of half an octave.
    """
    beam = robot_frequencies("beam", robot, x, count, options)[-1]
    return half_octave_above(_STIFFER_THAN_BEAMS * float(beam))
