"""Virtual joints, segments and beams: three formulations of one statics.

The first solves bordered systems of screws per chain, the second adds springs in series and
assembles the robot, the third assembles finite elements. On random robots with equivalent legs
they must give one answer.
"""

import numpy as np
from compliances import scaled_difference
from hypothesis import given, settings
from hypothesis import strategies as st
from like_ifw import placed_at, stations

from lumped.legs import constant_leg
from lumped.mechanism.biglide import biglide
from lumped.mechanism.mechanism import Mechanism
from validation.models.mechanism import answers
from validation.models.options import ModelOptions

positive = st.floats(0.1, 10.0)


@st.composite
def random_robots(draw) -> Mechanism:
    """Robots whose legs, feet, tool and geometry vary by a factor of ten about the paper's."""
    length1, length2 = draw(st.floats(0.4, 1.5)), draw(st.floats(0.4, 1.5))
    # The shorter leg passes its horizontal posture, and the legs meet.
    low, high = abs(length1 - length2), length1 + length2
    a = low + draw(st.floats(0.1, 0.9)) * (high - low)
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    legs = [
        constant_leg(
            length,
            EA=draw(positive) * 1e9,
            EIy=draw(positive) * 1e6,
            EIz=draw(positive) * 1e6,
            GJ=draw(positive) * 1e6,
            mass=50.0,
        )
        for length in (length1, length2)
    ]
    return biglide(
        name="random",
        a=a,
        platform_mass=46.0,
        drive_stiffness=1e9,
        leg1=legs[0],
        leg2=legs[1],
        tool_offset=random.uniform(-0.2, 0.2, size=3),
        foot_compliance=draw(st.sampled_from([None, _compliance(random)])),
        tool_compliance=draw(st.sampled_from([None, _compliance(random)])),
    )


def _compliance(random: np.random.Generator) -> np.ndarray:
    """A full symmetric positive definite compliance of about the paper's size."""
    factor = random.normal(size=(6, 6))
    size = np.sqrt(np.array([1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-7]))
    return (factor @ factor.T + np.eye(6)) * np.outer(size, size)


@settings(max_examples=30)
@given(
    robot=random_robots(),
    fraction=st.floats(0.0, 1.0),
    theory=st.sampled_from(["euler-bernoulli", "timoshenko"]),
    elements=st.integers(1, 12),
)
def test_random_robots(robot, fraction, theory, elements):
    first, last = stations(robot, 2)
    at = placed_at(robot, first + fraction * (last - first))
    options = ModelOptions(legs="equivalent", theory=theory, elements=elements)
    vjm, segments, beam = (answers(model, at, 0, options) for model in ("vjm", "segments", "beam"))
    # Rounding: the legs and springs differ in stiffness by 1e3, the beam's matrix by n³ more.
    for others in (segments, beam):
        for one, other in zip(vjm, others, strict=True):
            assert scaled_difference(other.compliance, one.compliance) < 1e-9
