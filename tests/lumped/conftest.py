"""The paper's demonstrator, typed from its appendix, for every test that needs it."""

import numpy as np
import pytest

from lumped.biglide import Biglide
from lumped.legs import GivenLeg

# k_Foot with (6,6) = 3.16e-7 for the printed 3.16e-9, which makes the matrix indefinite.
FOOT = [
    [1.67e-10, 8.85e-13, -7.78e-14, -2.12e-13, 7.95e-12, 2.50e-12],
    [8.85e-13, 5.87e-9, 6.39e-12, -3.58e-11, -2.12e-11, 3.94e-8],
    [-7.78e-14, 6.39e-12, 5.53e-10, 1.35e-11, -4.49e-9, 1.91e-11],
    [-2.12e-13, -3.58e-11, 1.35e-11, 6.96e-8, 5.28e-11, -2.71e-10],
    [7.95e-12, -2.12e-11, -4.49e-9, 5.28e-11, 8.48e-8, 7.40e-9],
    [2.50e-12, 3.94e-8, 1.91e-11, -2.71e-10, 7.40e-9, 3.16e-7],
]
LEG1 = [
    [2.81e-9, -1.01e-8, -1.41e-9, -1.81e-9, 4.42e-9, 2.92e-8],
    [-1.01e-8, 1.77e-7, -1.83e-9, -2.03e-9, 2.93e-9, -2.90e-7],
    [-1.41e-9, -1.83e-9, 3.19e-8, 4.77e-8, -9.94e-8, -2.27e-9],
    [-1.81e-9, -2.03e-9, 4.77e-8, 1.73e-7, -8.02e-8, -1.18e-9],
    [4.42e-9, 2.93e-9, -9.94e-8, -8.02e-8, 8.13e-7, 3.23e-8],
    [2.92e-8, -2.90e-7, -2.27e-9, -1.18e-9, 3.23e-8, 6.08e-7],
]
LEG2 = [
    [2.71e-10, 1.29e-10, -1.99e-10, 4.68e-9, 1.73e-9, -7.06e-11],
    [1.29e-10, 1.26e-8, -3.88e-13, 1.84e-10, 1.67e-8, -2.12e-8],
    [-1.99e-10, -3.88e-13, 1.07e-9, -1.03e-8, -2.38e-10, 3.71e-13],
    [4.68e-9, 1.84e-10, -1.03e-8, 2.52e-7, 3.62e-9, 4.54e-10],
    [1.73e-9, 1.67e-8, -2.38e-10, 3.62e-9, 7.22e-7, 3.95e-8],
    [-7.06e-11, -2.12e-8, 3.71e-13, 4.54e-10, 3.95e-8, 1.70e-7],
]


@pytest.fixture
def demonstrator() -> Biglide:
    """The IFW demonstrator with the appendix's own matrices, loads at B."""
    return Biglide(
        name="demonstrator",
        a=0.92,
        platform_mass=46.0,
        actuator_stiffness=1.0e9,
        leg1=GivenLeg(0.85, 69.705, np.array(LEG1)),
        leg2=GivenLeg(0.775, 49.366, np.array(LEG2)),
        foot_compliance=np.array(FOOT),
    )
