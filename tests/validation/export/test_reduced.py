"""Reduced models in the files of other programs, read back by these or by plain linear algebra."""

import subprocess
import sys
from ast import literal_eval
from dataclasses import replace
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest
from gantry import GANTRY, MASSES, STIFFNESSES
from one_arm import ONE_ARM
from scipy.io import loadmat
from scipy.linalg import eigh, eigvals
from written_robot import described

from fem.multibody import ExudynMissing, exudyn_version
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved
from validation.export.formats import as_exudyn, as_nastran, as_npz, as_simscape, as_statespace
from validation.export.reduced import reduced_body, reduced_robot
from validation.models.mechanism import mechanism_modes, static_bodies
from validation.models.options import ModelOptions
from validation.solids.bars import with_bars

# Walls would make the meshes finer.
FIVE_BAR = with_bars(reference_posture(load_robot("five-bar").mechanism)).mechanism
COUNT, ROUGH = 6, ModelOptions(divisions=1)


@pytest.fixture(scope="module", autouse=True)
def rough():
    """Meshes of one element across."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.export.reduced.DEFAULT_OPTIONS", ROUGH)
        yield


@pytest.fixture(scope="module")
def robot():
    return reduced_robot(reference_posture(FIVE_BAR), COUNT)


@pytest.fixture(scope="module")
def crank():
    return reduced_body(FIVE_BAR, "crank1", 1000.0)


def clamped(stiffness, mass):
    squared = eigh(stiffness[6:, 6:], mass[6:, 6:], eigvals_only=True)
    return np.sqrt(squared) / (2.0 * np.pi)


def test_the_state_space_rings_as_the_solids_do_and_rests_where_statics_say(
    robot,
):
    found = np.load(BytesIO(as_statespace(robot, ".npz")))
    A, B, C, D = (found[name] for name in "ABCD")
    (solid,) = mechanism_modes("solid", [reference_posture(FIVE_BAR)], COUNT, ROUGH)
    rings = np.sort(np.abs(eigvals(A).imag))[::2] / (2.0 * np.pi)
    # Both reduce for as many frequencies, this one for those of the robot as it stands.
    assert np.allclose(rings, solid.modes.frequencies, rtol=1e-6)
    assert np.allclose(rings, found["frequencies"], rtol=1e-9)
    # Legs on their ends alone, which is exact in statics, and no mode at all.
    bodies = static_bodies("solid", FIVE_BAR, ROUGH)
    statics = compliance(solved(assemble(reference_posture(FIVE_BAR), bodies)))
    still = pytest.importorskip("control").ss(A, B, C, D).dcgain()
    assert np.allclose(still[:, -6:], statics, rtol=1e-7, atol=1e-9 * statics.max())


def test_the_state_space_is_damped_as_each_mode_at_its_own_frequency():
    """Slides that do not touch each other: at √(k/m) by 1/iηk, η of the drive and 2ζ."""
    lossy = GANTRY.replace(f"{STIFFNESSES[0]}", f"{STIFFNESSES[0]}, loss = 0.06")
    gantry = described(f"damping.ratio = 0.01\n{lossy}")
    found = np.load(BytesIO(as_statespace(reduced_robot(reference_posture(gantry), 3), ".npz")))
    A, B, C, D = (found[name] for name in "ABCD")
    tool = list(found["inputs"]).index("tool Fx")
    springs = zip(STIFFNESSES, MASSES, (0.08, 0.02, 0.02), strict=True)
    for axis, (stiffness, mass, loss) in enumerate(springs):
        speed = np.sqrt(stiffness / mass)
        answer = C @ np.linalg.solve(1j * speed * np.eye(6) - A, B) + D
        assert answer[axis, tool + axis] == pytest.approx(-1j / (loss * stiffness), rel=1e-9)


def test_a_drive_pushes_as_its_stiffness_gives(robot):
    ports, solution = robot.matrices.ports, robot.solution
    joint = next(one for one in FIVE_BAR.joints if one.name == "motor1")
    at, step = reference_posture(FIVE_BAR), 1e-6
    slopes = []
    for way in np.eye(2) * step:
        ahead, behind = (posture(FIVE_BAR, at.pose + sign * way, at) for sign in (1.0, -1.0))
        turned = [
            ahead.coordinates[name] - behind.coordinates[name] for name in ("motor1", "motor2")
        ]
        slopes.append(np.ravel(turned) / (2.0 * step))
    # Virtual work of the tool's rigid motions, J = dθ/dp: f = Jᵀ τ, and the drive gives τ/k.
    torques = np.linalg.inv(np.array(slopes))
    given = (ports["drive motor1"] @ solution.displacements(ports["tool"].T))[0, :2]
    assert np.allclose(joint.drive.stiffness * given, torques[0], rtol=1e-6)


def test_bounds_hold_against_a_reduction_that_keeps_more(crank):
    finer = reduced_body(FIVE_BAR, "crank1", 4000.0)
    count = len(crank.frequencies)
    assert count >= 2
    off = crank.frequencies - finer.frequencies[:count]
    assert (off >= -1e-9 * crank.frequencies).all()
    assert (off <= crank.bounds + 1e-9 * crank.frequencies).all()


def test_matrices_of_a_body_come_back(crank):
    plain = np.load(BytesIO(as_npz(crank)))
    assert np.array_equal(plain["K"], crank.stiffness)
    assert list(plain["unknowns"][:7]) == [
        *(f"A1 {way}" for way in ("x", "y", "z", "phi_x", "phi_y", "phi_z")),
        "B1 x",
    ]
    block = loadmat(BytesIO(as_simscape(crank)))
    found = clamped(block["stiffness"], block["mass"])[: len(crank.frequencies)]
    assert np.allclose(found, crank.frequencies, rtol=1e-9)
    length = np.linalg.norm(FIVE_BAR.bodies["crank1"].interfaces["B1"].position)
    assert np.allclose(block["origins"], [[0.0, 0.0, 0.0], [length, 0.0, 0.0]])


def test_nastran_reads_the_matrices(crank):
    nastran = pytest.importorskip("pyyeti.nastran", reason="pyyeti is not installed")
    found = nastran.rddmig(StringIO(as_nastran(crank).decode()))
    stiffness, mass = found["kred"].to_numpy(), found["mred"].to_numpy()
    # Ten digits are written.
    frequencies = clamped(stiffness, mass)[: len(crank.frequencies)]
    assert np.allclose(frequencies, crank.frequencies, rtol=1e-6)


def test_exudyn_finds_the_frequencies(robot, tmp_path):
    try:
        exudyn_version()
    except ExudynMissing as missing:
        pytest.skip(str(missing))
    script = tmp_path / "robot.py"
    named = replace(robot.matrices, name='end""" + 1 / 0 \\N{')
    script.write_bytes(as_exudyn(named))
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=True, timeout=120
    )
    found = np.array(literal_eval(done.stdout.splitlines()[-1]))[:COUNT]
    assert np.allclose(found, robot.matrices.frequencies, rtol=1e-6)


