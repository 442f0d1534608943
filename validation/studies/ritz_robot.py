"""The biglide by the method of Ritz: polynomials along both legs, energies by quadrature.

A way of its own to deflections and frequencies. It takes nothing but the robot's data: no elements,
no springs between segments, no assembler; joints are linear constraints on the polynomials.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import LinAlgError, block_diag, eigh, null_space, solve

from lumped.arrays import Array
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.errors import ComputationError
from lumped.legs import BeamProperties, ConstantLeg, equivalent_leg

# Statics of Timoshenko beams are cubic; modes up to the sixth converge geometrically.
DEGREE = 14
_FIELDS = 6  # u, v, w, φx, φy, φz of a leg, leg axes
_WITHOUT_TURNING = slice(0, 5)  # of a twist: all but the rotation about z, which joints free


def compliance(robot: Biglide, x: float, degree: int = DEGREE) -> Array:
    """6×6 compliance (SI, robot axes) at the loaded point with B at `x` (m), equivalent legs.

    Raises ComputationError where rounding leaves the stiffness indefinite; `frequencies` too.
    """
    stiffness, _, loaded = _system(robot, x, degree)
    with _definite(robot, x, degree):
        return np.asarray(loaded @ solve(stiffness, loaded.T, assume_a="pos"))


def frequencies(robot: Biglide, x: float, count: int, degree: int = DEGREE) -> Array:
    """First natural frequencies (Hz, ascending) with B at `x` (m), equivalent legs."""
    stiffness, mass, _ = _system(robot, x, degree)
    # Of M against K: motions without mass have the eigenvalue zero.
    with _definite(robot, x, degree):
        squares = eigh(mass, stiffness, eigvals_only=True)[::-1][:count]
    return np.asarray(1.0 / (2.0 * np.pi * np.sqrt(squares)))


@contextmanager
def _definite(robot: Biglide, x: float, degree: int) -> Iterator[None]:
    try:
        yield
    except LinAlgError as error:
        raise ComputationError(
            f"{robot.name} by polynomials of degree {degree} at x = {x:.6g} m: the stiffness is "
            "not positive definite; stiffnesses differ by more than double precision resolves"
        ) from error


def _system(robot: Biglide, x: float, degree: int) -> tuple[Array, Array, Array]:
    """Stiffness and mass (n×n) and twist of the loaded point (6×n) on the unknowns left free.

    Before the constraints: coefficients of leg 1, of leg 2, twist of B, twist of the loaded point.
    """
    member = with_equivalent_legs(robot)
    at = member.posture(x)
    legs = equivalent_leg(member.leg1), equivalent_leg(member.leg2)
    energies = [_leg(leg, degree) for leg in legs]
    ends = [_ends(degree, rotation) for rotation in (at.rotation1, at.rotation2)]
    of_leg = _FIELDS * (degree + 1)
    total = 2 * of_leg + 12
    (root1, tip1), (root2, tip2) = (
        tuple(_placed(end, number * of_leg, total) for end in both)
        for number, both in enumerate(ends)
    )
    of_b, of_p = (_placed(np.eye(6), 2 * of_leg + 6 * k, total) for k in (0, 1))
    stiffness = block_diag(energies[0][0], energies[1][0], np.zeros((12, 12)))
    mass = block_diag(energies[0][1], energies[1][1], np.zeros((12, 12)))
    mass += robot.platform_mass * of_p[:3].T @ of_p[:3]
    shut = [tip1 - of_b, (tip2 - of_b)[_WITHOUT_TURNING]]
    for root in (root1, root2):
        if robot.foot_compliance is None:
            shut.append(root[_WITHOUT_TURNING])
        else:
            # The joint passes no moment about z on: the spring of what it does pass on.
            yielding = robot.foot_compliance[_WITHOUT_TURNING, _WITHOUT_TURNING]
            held = root[_WITHOUT_TURNING]
            stiffness += held.T @ solve(yielding, held)
    apart = of_p - _carried(robot.tool_offset) @ of_b
    if robot.tool_compliance is None:
        shut.append(apart)
    else:
        stiffness += apart.T @ solve(robot.tool_compliance, apart)
    free = null_space(_scaled_rows(np.vstack(shut)))
    return free.T @ stiffness @ free, free.T @ mass @ free, of_p @ free


def _leg(leg: ConstantLeg, degree: int) -> tuple[Array, Array]:
    """Twice the strain and kinetic energies of a Timoshenko leg on its coefficients."""
    p: BeamProperties = leg.timoshenko
    points, weights = legendre.leggauss(degree + 1)
    weights = 0.5 * leg.length * weights
    values: Array = np.asarray(legendre.legvander(points, degree), dtype=np.float64)
    of_unit = legendre.legval(points, legendre.legder(np.eye(degree + 1))).T
    slopes: Array = np.asarray(of_unit * 2.0 / leg.length, dtype=np.float64)

    def field(number: int, of: Array) -> Array:
        return _placed(of, number * (degree + 1), _FIELDS * (degree + 1))

    u, v, w, about_x, about_y, about_z = range(_FIELDS)
    strains = (
        (p.EA, field(u, slopes)),
        (p.GJ, field(about_x, slopes)),
        (p.EIy, field(about_y, slopes)),
        (p.EIz, field(about_z, slopes)),
        (p.GAy, field(v, slopes) - field(about_z, values)),
        (p.GAz, field(w, slopes) + field(about_y, values)),
    )
    inertias = (p.mu, p.mu, p.mu, p.rho_J, p.rho_Iy, p.rho_Iz)
    stiffness = sum(k * (e.T * weights) @ e for k, e in strains)
    motions = (field(number, values) for number in range(_FIELDS))
    mass = sum(m * (f.T * weights) @ f for m, f in zip(inertias, motions, strict=True))
    return np.asarray(stiffness), np.asarray(mass)


def _ends(degree: int, rotation: Array) -> tuple[Array, Array]:
    """Twists (robot axes) of root and tip on the coefficients of a leg (6×n each)."""
    turned = block_diag(rotation, rotation)
    ends = (legendre.legvander(np.array([end]), degree) for end in (-1.0, 1.0))
    root, tip = (turned @ np.kron(np.eye(_FIELDS), end) for end in ends)
    return root, tip


def _placed(block: Array, first: int, total: int) -> Array:
    placed = np.zeros((len(block), total))
    placed[:, first : first + block.shape[1]] = block
    return placed


def _carried(offset: Array) -> Array:
    """Twist at a point `offset` (m) away on the same body: u + φ × r."""
    x, y, z = offset
    carried = np.eye(6)
    carried[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return carried


def _scaled_rows(matrix: Array) -> Array:
    return np.asarray(matrix / np.linalg.norm(matrix, axis=1, keepdims=True))
