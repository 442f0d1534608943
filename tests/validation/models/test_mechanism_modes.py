"""Modes of mechanisms: what carries their energy, by quadrature of strains, and who is whom."""

import json
from functools import partial

import numpy as np
import pytest

from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.system.joint_motion import Portion
from validation.cli import main
from validation.models.mechanism import answers, mechanism_modes

COUNT = 8
ELEMENTS = 20


def strains_of(leg, twists_at):
    """Energies (J) of the four kinds of deformation, by Gauss quadrature of difference quotients.

    `twists_at(x)` gives the sections' twists (m×6) of a centreline.
    """
    p, size = leg.timoshenko, leg.length / ELEMENTS
    places, weights = np.polynomial.legendre.leggauss(4)
    x = ((np.arange(ELEMENTS)[:, None] + 0.5 + 0.5 * places) * size).ravel()
    weight = np.tile(0.5 * size * weights, ELEMENTS)
    step = 1e-3 * size
    slope = (twists_at(x + step) - twists_at(x - step)) / (2.0 * step)
    turned = twists_at(x)
    shear_y, shear_z = slope[:, 1] - turned[:, 5], slope[:, 2] + turned[:, 4]
    return {
        "tension": 0.5 * weight @ (p.EA * slope[:, 0] ** 2),
        "torsion": 0.5 * weight @ (p.GJ * slope[:, 3] ** 2),
        "bending y": 0.5 * weight @ (p.EIy * slope[:, 4] ** 2 + p.GAz * shear_z**2),
        "bending z": 0.5 * weight @ (p.EIz * slope[:, 5] ** 2 + p.GAy * shear_y**2),
    }


def twists_of(model, own, x):
    return (model.centreline(x) @ own).reshape(-1, 6)


def test_shares_of_energy_are_those_of_the_strains_of_the_same_modes():
    """Shares to 1e-5: difference quotients of 1e-3 of an element."""
    mechanism = load_robot("five-bar").mechanism
    at = reference_posture(mechanism)
    (found,) = mechanism_modes("beam", [at], COUNT)
    for mode, (frequency, shape) in enumerate(
        zip(found.modes.frequencies, found.modes.shapes.T, strict=True)
    ):
        whole = 0.5 * (2.0 * np.pi * frequency) ** 2  # Rayleigh, unit modal mass
        for name, leg in legs_of(mechanism).items():
            model, own = found.system.models[name], found.system.own(name, shape[:, None])
            expected = strains_of(leg, partial(twists_of, model, own))
            for kind, energy in expected.items():
                share = found.strain[Portion(name, kind)][mode]
                assert share == pytest.approx(energy / whole, abs=1e-5), (mode, name, kind)
        for joint in mechanism.joints:
            if joint.drive is not None:
                place = interface_position(at, joint.second)
                turning = found.system.motions.at(joint.second.body, joint.second.point, place)
                angle = turning[5] @ shape[: found.system.outer]
                energy = 0.5 * joint.drive.stiffness * angle**2
                share = found.strain[Portion(joint.name, "drive")][mode]
                assert share == pytest.approx(energy / whole, abs=1e-9)


def test_shares_of_sixty_modes_sum_to_one():
    at = [reference_posture(load_robot("hexapod").mechanism)]
    (found,) = mechanism_modes("segments", at, 60)
    (expected,) = answers("segments", at, 60)
    np.testing.assert_allclose(sum(found.strain.values()), np.ones(60), rtol=1e-12)
    np.testing.assert_allclose(found.modes.frequencies, expected.frequencies, rtol=1e-12)
    # Relative to the largest entry: by symmetry some are rounding alone.
    scale = np.abs(expected.compliance).max()
    np.testing.assert_allclose(found.compliance, expected.compliance, rtol=0, atol=1e-12 * scale)


def test_rigid_bodies_leave_all_energy_to_the_drives():
    """Three moves, three drives: three modes."""
    at = [reference_posture(load_robot("delta").mechanism)]
    (found,) = mechanism_modes("simplified", at, 6)
    assert set(found.strain) == {Portion(f"motor{k}", "drive") for k in (1, 2, 3)}
    np.testing.assert_allclose(sum(found.strain.values()), np.ones(3), rtol=1e-12)


def solved(capsys, *arguments):
    assert main(["solve", *arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)["results"]


def test_a_model_is_its_own_partner(capsys):
    (result,) = solved(
        capsys, "orthoglide", "--model", "beam", "--modes", "12", "--against", "beam"
    )
    pairs = result["partners"]["pairs"]
    assert [pair["partner"] for pair in pairs] == list(range(1, 13))
    assert [pair["mac"] for pair in pairs] == pytest.approx([1.0] * 12, abs=1e-9)
    assert [pair["frequency"] for pair in pairs] == pytest.approx(result["frequencies"])
    assert sum(shares[0] for shares in result["strain"].values()) == pytest.approx(1.0)


@pytest.mark.parametrize("asked", [["beam", "--modes", "0"], ["vjm"]])
def test_what_has_no_modes_is_not_paired(asked, capsys):
    assert main(["solve", "five-bar", "--model", *asked, "--against", "solid"]) == 2
    error = capsys.readouterr().err
    assert "--against" in error
    assert "no modes" in error
