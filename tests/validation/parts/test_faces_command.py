"""`flexproof faces` on a part of the examples."""

import json
from pathlib import Path

import pytest

from validation import cli

ROCKER = Path(__file__).resolve().parents[3] / "examples" / "rocker" / "rocker.step"


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
def test_a_file_that_ends_the_kernel_is_a_line_and_nothing_else(tmp_path, capfd, command):
    part, robot = tmp_path / "rocker.step", tmp_path / "robot.toml"
    part.write_text(ROCKER.read_text().replace("MANIFOLD_SOLID_BREP", "SHELL_BASED_SURFACE_MODEL"))
    robot.write_bytes(ROCKER.with_name("robot.toml").read_bytes())
    assert cli.main([word.format(part=part, robot=robot) for word in command]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert f"{part}: what reads it fails" in err


def test_json_is_in_metres(capsys):
    assert cli.main(["faces", str(ROCKER), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    bores = {face["number"]: face["radius"] for face in document["faces"] if face["kind"] == "bore"}
    assert bores == pytest.approx({8: 0.022, 9: 0.028, 10: 0.016, 11: 0.016}, rel=1e-9)
