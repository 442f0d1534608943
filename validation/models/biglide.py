"""The models of a leg and of the robot behind one name each, as `solve` and the cases use them."""

from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Literal, TypeAlias

from fem.bodies import leg_modes, solid
from fem.bodies.beam import beam_leg
from fem.bodies.solid import ClampedLeg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import HeldLeg, static_superelement
from lumped import biglide_assembly as mechanism
from lumped import simplified, vjm
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.biglide_assembly import Mechanism, Release
from lumped.cantilever import clamped_modes, tip_compliance_of
from lumped.errors import InputError
from lumped.leg_matrices import LegMatrices
from lumped.legs import (
    ConstantLeg,
    EquivalentBy,
    Leg,
    Theory,
    equivalent_leg,
    given_compliance,
    tip_compliance,
)
from lumped.modes import Modes
from lumped.segments import (
    Chain,
    Layout,
    segment_chain,
    segment_leg,
    static_leg,
    with_printed_tip_joint,
)
from validation.robot_solids import half_octave_above, held_solid, renewed_where_needed

ModelName: TypeAlias = Literal["simplified", "vjm", "segments", "beam", "solid"]
LegSprings: TypeAlias = Literal["given", "equivalent"]
Ends: TypeAlias = Literal["rigid", "free"]


@dataclass(frozen=True)
class ModelOptions:
    """Options of the models, as on the command line.

    `legs` (vjm): each leg's own 6×6 or that of its equivalent constant-section leg; `theory`
    (segments, beam, vjm with equivalent legs); `elements` per leg (segments, beam); `release`,
    `layout` (segments); `ends`, `divisions` (solid); `equivalent`: which diagonal is matched.
    """

    legs: LegSprings = "given"
    theory: Theory = "timoshenko"
    elements: int = 20
    release: Release = "condensed"
    layout: Layout = "half"
    ends: Ends = "rigid"
    divisions: int = 4
    equivalent: EquivalentBy = "stiffness"


DEFAULT_OPTIONS = ModelOptions()
# Of closed sections: the faces of open ones may restrain torsion by far more.
_STIFFER_THAN_BEAMS = 1.2


def leg_matrices(
    model: ModelName, leg: ConstantLeg, options: ModelOptions = DEFAULT_OPTIONS
) -> LegMatrices:
    """Matrices of one free leg by `segments` or `beam`.

    Raises InputError for any other model.
    """
    if model == "segments":
        return segment_leg(_chain(leg, options))
    if model != "beam":
        raise InputError(f"the {model} model has no leg matrices that suit every frequency")
    return beam_leg(leg.properties(options.theory), leg.length, options.elements)


def robot_legs(
    model: ModelName, robot: Biglide, options: ModelOptions = DEFAULT_OPTIONS
) -> tuple[LegMatrices, LegMatrices]:
    """Both equivalent legs as the robot by `segments` or `beam` uses them.

    With `release="printed"` leg 2 carries the joint at its tip as eq. (25) prints it. Raises
    InputError for any other model.
    """
    leg1, leg2 = _equivalent_legs(robot, options)
    if model == "segments" and options.release == "printed":
        released = with_printed_tip_joint(_chain(leg2, options))
        return _cached_leg(model, leg1, options), segment_leg(released)
    return _cached_leg(model, leg1, options), _cached_leg(model, leg2, options)


def _equivalent_legs(robot: Biglide, options: ModelOptions) -> tuple[ConstantLeg, ConstantLeg]:
    return (
        equivalent_leg(robot.leg1, options.equivalent),
        equivalent_leg(robot.leg2, options.equivalent),
    )


def _static_legs(robot: Biglide, options: ModelOptions) -> tuple[LegMatrices, LegMatrices]:
    """Both legs in segments, condensed to their ends."""
    chain1, chain2 = (_chain(leg, options) for leg in _equivalent_legs(robot, options))
    if options.release == "printed":
        chain2 = with_printed_tip_joint(chain2)
    return static_leg(chain1), static_leg(chain2)


def _chain(leg: ConstantLeg, options: ModelOptions) -> Chain:
    properties = leg.properties(options.theory)
    return segment_chain(properties, leg.length, options.elements, options.layout)


def robot_mechanism(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions = DEFAULT_OPTIONS
) -> Mechanism:
    """The whole robot by `segments` or `beam` with B at `x` (m), equivalent legs."""
    release = options.release if model == "segments" else "condensed"
    return mechanism.assemble(robot, x, *robot_legs(model, robot, options), release)


@lru_cache(maxsize=64)
def _cached_leg(model: ModelName, leg: ConstantLeg, options: ModelOptions) -> LegMatrices:
    """A leg only turns from posture to posture: its matrices are built once."""
    return leg_matrices(model, leg, options)


