"""The biglide by the method of Ritz: joints are linear constraints on polynomials along both legs.

A way of its own to deflections and frequencies. It takes nothing but the robot's data: no elements,
no springs between segments, no assembler, not even the mechanism that others are made of.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.linalg import LinAlgError, block_diag, eigh, solve

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Theory, equivalent_leg
from validation.studies.ritz.leg import (
    STATIC_DEGREE,
    RitzLeg,
    between_ends,
    carried,
    fields,
    free_motions,
    of_beam,
    of_compliance,
    placed,
)
from validation.studies.ritz.segments import left_out

DEGREE = 14
SEGMENTS = 20
# Modes just above those asked for, with which they may change places.
_ABOVE = 2
_WITHOUT_TURNING = slice(0, 5)  # of a twist: all but the rotation about z, which joints free
# Legs as beams of a theory (6×6 by their equivalent), or by their own 6×6.
Legs: TypeAlias = Theory | Literal["given"]


def compliance(
    robot: Biglide, x: float, legs: Legs = "timoshenko", degree: int = STATIC_DEGREE
) -> Array:
    """6×6 compliance (SI, robot axes) at the loaded point with B at `x` (m).

    Raises ComputationError where rounding leaves the stiffness indefinite; frequencies too.
    """
    stiffness, _, loaded = _system(robot, x, legs, degree)
    with _definite(robot):
        return np.asarray(loaded @ solve(stiffness, loaded.T, assume_a="pos"))


def of_springs(robot: Biglide, x: float, first: Array, second: Array) -> Array:
    """The same with legs of these 6×6 tip compliances (leg axes)."""
    legs = (
        GivenLeg(leg.length, 1.0, compliance)
        for leg, compliance in ((robot.leg1, first), (robot.leg2, second))
    )
    leg1, leg2 = legs
    return compliance(replace(robot, leg1=leg1, leg2=leg2), x, "given")


def frequencies(
    robot: Biglide, x: float, count: int, theory: Theory = "timoshenko", degree: int = DEGREE
) -> Array:
    """First natural frequencies (Hz, ascending) with B at `x` (m), equivalent legs."""
    stiffness, mass, _ = _system(robot, x, theory, degree)
    with _definite(robot):
        return _lowest(stiffness, mass, count)


def missed_by_segments(
    robot: Biglide, x: float, count: int, theory: Theory = "timoshenko", segments: int = SEGMENTS
) -> Array:
    """First frequencies (Hz) in rigid `segments` per leg, less those of the beams they stand for.

    To second order in 1/n, of modes by polynomials (`validation.studies.ritz.segments`).
    """
    prisms = [equivalent_leg(leg) for leg in (robot.leg1, robot.leg2)]
    legs = [_leg(prism, theory, DEGREE) for prism in prisms]
    missed = [
        left_out(prism.properties(theory), prism.length, segments, DEGREE) for prism in prisms
    ]
    stiffness, mass, _ = _joined(robot, x, (legs[0], legs[1]))
    # The same unknowns, without the platform.
    alone = replace(robot, platform_mass=0.0)
    kinetic, strain = (
        _joined(alone, x, (replace(legs[0], mass=first), replace(legs[1], mass=second)))[1]
        for first, second in zip(*missed, strict=True)
    )
    with _definite(robot):
        inverse, modes = eigh(mass, stiffness)
    kept = slice(-1, -count - 1 - _ABOVE, -1)
    squares, modes = 1.0 / inverse[kept], modes[:, kept] / np.sqrt(inverse[kept])
    lumped = eigh(
        np.diag(squares) - squares[:, None] * (modes.T @ strain @ modes) * squares,
        np.eye(len(squares)) - modes.T @ kinetic @ modes,
        eigvals_only=True,
    )
    return np.asarray((np.sqrt(lumped) - np.sqrt(squares))[:count] / (2.0 * np.pi))


def frequencies_as_printed(robot: Biglide, x: float, count: int, degree: int = DEGREE) -> Array:
    """The same with the joints at the feet released as eq. (25) prints it, at the feet alone."""
    both = tuple(_leg(leg, "timoshenko", degree) for leg in (robot.leg1, robot.leg2))
    stiffness, mass, _ = _joined(robot, x, (both[0], both[1]), printed=True)
    with _definite(robot):
        return _lowest(stiffness, mass, count)


def frequencies_with_masses(
    robot: Biglide, x: float, count: int, *, lumped: bool, degree: int = DEGREE
) -> Array:
    """The same of legs with the stiffness of their own 6×6 between their ends.

    Their mass lies along them as in their equivalent prisms, or `lumped` with the inertia given, on
    a point of the prism's centreline as its ends move it.
    """
    both = tuple(_with_masses(leg, lumped, degree) for leg in (robot.leg1, robot.leg2))
    stiffness, mass, _ = _joined(robot, x, (both[0], both[1]))
    with _definite(robot):
        return _lowest(stiffness, mass, count)


@contextmanager
def _definite(robot: Biglide) -> Iterator[None]:
    try:
        yield
    except LinAlgError as error:
        raise ComputationError(
            f"{robot.name} by polynomials: the stiffness is not positive definite; stiffnesses "
            "differ by more than double precision resolves"
        ) from error


def _lowest(stiffness: Array, mass: Array, count: int) -> Array:
    # Of M against K: motions without mass have the eigenvalue zero.
    squares = eigh(mass, stiffness, eigvals_only=True)[::-1][:count]
    return np.asarray(1.0 / (2.0 * np.pi * np.sqrt(squares)))


def _with_masses(leg: Leg, lumped: bool, degree: int) -> RitzLeg:  # noqa: FBT001
    if not isinstance(leg, GivenLeg):
        return _leg(leg, "timoshenko", degree)
    own = of_compliance(leg.compliance, leg.length)
    if lumped:
        prism = _leg(leg, "timoshenko", STATIC_DEGREE)
        centre = 0.5 * leg.length if leg.mass_centre is None else leg.mass_centre
        beam = equivalent_leg(leg).timoshenko
        place = np.array([2.0 * centre / leg.length - 1.0])
        motion = fields(beam, leg.length, place, STATIC_DEGREE)[0][:, 0] @ between_ends(prism)
        lump = np.diag([leg.mass] * 3 + [0.0] * 3)
        if leg.inertia is not None:
            lump[3:, 3:] = leg.inertia
        return replace(own, mass=motion.T @ lump @ motion)
    prism = _leg(leg, "timoshenko", degree)
    ends = np.vstack([prism.root, prism.tip])
    bent = of_compliance(clamped_leg(leg), leg.length)
    return replace(
        prism, stiffness=prism.stiffness + ends.T @ (own.stiffness - bent.stiffness) @ ends
    )


def clamped_leg(leg: Leg, legs: Legs = "timoshenko", degree: int = STATIC_DEGREE) -> Array:
    """6×6 tip compliance (SI, leg axes) of one leg, root clamped."""
    found = _leg(leg, legs, degree)
    free = free_motions(found.stiffness, found.root)
    loaded = found.tip @ free
    return np.asarray(loaded @ solve(free.T @ found.stiffness @ free, loaded.T, assume_a="pos"))


def _leg(leg: Leg, legs: Legs, degree: int) -> RitzLeg:
    if legs == "given" and isinstance(leg, GivenLeg):
        return of_compliance(leg.compliance, leg.length)
    prism: ConstantLeg = equivalent_leg(leg)
    theory: Theory = "timoshenko" if legs == "given" else legs
    return of_beam(prism.properties(theory), prism.length, degree)


def _system(robot: Biglide, x: float, legs: Legs, degree: int) -> tuple[Array, Array, Array]:
    """Stiffness and mass (n×n) and twist of the loaded point (6×n) on the unknowns left free.

    Before the constraints: coefficients of leg 1, of leg 2, twist of B, twist of the loaded point.
    """
    both = tuple(_leg(leg, legs, degree) for leg in (robot.leg1, robot.leg2))
    return _joined(robot, x, (both[0], both[1]))


def _joined(
    robot: Biglide, x: float, both: tuple[RitzLeg, RitzLeg], *, printed: bool = False
) -> tuple[Array, Array, Array]:
    """The same of two legs; `printed`: rows and columns of the feet zeroed, not condensed."""
    at = robot.posture(x)
    firsts = (0, both[0].size)
    of_legs = both[0].size + both[1].size
    total = of_legs + 12
    (root1, tip1), (root2, tip2) = (
        [placed(block_diag(turn, turn) @ end, first, total) for end in (leg.root, leg.tip)]
        for leg, first, turn in zip(both, firsts, (at.rotation1, at.rotation2), strict=True)
    )
    of_b, of_p = (placed(np.eye(6), of_legs + 6 * k, total) for k in (0, 1))
    stiffness, mass = (
        block_diag(*(getattr(leg, kind) for leg in both), np.zeros((12, 12)))
        for kind in ("stiffness", "mass")
    )
    mass += robot.platform_mass * of_p[:3].T @ of_p[:3]
    shut = [tip1 - of_b, (tip2 - of_b)[_WITHOUT_TURNING]]
    for root in (root1, root2):
        if robot.foot_compliance is None:
            shut.append(root[_WITHOUT_TURNING])
        else:
            # The joint passes no moment about z on: the spring of what it does pass on.
            passed = np.linalg.inv(robot.foot_compliance[_WITHOUT_TURNING, _WITHOUT_TURNING])
            if printed:
                passed = np.linalg.inv(robot.foot_compliance)[_WITHOUT_TURNING, _WITHOUT_TURNING]
            held = root[_WITHOUT_TURNING]
            stiffness += held.T @ passed @ held
    apart = of_p - carried(robot.tool_offset) @ of_b
    if robot.tool_compliance is None:
        shut.append(apart)
    else:
        stiffness += apart.T @ solve(robot.tool_compliance, apart)
    free = free_motions(stiffness, np.vstack(shut))
    return free.T @ stiffness @ free, free.T @ mass @ free, of_p @ free
