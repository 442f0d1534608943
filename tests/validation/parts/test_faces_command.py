"""`flexproof faces` on a part of the examples, what it says elsewhere, and what is kept of it."""

import re
from pathlib import Path

import numpy as np
import pytest
from drawn_parts import written
from forgetting import forget

from lumped.errors import InputError
from lumped.memo import fingerprint
from meshes.part.interfaces import find_interfaces
from meshes.part.reading import read
from validation import cli
from validation.parts import meshes
from validation.parts.face_list import as_text
from validation.parts.meshes import part_file
from validation.parts.request import interfaces_of

pytestmark = pytest.mark.usefixtures("coarse_parts")
HOME = Path(__file__).resolve().parents[3]
ROCKER = HOME / "examples" / "rocker" / "rocker.step"


@pytest.fixture(scope="module")
def part():
    return read.read_part(ROCKER)


@pytest.fixture
def once_read(part, monkeypatch):
    """Commands take the part as it was read."""
    monkeypatch.setattr(read, "read_part", lambda *_: part)


def found(part, choice):
    (interface,) = find_interfaces(part, *interfaces_of([f"A = {choice}"]))
    return interface


@pytest.mark.usefixtures("once_read")
def test_faces_are_listed_in_the_unit_of_the_file_and_drawn_in_colours(capsys, tmp_path):
    image = pytest.importorskip("PIL.Image")
    assert cli.main(["faces", str(ROCKER), "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    assert "read in mm: 343 × 263 × 60 mm" in said.out
    assert "    8  bore         8293.8  0, 0, 0                     0, 0, 1" in said.out
    page, drawn = (tmp_path / f"rocker.step.faces.{kind}" for kind in ("html", "png"))
    if not page.exists():
        assert "no usable OpenGL" in said.err
        return
    assert "showScene(document.getElementById('scene'), '" in page.read_text("utf-8")
    colours = image.open(drawn).convert("RGB").getcolors(1 << 20)
    # The plates' two large faces are of different colours, and each fills a fair share.
    large = [colour for count, colour in sorted(colours, reverse=True)[:12] if count > 3000]
    assert len(large) >= 3


@pytest.mark.usefixtures("once_read")
def test_json_is_in_metres(command):
    document = command.json("faces", ROCKER)
    bores = {face["number"]: face["radius"] for face in document["faces"] if face["kind"] == "bore"}
    assert bores == pytest.approx({8: 0.022, 9: 0.028, 10: 0.016, 11: 0.016}, rel=1e-9)


def test_what_faces_prints_can_be_pasted(part):
    choices = re.findall(r"\{ (?:cylinder|faces) = .*? \}(?: \})?", as_text(part))
    by_cylinder, by_number = (found(part, choice) for choice in choices)
    assert set(by_number.faces) <= set(by_cylinder.faces)
    np.testing.assert_allclose(by_cylinder.on_axis, by_number.on_axis, atol=1e-9)


def test_every_choice_of_the_guide_is_read():
    guide = (HOME / "docs" / "guide" / "parts.md").read_text(encoding="utf-8")
    choices = re.findall(r"^\| `(\{.*\})` \|", guide, re.MULTILINE)
    assert len(choices) == 4
    for choice in choices:
        wanted, points = interfaces_of([f"A = {choice[:-1]}, point = [0.1, 0.2, 0.3] }}"])
        assert list(wanted) == ["A"]
        np.testing.assert_array_equal(points["A"], [0.1, 0.2, 0.3])


def test_a_point_beside_the_cylinder_tells_bores_of_one_radius_apart(part):
    """Both small bores of the rocker have 16 mm; the point is the interface's, too."""
    with pytest.raises(InputError, match=r"on different axes; say point = \[x, y, z\]"):
        found(part, "{ cylinder = { radius = 0.016 } }")
    for point in ([0.26, 0.0, 0.01], [0.09, 0.18, 0.01]):
        interface = found(part, f"{{ cylinder = {{ radius = 0.016 }}, point = {point} }}")
        np.testing.assert_array_equal(interface.point, point)
        np.testing.assert_allclose(interface.on_axis[:2], point[:2], atol=1e-9)


def test_another_name_is_refused_by_the_right_one(part):
    with pytest.raises(InputError, match=r"at.*point"):
        found(part, "{ cylinder = { radius = 0.016 }, at = [0.26, 0.0, 0.0] }")


def test_what_is_kept_of_a_file_is_all_that_reading_finds(tmp_path, monkeypatch):
    """Its faces are a plate's with a bore; a byte more, or another unit, is another part."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def plate(kernel):
        kernel.cut(
            [(3, kernel.addBox(0, 0, 0, 90, 60, 8))],
            [(3, kernel.addCylinder(30, 30, 0, 0, 0, 8, 9))],
        )

    path = written(tmp_path / "plate.brep", plate)
    found = read.read_part(path, "mm")
    assert [face.kind for face in found.faces].count("bore") == 1
    assert fingerprint(part_file(path, "mm")) == fingerprint(found)
    asked = []
    monkeypatch.setattr(meshes, "read_part", lambda *one: asked.append(one) or pytest.fail("read"))
    forget()
    assert fingerprint(part_file(path, "mm")) == fingerprint(found)
    assert asked == []
    with pytest.raises(pytest.fail.Exception):
        part_file(path, "m")
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(pytest.fail.Exception):
        part_file(path, "mm")


@pytest.mark.parametrize(
    "command",
    [
        ["faces", "{part}", "--json"],
        [
            *("identify", "{part}", "--material", "{{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}"),
            *("--interface", "A = {{ faces = [1] }}", "--json"),
        ],
        ["check", "{robot}"],
    ],
    ids=lambda command: command[0],
)
def test_a_file_that_ends_the_kernel_is_one_line(tmp_path, capfd, coarse_parts, command):
    coarse_parts.undo()
    part, robot = tmp_path / "rocker.step", tmp_path / "robot.toml"
    part.write_text(ROCKER.read_text().replace("MANIFOLD_SOLID_BREP", "SHELL_BASED_SURFACE_MODEL"))
    robot.write_bytes(ROCKER.with_name("robot.toml").read_bytes())
    assert cli.main([word.format(part=part, robot=robot) for word in command]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert f"{part}: its reader fails" in err
