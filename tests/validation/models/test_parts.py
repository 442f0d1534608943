"""CAD parts in robots: every model of the rocker, a prism as a part, and wrong files."""

from dataclasses import replace
from pathlib import Path

import pytest
from compliances import scaled_difference
from drawn_parts import plane_ends

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh
from validation import cli
from validation.models import parts
from validation.models.mechanism import answers
from validation.models.options import ModelOptions

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
CONDENSED = ModelOptions(parts="condensed")


@pytest.fixture
def coarse(monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "UNKNOWNS", 9000)
    monkeypatch.setattr(parts.identified, "__defaults__", (9000, 2))
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.exhaustive
@pytest.mark.usefixtures("coarse")
def test_a_rocker_of_three_bores_in_every_model_that_takes_it():
    robot = load_robot(EXAMPLES / "rocker" / "robot.toml")
    at = [reference_posture(robot.mechanism)]
    (links,) = answers("links", at, 0)
    (condensed,) = answers("segments", at, 3, CONDENSED)
    (solid,) = answers("solid", at, 3)
    # The rod bends nowhere here, and the rocker is one mesh: statics are those of the solid.
    assert condensed.compliance == pytest.approx(links.compliance, rel=1e-6, abs=1e-14)
    assert scaled_difference(links.compliance, solid.compliance) < 0.02
    # Guyan's mass lies above in frequency, by little for the first.
    assert condensed.frequencies[0] == pytest.approx(solid.frequencies[0], rel=0.02)
    with pytest.raises(InputError, match="3 interfaces is no link of a serial chain"):
        answers("vjm", at, 0)


@pytest.mark.exhaustive
def test_a_prism_written_as_step_is_the_leg_of_the_section_route(tmp_path):
    with gmsh_model("box") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.model.occ.addBox(0, -25, -40, 500, 50, 80)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "box.step"))
    part = read_part(tmp_path / "box.step")
    ends = plane_ends(0.5, "rigid")
    found = find_interfaces(part, ends)
    mesh = volume_mesh(part, found, Grading(0.011))
    body = held_part(meshed_part(mesh, STEEL), grips_of(mesh, found), "box")
    leg = ConstantLeg(0.5, Rectangle(0.05, 0.08), STEEL)
    reference = clamped_leg(solid_leg(leg, solid_mesh(leg, 5)), "rigid").compliance
    # What meshes of this size leave at the singular edges of the held ends: 5e-4 (three divisions
    # of the prism instead of five: 1.6e-3 in torsion).
    assert scaled_difference(body.compliance, reference) < 1e-3


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius = 0.022", "radius = 0.023", "no cylinder of radius 0.023 m; the nearest is face"),
        ("C = [0.09, 0.18, 0.0]", "C = [0.10, 0.18, 0.0]", "passes 10 mm from (0.1, 0.18, 0)"),
        ('step = "rocker.step"', 'step = "rock.step"', "rock.step: no such file"),
        ('step = "rocker.step"', 'mesh = "rocker.step"\nunit = "cm"', "contradicts it"),
    ],
)
def test_a_part_that_is_not_where_the_joints_are(tmp_path, capsys, old, new, message):
    text = (EXAMPLES / "rocker" / "robot.toml").read_text("utf-8")
    assert old in text
    (tmp_path / "robot.toml").write_text(text.replace(old, new), "utf-8")
    (tmp_path / "rocker.step").write_bytes((EXAMPLES / "rocker" / "rocker.step").read_bytes())
    for command in (["solve", "--model", "links"], ["check"]):
        assert cli.main([command[0], str(tmp_path / "robot.toml"), *command[1:]]) == 2
        said = capsys.readouterr().err
        assert message in said
        assert "bodies.rocker" in said


def test_checking_a_robot_opens_the_files_of_its_parts(capsys):
    assert cli.main(["check", str(EXAMPLES / "rocker" / "robot.toml")]) == 0
    said = capsys.readouterr().out
    assert "rocker: rocker.step, read in mm: 343 × 263 × 60 mm" in said
    for point, radius in (("A", 22), ("B", 16), ("C", 16)):
        (line,) = (one for one in said.splitlines() if one.startswith(f"  {point}: face"))
        assert f"(bore of radius {radius} mm), its axis 0 mm from the point" in line
        assert line.endswith("rigid by default")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('material = "steel"\n\n[bodies.rocker.i', "\n[bodies.rocker.i", "material: missing"),
        ("A = { cylinder = { radius = 0.022 } }", "A = {}", "A: does not say which faces"),
        ("A = { cylinder", "Z = { cylinder", "Z"),
        ("rho = 7850.0", "", "rho: missing"),
        ('step = "rocker.step"', 'step = "rocker.step"\nmesh = "r.msh"', "read from one file"),
    ],
)
def test_a_robot_file_that_says_too_little_of_a_part(tmp_path, capsys, old, new, message):
    text = (EXAMPLES / "rocker" / "robot.toml").read_text("utf-8")
    assert old in text
    (tmp_path / "robot.toml").write_text(text.replace(old, new, 1), "utf-8")
    assert cli.main(["check", str(tmp_path / "robot.toml")]) == 2
    assert message in capsys.readouterr().err


def test_a_part_of_a_robot_is_asked_for_by_its_name(capsys):
    robot = str(EXAMPLES / "rocker" / "robot.toml")
    assert cli.main(["identify", robot, "--body", "rod"]) == 2
    assert "the parts of" in capsys.readouterr().err
    bodies = load_robot(robot).mechanism.bodies
    assert replace(bodies["rocker"]).interfaces["B"].position == pytest.approx([0.26, 0.0, 0.0])


def test_a_part_alone_is_identified_not_solved(capsys):
    robot = str(EXAMPLES / "rocker" / "robot.toml")
    assert cli.main(["solve", robot, "--model", "links", "--body", "rocker"]) == 2
    assert "is a part from a file, see flexproof identify" in capsys.readouterr().err
