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


def test_json_is_in_metres(capsys):
    assert cli.main(["faces", str(ROCKER), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    bores = {face["number"]: face["radius"] for face in document["faces"] if face["kind"] == "bore"}
    assert bores == pytest.approx({8: 0.022, 9: 0.028, 10: 0.016, 11: 0.016}, rel=1e-9)