def robot_compliance(
    model: ModelName, robot: Biglide, x: float, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """Compliance (SI, robot axes) at the loaded point: 6×6, or 2×2 (x, y) for `simplified`."""
    if model == "simplified":
        return simplified.compliance(robot, x)
    if model == "vjm":
        springs = (
            vjm.given_leg_springs(robot)
            if options.legs == "given"
            else vjm.equivalent_leg_springs(robot, options.theory, options.equivalent)
        )
        return vjm.compliance(robot, x, springs)
    if model == "segments":
        legs = _static_legs(robot, options)
        return mechanism.compliance(mechanism.assemble(robot, x, *legs, options.release))
    if model == "solid":
        leg1, leg2 = (
            _static_solid(leg, options.divisions, options.ends)
            for leg in _equivalent_legs(robot, options)
        )
        return mechanism.compliance(mechanism.assemble(robot, x, leg1, leg2))
    return mechanism.compliance(robot_mechanism(model, robot, x, options))


def robot_frequencies(
    model: ModelName, robot: Biglide, x: float, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """First natural frequencies (Hz, ascending); `simplified` has two.

    Raises InputError for `vjm`, which has no mass.
    """
    if model == "vjm":
        raise InputError("--modes: the vjm model is static and has no frequencies")
    if model == "simplified":
        return simplified.frequencies(robot, x)[:count]
    if model == "solid":
        return renewed_where_needed(
            highest_frequency(robot, x, count, options),
            partial(_solid_frequencies, robot, x, count, options),
            frequencies=lambda found: found,
        )
    return mechanism.modes(robot_mechanism(model, robot, x, options), count).frequencies


def _solid_frequencies(
    robot: Biglide, x: float, count: int, options: ModelOptions, highest: float
) -> Array:
    leg1, leg2 = (
        _reduced_solid(leg, options.divisions, options.ends, highest)
        for leg in _equivalent_legs(robot, options)
    )
    return mechanism.modes(mechanism.assemble(robot, x, leg1, leg2), count).frequencies


def highest_frequency(
    robot: Biglide, x: float, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> float:
    """Frequency (Hz) up to which solid legs should be good for the first `count` of the robot.

    The beam model's with a margin, rounded up in steps of half an octave.
    """
    beam = robot_frequencies("beam", robot, x, count, options)[-1]
    return half_octave_above(_STIFFER_THAN_BEAMS * float(beam))


@lru_cache(maxsize=2)
def _held_solid(leg: ConstantLeg, divisions: int, ends: Ends) -> HeldLeg:
    """The factorised legs of one robot."""
    return held_solid(leg, divisions, ends)


@lru_cache(maxsize=16)
def _static_solid(leg: ConstantLeg, divisions: int, ends: Ends) -> LegMatrices:
    return static_superelement(_held_solid(leg, divisions, ends)).matrices


@lru_cache(maxsize=16)
def _reduced_solid(leg: ConstantLeg, divisions: int, ends: Ends, highest: float) -> LegMatrices:
    return craig_bampton(_held_solid(leg, divisions, ends), highest).matrices


def solid_compliance(leg: ConstantLeg, divisions: int, ends: Ends) -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg as a solid, `divisions` across its section."""
    return solid.tip_compliance(_clamped_solid(leg, divisions, ends))


def solid_modes(leg: ConstantLeg, divisions: int, ends: Ends, count: int) -> Modes:
    """Modes of a clamped leg as a solid: frequencies (Hz), shapes on its nodes (3N×count)."""
    return leg_modes.modes(_clamped_solid(leg, divisions, ends), count)


@lru_cache(maxsize=4)
def _clamped_solid(leg: ConstantLeg, divisions: int, ends: Ends) -> ClampedLeg:
    """The factorised leg, shared by statics and modes."""
    return solid.clamped_leg(solid.solid_leg(leg, solid.solid_mesh(leg, divisions)), ends)


def leg_compliance(model: ModelName, leg: Leg, options: ModelOptions = DEFAULT_OPTIONS) -> Array:
    """6×6 tip compliance (SI, leg axes) of one leg, root clamped.

    Raises InputError for `simplified`, whose legs are rigid.
    """
    if model == "simplified":
        raise InputError("--leg: the legs of the simplified model are rigid")
    if model == "vjm" and options.legs == "given":
        return given_compliance(leg)
    constant = equivalent_leg(leg, options.equivalent)
    if model == "vjm":
        return tip_compliance(constant.properties(options.theory), constant.length)
    if model == "solid":
        return solid_compliance(constant, options.divisions, options.ends)
    return tip_compliance_of(leg_matrices(model, constant, options))


def leg_frequencies(
    model: ModelName, leg: Leg, count: int, options: ModelOptions = DEFAULT_OPTIONS
) -> Array:
    """First natural frequencies (Hz, ascending) of one leg, root clamped.

    Raises InputError for `simplified` (rigid legs) and `vjm` (static).
    """
    if model in ("simplified", "vjm"):
        raise InputError(f"--modes: the {model} model of one leg has no frequencies")
    constant = equivalent_leg(leg, options.equivalent)
    if model == "solid":
        return solid_modes(constant, options.divisions, options.ends, count).frequencies
    return clamped_modes(leg_matrices(model, constant, options), count).frequencies
