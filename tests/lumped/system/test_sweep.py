"""Many postures at once against each of them by itself."""

import numpy as np
import pytest

from lumped.errors import ComputationError
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from lumped.system.sweep import swept
from validation.models.mechanism import dynamic_bodies, static_bodies
from validation.models.options import ModelOptions


def postures_of(name):
    mechanism = load_robot(name).mechanism
    return [posture(mechanism, pose) for pose in mechanism.poses[::4]]


@pytest.mark.parametrize(("name", "elements"), [("ifw", 60), ("five-bar", 4), ("delta", 60)])
def test_many_postures_are_each_of_them(name, elements):
    """Reduced bodies, bodies as they stand, and a Delta whose rods spin idly."""
    at, options = postures_of(name), ModelOptions(elements=elements)
    prepared = assembly(at[0].mechanism, dynamic_bodies("beam", at[0].mechanism, 500.0, options))
    found, statics = swept(prepared, at, 8), swept(prepared, at, 0)
    assert statics.frequencies.shape == (len(at), 0)
    assert np.abs(statics.compliances - found.compliances).max() <= 1e-12 * found.compliances.max()
    for number, one in enumerate(at):
        solution = solved(prepared.at(one))
        expected = compliance(solution)
        size = np.abs(expected).max()
        assert np.abs(found.compliances[number] - expected).max() <= 1e-12 * size
        assert found.frequencies[number] == pytest.approx(modes(solution, 8).frequencies, rel=1e-11)
        assert found.idle[number] == solution.idle


def test_a_posture_with_too_few_modes_is_named():
    at = postures_of("five-bar")
    prepared = assembly(at[0].mechanism, static_bodies("links", at[0].mechanism))
    with pytest.raises(ComputationError, match=r"at x = .* 4 modes asked for, but fewer have mass"):
        swept(prepared, at, 4)
