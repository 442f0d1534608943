from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from sound_biglide import SOUND

from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg
from lumped.models.bodies import legs_of
from lumped.robot_file import built_in_robots, load_robot
from lumped.sections import HollowRectangle


@pytest.fixture
def robot_path(tmp_path):
    def write(text: str) -> Path:
        path = tmp_path / "my.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def faults_of(source) -> tuple[str, ...]:
    with pytest.raises(InputError) as error:
        load_robot(source)
    return error.value.faults


def distance_of_slides(mechanism):
    return mechanism.reference["slide2"].position[0] - mechanism.reference["slide1"].position[0]


def compliance_of(robot_file, name):
    return next(joint for joint in robot_file.mechanism.joints if joint.name == name).compliance


def test_sound_file_is_read(robot_path):
    path = robot_path(SOUND)
    loaded = load_robot(path)
    assert (loaded.source, loaded.built_in) == (str(path), False)
    leg1, leg2 = legs_of(loaded.mechanism).values()
    assert isinstance(leg1, ConstantLeg)
    assert leg1.section == HollowRectangle(0.10, 0.16, 0.008)
    # hollow rectangle 0.1 × 0.16 × 0.008 of steel: (0.016 − 0.084·0.144) m² · 7850 · 0.85
    assert leg1.mass == pytest.approx((0.016 - 0.084 * 0.144) * 7850 * 0.85)
    assert isinstance(leg2, GivenLeg)
    assert leg2.compliance[1, 5] == 3.0e-8
    assert loaded.mechanism.tool.datum == (0.0, 0.0, 0.1)
    assert "spring" not in {joint.name for joint in loaded.mechanism.joints}


def test_what_loses_energy_is_said_of_materials_legs_joints_and_drives(robot_path):
    """Of the biglide by what it names; of other robots by body and joint."""
    lossy = SOUND.replace("rho = 7850.0 }", "rho = 7850.0, loss = 0.01 }")
    lossy += f"\n[tool]\ncompliance = {(1e-9 * np.eye(6)).tolist()}\n"
    for table, loss in (("leg2", 0.02), ("foot", 0.03), ("actuators", 0.04), ("tool", 0.05)):
        lossy = lossy.replace(f"[{table}]", f"[{table}]\nloss = {loss}")
    found = load_robot(robot_path(lossy)).mechanism
    assert [found.bodies[name].loss for name in ("leg1", "leg2", "platform")] == [0.01, 0.02, 0.0]
    joints = {joint.name: joint for joint in found.joints}
    assert [joints[name].loss for name in ("foot1", "foot2", "spring")] == [0.03, 0.03, 0.05]
    assert [joints[name].drive.loss for name in ("drive1", "drive2")] == [0.04, 0.04]
    text = load_robot("five-bar").text.replace("rho = 7850.0 }", "rho = 7850.0, loss = 0.01 }")
    found = load_robot(robot_path(text)).mechanism
    assert found.bodies["crank1"].loss == 0.01


def test_mass_stands_for_the_density_and_g_for_that_of_an_isotropic_material(robot_path):
    text = SOUND.replace(", rho = 7850.0", "").replace("length = 0.85", "length = 0.85\nmass = 60")
    leg = legs_of(load_robot(robot_path(text)).mechanism)["leg1"]
    assert leg.mass == pytest.approx(60.0)
    # E over 2(1 + ν)
    assert pytest.approx(2.1e11 / 2.6) == leg.material.G
    own = load_robot(robot_path(SOUND.replace("nu = 0.3", "nu = 0.3, G = 7e10"))).mechanism
    assert legs_of(own)["leg1"].material.G == 7e10


def test_byte_order_mark_and_windows_line_ends_are_read(tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SOUND.replace("\n", "\r\n").encode())
    assert distance_of_slides(load_robot(path).mechanism) == 0.9


def test_rounding_of_seven_digits_is_symmetric_enough():
    rounded = load_robot("ifw").with_values({"foot.compliance[2,6]": 3.9400001e-8})
    foot = compliance_of(rounded, "foot1")
    assert np.array_equal(foot, foot.T)


def test_a_path_that_leads_to_no_robot(tmp_path):
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'name = "Gr\xf6\xdfe"')
    robots = f"must be a robot file or a built-in robot ({', '.join(built_in_robots())})"
    for path, said in (
        (tmp_path / "none.toml", f"none.toml: no such file; {robots}"),
        ("IWF", f'IWF: no such file; {robots}; did you mean "ifw"?'),
        (tmp_path, f"{tmp_path}: is a folder; must be a robot file"),
        (latin, f"{latin}: byte 11 is not UTF-8; must be a TOML text in UTF-8"),
        (tmp_path / ("x" * 1000), "cannot be read"),
    ):
        (fault,) = faults_of(path)
        assert said in fault


def test_tool_compliance_acts_only_when_active():
    loaded = load_robot("ifw")
    assert "spring" not in {joint.name for joint in loaded.mechanism.joints}
    active = loaded.with_values({"tool.active": True})
    assert compliance_of(active, "spring")[1, 0] == -9.70e-11


def test_digest_is_that_of_the_bytes(robot_path):
    path = robot_path(SOUND)
    assert load_robot(path).sha256 == sha256(path.read_bytes()).hexdigest()
