"""The simplified model: elastic drives and a rigid robot (eqs 1, 2 and 12).

The legs keep their length: A t = B q̇ with A = [[x, s1], [x − a, s2]], B = diag(s1, s2). Hence
J = A⁻¹B, which exists at both ends of the stroke, where B is singular and J⁻¹ does not. All
results are therefore computed from J alone, by flexibility.

Every function takes one x (m) or an array of them; results carry the shape of x in front.
"""

import numpy as np
from numpy.typing import ArrayLike

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.errors import ComputationError

# s = √(L² − x²) is the square root of rounding noise at an end of the stroke.
_END_OF_STROKE = np.sqrt(16.0 * np.finfo(float).eps)
# sine of the angle between the legs below which A is singular, for the same reason
_ALIGNED = _END_OF_STROKE


def jacobian(robot: Biglide, x: ArrayLike) -> Array:
    """J (…×2×2, no unit) of eq. (2): velocity (x, y) of B from the slides' velocities along y.

    Raises InputError outside the stroke, ComputationError where the legs are aligned (A singular,
    a type 2 singularity).
    """
    stations = np.asarray(x, dtype=float)
    postures = [robot.posture(float(station)) for station in stations.flat]
    legs = np.array([[p.tip - p.root1, p.tip - p.root2] for p in postures]).reshape(-1, 2, 3)
    directions = legs[:, :, :2] / np.array([robot.leg1.length, robot.leg2.length])[:, None]
    sines = np.linalg.det(directions)
    if (aligned := np.abs(sines) <= _ALIGNED).any():
        where = ", ".join(f"{p.x:g}" for p, bad in zip(postures, aligned, strict=True) if bad)
        raise ComputationError(
            f"{robot.name}, simplified model: the legs are aligned at x = {where} m (type 2 "
            "singularity, A of A t = B q̇ is singular): the drives do not hold B across them"
        )
    slides = directions[:, :, 1, None] * np.eye(2)
    return np.linalg.solve(directions, slides).reshape(*stations.shape, 2, 2)


def compliance(robot: Biglide, x: ArrayLike) -> Array:
    """J K⁻¹ Jᵀ (…×2×2, m/N, axes x y) of eq. (1); raises as `jacobian` does."""
    return drive_compliance(jacobian(robot, x), np.eye(2) * robot.actuator_stiffness)


def frequencies(robot: Biglide, x: ArrayLike) -> Array:
    """Both natural frequencies (…×2, Hz, ascending) of the platform's mass on the drives, eq. (12).

    At an end of the stroke, where the robot does not yield in one direction, the second one is
    infinite. Raises as `jacobian` does.
    """
    stiffness = np.eye(2) * robot.actuator_stiffness
    mass = np.eye(2) * robot.platform_mass
    return natural_frequencies(jacobian(robot, x), stiffness, mass)


def drive_compliance(J: Array, K: Array) -> Array:
    """J K⁻¹ Jᵀ (…×n×n, m/N) of eq. (1) from a Jacobian (…×n×n) and the drives' stiffness (n×n)."""
    flexibility: Array = J @ np.linalg.solve(K, np.swapaxes(J, -1, -2))
    return flexibility


def natural_frequencies(J: Array, K: Array, M: Array) -> Array:
    """Natural frequencies (…×n, Hz, ascending) of eq. (12), finite wherever they can be.

    `J` …×n×n, stiffness `K` (N/m) and mass `M` (kg) n×n, symmetric positive definite. The work of
    f = J⁻ᵀτ on t = Jq̇ makes the stiffness at the platform J⁻ᵀKJ⁻¹, where the paper prints J⁻¹KJ⁻ᵀ.
    1/ω are the singular values of K^(−½) Jᵀ M^(½), so J may be singular; a zero one is infinite Hz.
    """
    root = np.linalg.solve(np.linalg.cholesky(K), np.swapaxes(J, -1, -2)) @ np.linalg.cholesky(M)
    periods = np.linalg.svd(root, compute_uv=False)
    rigid = periods <= _END_OF_STROKE * periods[..., :1]
    return np.where(rigid, np.inf, 1.0 / (2.0 * np.pi * np.where(rigid, 1.0, periods)))
