"""Forces in the sections of legs: cantilevers, frames and moving arms by hand."""

from dataclasses import replace

import numpy as np
import pytest
from support.robots.plane_frames import BEAM, CANTILEVER, RHO, TRIANGLE, WEIGHT, B, H, L, Q
from support.robots.robot_from_text import described

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.load import Load
from lumped.robot_file import load_robot
from validation.models.loads.statics import load_forces

# A quarter and three quarters of the clamped beam.
QUARTERED = BEAM.replace(f"[{L / 2}, 0.0, 0.0]", f"[{L / 4}, 0.0, 0.0]")
QUARTERED = QUARTERED.replace("LEFT", "fixed").replace("RIGHT", "fixed")
AREA, IZ = B * H, H * B**3 / 12.0


def members(mechanism, model="beam", **load):
    """Member forces by leg under one load at the loaded point."""
    tool = mechanism.tool
    robot = replace(mechanism, loads=(Load("load", tool.body, tool.point, **load),))
    ((forces,),) = load_forces(model, [reference_posture(robot)])
    return {member.leg: member for member in forces.members}


@pytest.mark.parametrize("model", ["simplified", "vjm", "links", "segments", "beam"])
def test_cantilever_sections_balance_loads(model):
    """N = Px, Q = P + q(L − x) with its sign, My = −Pz(L − x) + q(L − x)²/2, Mz = Py(L − x)."""
    wrench = np.array([5.0, 7.0, -11.0, 13.0, 17.0, -19.0])
    # The simplified model has rigid legs on a rigid clamp: nothing moves, all is determined.
    robot = described(CANTILEVER if model != "simplified" else ON_DRIVE)
    bar = members(robot, model, wrench=wrench, **WEIGHT)["bar"]
    beyond = L - bar.stations
    due = np.column_stack(
        [
            np.full_like(beyond, 5.0),
            np.full_like(beyond, 7.0),
            -11.0 - Q * beyond,
            np.full_like(beyond, 13.0),
            17.0 + 11.0 * beyond + Q * beyond**2 / 2.0,
            -19.0 + 7.0 * beyond,
        ]
    )
    np.testing.assert_allclose(bar.forces, due, rtol=1e-9, atol=1e-9 * Q * L**2)
    assert (bar.half_width <= 1e-9 * Q * L**2).all()


ON_DRIVE = CANTILEVER.replace('"fixed"', '"revolute", axis = [0, 1, 0], drive = {stiffness = 1e6}')


@pytest.mark.parametrize("model", ["links", "beam"])
def test_largest_moment_is_at_zero_shear(model):
    """My = qL²/24 in the middle of the clamped beam, between two stations of its longer part."""
    long = members(described(QUARTERED), model, **WEIGHT)["right"]
    middle = int(np.argmin(np.abs(long.stations - L / 4.0)))
    assert long.stations[middle] == pytest.approx(L / 4.0, abs=1e-9)
    np.testing.assert_allclose(long.forces[middle, 4], -Q * L**2 / 24.0, rtol=1e-9)
    np.testing.assert_allclose(long.forces[-1, 4], Q * L**2 / 12.0, rtol=1e-9)
    assert np.abs(long.forces[middle, 2]) <= 1e-9 * Q * L


def test_triangle_bar_tension_is_positive():
    """Axial forces N₁ = 5/4 F_x and N₂ = F_y − 3/4 F_x in the bars; tension is positive."""
    force = np.array([120.0, -50.0, 0.0, 0.0, 0.0, 0.0])
    bars = members(described(TRIANGLE), wrench=force)
    for name, tension in (("long", 150.0), ("short", -140.0)):
        np.testing.assert_allclose(bars[name].forces[:, 0], tension, rtol=1e-9)
        np.testing.assert_allclose(bars[name].forces[:, 1:], 0.0, atol=1e-7)


ARM = CANTILEVER.replace('"fixed"', '"revolute", axis = [0, 0, 1], drive = {stiffness = 1e6}')
ARM = ARM.replace("moves = []", 'moves = ["y"]')


@pytest.mark.parametrize("model", ["simplified", "links", "beam"])
def test_swung_arm_sections_carry_inertia(model):
    """N = ρAω²(L² − x²)/2, Qy = −ρAα(L² − x²)/2; Mz by Qy and by −ρIα of each section beyond x."""
    turning, spin = 3.0 / L, 2.0 / L
    motion = {"acceleration": np.array([0.0, 3.0, 0.0]), "speed": np.array([0.0, 2.0, 0.0])}
    bar = members(described(ARM), model, **motion)["bar"]
    x = bar.stations
    mass, square = RHO * AREA, (L**2 - x**2) / 2.0
    # Differences of velocities give the centripetal acceleration to 1e-10.
    np.testing.assert_allclose(bar.forces[:, 0], mass * spin**2 * square, rtol=1e-8, atol=1e-7)
    np.testing.assert_allclose(bar.forces[:, 1], -mass * turning * square, rtol=1e-8, atol=1e-7)
    moment = mass * turning * ((L**3 - x**3) / 3.0 - x * square) + RHO * IZ * turning * (L - x)
    np.testing.assert_allclose(bar.forces[:, 5], -moment, rtol=1e-8, atol=1e-7)
    np.testing.assert_allclose(bar.forces[:, [2, 3, 4]], 0.0, atol=1e-7)


def test_planar_loop_forces_are_determined():
    """Rigid planar loops determine N, Qy and Mz as elastic ones do, but not Qz, T and My."""
    mechanism = load_robot("five-bar").mechanism
    wrench = np.array([100.0, -60.0, 0.0, 0.0, 0.0, 0.0])
    rigid = members(mechanism, "simplified", wrench=wrench)
    elastic = members(mechanism, "links", wrench=wrench)
    for name, member in rigid.items():
        np.testing.assert_allclose(
            member.forces[:, [0, 1, 5]], elastic[name].forces[:, [0, 1, 5]], atol=1e-7
        )
        assert np.isnan(member.forces[:, [2, 3, 4]]).any()
        assert not np.isnan(elastic[name].forces).any()


def test_partial_line_load_bends_leg():
    """Load p on the middle half of a cantilever: Q and My balance the load beyond each section."""
    line = 'lines = [{ leg = "bar", from = 0.5, to = 1.5, wrench = [0, 0, -300.0, 0, 0, 0] }]'
    text = CANTILEVER + f'[[loads]]\nname = "wind"\n{line}\n'
    ((forces,),) = load_forces("beam", [reference_posture(described(text))])
    (bar,) = forces.members
    x = bar.stations
    inside = np.clip(1.5 - x, 0.0, 1.0)
    np.testing.assert_allclose(bar.forces[:, 2], -300.0 * inside, atol=1e-7)
    lever = np.where(x < 0.5, 1.0 - x, inside / 2.0)
    np.testing.assert_allclose(bar.forces[:, 4], 300.0 * inside * lever, atol=1e-7)
    assert {0.5, 1.5} <= set(np.round(x, 9).tolist())
