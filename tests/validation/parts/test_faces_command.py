"""Command `faces` on a part of the examples, typed interfaces, and stored part files."""

import re
from pathlib import Path

import numpy as np
import pytest
from support.fakes.cleared_memory import forget
from support.pages.messages import only_message
from support.robots.drawn_parts import written

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
def read_once(part, monkeypatch):
    """Make commands use the part that was read once for all tests of this module."""
    monkeypatch.setattr(read, "read_part", lambda *_: part)


def interface_at(part, choice):
    (interface,) = find_interfaces(part, *interfaces_of([f"A = {choice}"]))
    return interface


@pytest.mark.usefixtures("read_once")
def test_faces_are_listed_in_mm_and_drawn(capsys, tmp_path):
    """Rocker of the examples: size, a row for each face, a picture and a page."""
    image = pytest.importorskip("PIL.Image")
    assert cli.main(["faces", str(ROCKER), "--out", str(tmp_path)]) == 0
    written = capsys.readouterr()
    assert "read in mm: 343 × 263 × 60 mm" in written.out
    assert "    8  bore         8293.8  0, 0, 0                     0, 0, 1" in written.out
    page, picture = (tmp_path / f"rocker.step.faces.{kind}" for kind in ("html", "png"))
    if not page.exists():
        assert "no usable OpenGL" in written.err
        return
    assert "showScene(document.getElementById('scene'), '" in page.read_text("utf-8")
    colours = image.open(picture).convert("RGB").getcolors(1 << 20)
    # The two large faces of the plate differ in colour, and each covers a large share.
    large = [colour for count, colour in sorted(colours, reverse=True)[:12] if count > 3000]
    assert len(large) >= 3


@pytest.mark.usefixtures("read_once")
def test_json_of_faces_is_in_metres(command):
    """Radii of the rocker's four bores."""
    document = command.json("faces", ROCKER)
    bores = {face["number"]: face["radius"] for face in document["faces"] if face["kind"] == "bore"}
    assert bores == pytest.approx({8: 0.022, 9: 0.028, 10: 0.016, 11: 0.016}, rel=1e-9)


def test_printed_interface_example_is_valid(part):
    """The examples at the end of the list select the same bore by radius and by number."""
    choices = re.findall(r"\{ (?:cylinder|faces) = .*? \}(?: \})?", as_text(part))
    by_cylinder, by_number = (interface_at(part, choice) for choice in choices)
    assert set(by_number.faces) <= set(by_cylinder.faces)
    np.testing.assert_allclose(by_cylinder.on_axis, by_number.on_axis, atol=1e-9)


def test_guide_interface_examples_are_valid():
    """The four forms in the table of parts.md."""
    guide = (HOME / "docs" / "guide" / "parts.md").read_text(encoding="utf-8")
    choices = re.findall(r"^\| `(\{.*\})` \|", guide, re.MULTILINE)
    assert len(choices) == 4
    for choice in choices:
        interfaces, points = interfaces_of([f"A = {choice[:-1]}, point = [0.1, 0.2, 0.3] }}"])
        assert list(interfaces) == ["A"]
        np.testing.assert_array_equal(points["A"], [0.1, 0.2, 0.3])


def test_point_selects_one_of_equal_bores(part):
    """Both small bores of the rocker have a radius of 16 mm; a point on one of them selects it."""
    with pytest.raises(InputError, match=r"on different axes; give point = \[x, y, z\]"):
        interface_at(part, "{ cylinder = { radius = 0.016 } }")
    for point in ([0.26, 0.0, 0.01], [0.09, 0.18, 0.01]):
        interface = interface_at(part, f"{{ cylinder = {{ radius = 0.016 }}, point = {point} }}")
        np.testing.assert_array_equal(interface.point, point)
        np.testing.assert_allclose(interface.on_axis[:2], point[:2], atol=1e-9)


def test_unknown_interface_key_has_suggestion(part):
    """`at` instead of `point`."""
    with pytest.raises(InputError, match=r"at.*point"):
        interface_at(part, "{ cylinder = { radius = 0.016 }, at = [0.26, 0.0, 0.0] }")


def test_cached_part_equals_file(tmp_path, monkeypatch):
    """Plate with a bore, from the cache. If the file or the unit changes, it is read again."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))

    def plate(kernel):
        kernel.cut(
            [(3, kernel.addBox(0, 0, 0, 90, 60, 8))],
            [(3, kernel.addCylinder(30, 30, 0, 0, 0, 8, 9))],
        )

    path = written(tmp_path / "plate.brep", plate)
    part = read.read_part(path, "mm")
    assert [face.kind for face in part.faces].count("bore") == 1
    assert fingerprint(part_file(path, "mm")) == fingerprint(part)
    calls = []
    monkeypatch.setattr(
        meshes, "read_part", lambda *args: calls.append(args) or pytest.fail("read")
    )
    forget()
    assert fingerprint(part_file(path, "mm")) == fingerprint(part)
    assert calls == []
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
def test_crashing_cad_file_gives_one_error_line(tmp_path, capfd, coarse_parts, command):
    """`faces`, `identify` and `check` on a file that crashes the CAD kernel."""
    coarse_parts.undo()
    part, robot = tmp_path / "rocker.step", tmp_path / "robot.toml"
    part.write_text(ROCKER.read_text().replace("MANIFOLD_SOLID_BREP", "SHELL_BASED_SURFACE_MODEL"))
    robot.write_bytes(ROCKER.with_name("robot.toml").read_bytes())
    assert cli.main([word.format(part=part, robot=robot) for word in command]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert f"{part}: the reader of the file fails" in only_message(err)
