"""Equations (1) and (2) of the paper in closed form: elastic drives and rigid legs.

The legs keep their length: A t = B q̇ with A = [[x, s1], [x − a, s2]], B = diag(s1, s2). Hence
J = A⁻¹B, which exists at both ends of the stroke, where B is singular and J⁻¹ does not.
"""

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.biglide import Stroke


def jacobian(stroke: Stroke, x: float) -> Array:
    """J (2×2, no unit) of eq. (2): velocity (x, y) of B at `x` (m) from the slides' along y."""
    directions = np.array([leg.rotation[:2, 0] for leg in stroke.legs_at(x)])
    slides = directions[:, 1, None] * np.eye(2)
    return np.linalg.solve(directions, slides).astype(float)


def drive_compliance(J: Array, K: Array) -> Array:
    """J K⁻¹ Jᵀ (2×2, m/N) of eq. (1) from a Jacobian and the drives' stiffness K (2×2, N/m)."""
    flexibility: Array = J @ np.linalg.solve(K, J.T)
    return flexibility
