"""Names of modes: beams in closed form, of which it is known what they do."""

import numpy as np
import pytest
from written_robot import robot_of

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from validation.models.mechanism import mechanism_modes
from validation.report.figures.mode_names import (
    kinetic_energies,
    mode_names,
)

E, NU, RHO = 2.1e11, 0.3, 7850.0
# Slender, so that shear and rotary inertia take little from the closed forms below.
LENGTH, WIDTH, HEIGHT = 1.0, 0.1, 0.01
AREA, ALONG_Y, ALONG_Z = WIDTH * HEIGHT, HEIGHT * WIDTH**3 / 12.0, WIDTH * HEIGHT**3 / 12.0
BLADE = f"""
schema = 2
name = "blade"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
[bodies.blade]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}
material = {{ E = {E}, nu = {NU}, rho = {RHO} }}
[joints.clamp]
type = "fixed"
between = ["ground", "blade"]
at = "A"
[tool]
body = "blade"
point = "P"
moves = []
"""


def closed_forms(torsion_constant):
    """First frequencies (Hz) of a cantilever of Euler and Bernoulli, and of Saint-Venant."""
    bending = [1.8751041**2, 4.6940911**2, 7.8547574**2, 10.9955407**2]
    found = []
    for name, moment in (("along z", ALONG_Z), ("in the plane", ALONG_Y)):
        speed = np.sqrt(E * moment / (RHO * AREA)) / (2.0 * np.pi * LENGTH**2)
        found += [(factor * speed, name) for factor in bending]
    polar = ALONG_Y + ALONG_Z
    speed = np.sqrt(E / (2.0 * (1.0 + NU)) * torsion_constant / (RHO * polar))
    found += [(speed / (4.0 * LENGTH), "torsion")]
    return found


def nearest(frequency, known):
    return min(known, key=lambda one: abs(np.log(one[0] / frequency)))


@pytest.fixture
def blade(tmp_path):
    return robot_of(BLADE, tmp_path).mechanism


@pytest.mark.parametrize("model", ["beam", "segments"])
def test_modes_of_a_cantilever_are_what_the_closed_forms_say(blade, model):
    (found,) = mechanism_modes(model, [reference_posture(blade)], 6)
    names = mode_names(found.system, found.modes.shapes)
    known = closed_forms(Rectangle(WIDTH, HEIGHT).torsion_constant)
    said = [names.name(mode) for mode in range(6)]
    assert {"along z", "in the plane", "torsion"} <= set(said)
    for mode, frequency in enumerate(found.modes.frequencies):
        expected, name = nearest(frequency, known)
        # Twenty segments and the slenderness of the blade leave less than 4 % in these modes.
        assert frequency == pytest.approx(expected, rel=0.04)
        assert said[mode] == name
        assert names.said(mode).startswith(f"Mode {mode + 1}, {name}: ")
    # A section that turns moves its mass along y and z as its second moments are.
    turning = names.kinetic[:, said.index("torsion")]
    share = ALONG_Z / (ALONG_Y + ALONG_Z)
    np.testing.assert_allclose(turning, [0.0, share, 1.0 - share], atol=1e-9)
    np.testing.assert_allclose(names.kinetic[2, said.index("along z")], 1.0, atol=1e-3)


@pytest.mark.parametrize("name", ["ifw", "delta"])
def test_all_mass_is_in_the_kinetic_energy(name):
    """Modes are mass-normalised; beams' own mass matrices differ by their shape functions."""
    (found,) = mechanism_modes("beam", [reference_posture(load_robot(name).mechanism)], 6)
    energies_of = kinetic_energies(found.system, found.modes.shapes).sum(axis=0)
    np.testing.assert_allclose(energies_of, 1.0, rtol=1e-3)