def test_the_command_writes_as_many_modes_as_there_are(tmp_path, monkeypatch, command):
    """Twenty are asked for of the gantry."""
    monkeypatch.chdir(tmp_path)
    Path("gantry.toml").write_text(GANTRY)
    command.told("export", "gantry.toml", "--to", "npz")
    expected = np.sort(np.sqrt(np.divide(STIFFNESSES, MASSES))) / (2.0 * np.pi)
    assert np.load("gantry.npz")["frequencies"] == pytest.approx(expected, rel=1e-9)
    Path("arm.toml").write_text(ONE_ARM.replace("0.5, 0.0]", "0.1, 0.0]"))
    command.told("export", "arm.toml", "--to", "simscape", "--body", "arm", "--modes", 1)
    assert "stiffness" in loadmat("arm.arm.mat")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["five-bar", "--to", "nastran"], "takes one body"),
        (["five-bar", "--to", "statespace", "--body", "crank1"], "of the whole robot"),
        (["five-bar", "--to", "npz", "--body", "no"], "must be one of"),
        (["five-bar", "--to", "npz", "--out", "five-bar.toml"], "must end in .npz"),
        (["five-bar", "--to", "npz", "--modes", "0"], "must be from 1 to"),
        (["ifw", "--to", "npz", "--body", "leg1"], "known by its 6×6 alone"),
    ],
)
def test_what_cannot_be_exported_is_refused(words, said, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    assert said in command.refused("export", *words)
    assert not list(tmp_path.iterdir())
