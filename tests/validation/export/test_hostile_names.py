"""Texts of a robot file, exported to scripts, decks, tables and pages, are never executed.

A name may be an encoding declaration of Python (PEP 263), end a comment or a string, or be a
formula.
"""

import ast
import csv
import io
import json
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import msgspec
import numpy as np
import pytest
from scipy.io import loadmat
from support.pages.report_sample import FIG_5, FINDING, HEADER, MATRIX, sample_report, unmeasured
from support.robots.gantry import GANTRY
from support.robots.robot_from_text import described, robot_of

from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import reference_posture
from meshes.part.reading.read import read_part
from validation.drawing.chart import Chart, Panel, Series
from validation.drawing.plot import chart_svg
from validation.drawing.style import csv_of
from validation.export.formats import as_exudyn, as_nastran, as_npz, as_simscape
from validation.export.reduced import Reduced, reduced_robot
from validation.parts import face_list
from validation.report.page import render
from validation.studies_and_figures import Figure

ROCKER = Path(__file__).parents[3] / "examples/rocker/rocker.step"
# In the first name "+AAo-" is a line end in UTF-7, after which Python would run the rest.
NAMES = (
    "coding: utf-7 +AAo-import os+ADs-os.abort()+ACM-",
    "coding=rot13",
    "vim: set modeline: -*- coding: utf-7 -*-",
    'end""" + 1 / 0 \\N{',
    "''' \\",
    "{name} {0} %s",
    "$ENDDATA",
    "µ 中 😀",
)


@pytest.fixture(scope="module")
def reduced():
    return reduced_robot(reference_posture(described(GANTRY)), 3).matrices


@pytest.mark.parametrize("name", NAMES)
def test_script_runs_for_any_robot_name(name, reduced):
    """The syntax tree of the script is the same for every name."""
    script = as_exudyn(replace(reduced, name=name))
    # ast.parse decodes bytes as Python decodes a file, with the declared encoding.
    assert ast.dump(ast.parse(script)) == ast.dump(ast.parse(as_exudyn(reduced)))
    first, *lines = script.decode("utf-8").split("\n")
    assert first == "# -*- coding: utf-8 -*-"
    assert not any(name in line for line in lines[:4])
    assert f"# {name}: {reduced.about}." in lines


@pytest.fixture(scope="module")
def body():
    """Reduced body with two interfaces and three modes. Its matrices have arbitrary entries."""
    stiffness = np.random.default_rng(0).uniform(-1.0, 1.0, (15, 15))
    return Reduced(
        name="body",
        about="free body",
        unknowns=tuple(str(i) for i in range(15)),
        stiffness=stiffness + stiffness.T,
        mass=np.eye(15),
        ports={"A": np.eye(15)[:6], "B": np.eye(15)[6:12]},
        points={"A": np.zeros(3), "B": np.array([0.5, -0.25, 0.0])},
        frequencies=np.array([10.0]),
        bounds=np.array([0.1]),
        counted={},
    )


@pytest.mark.parametrize("name", NAMES)
def test_deck_cards_ignore_robot_name(name, body):
    """Only comments of the Nastran deck contain the name, in ASCII."""
    pytest.importorskip("pyyeti.nastran", reason="pyyeti is not installed")

    def cards(content):
        return [line for line in content.split(b"\n") if not line.startswith(b"$")]

    deck = as_nastran(replace(body, name=name))
    assert deck.isascii()
    assert cards(deck) == cards(as_nastran(body))


def test_deck_has_one_point_per_unknown(body):
    """A scalar point in no matrix would be a free motion without mass: a singular system."""
    nastran = pytest.importorskip("pyyeti.nastran", reason="pyyeti is not installed")
    text = as_nastran(body).decode()
    matrix = nastran.rddmig(io.StringIO(text))["kred"]
    # The deck has ten digits.
    assert np.allclose(matrix.to_numpy(), body.stiffness, rtol=0.0, atol=1e-8)
    freedoms = list(matrix.index)
    (card,) = (line for line in text.splitlines() if line.startswith("SPOINT"))
    # Fields of eight characters.
    first, through, last = card[8:16], card[16:24], card[24:32]
    assert through.split() == ["THRU"]
    scalar_points = [point for point, component in freedoms if component == 0]
    assert list(range(int(first), int(last) + 1)) == scalar_points
    grids = [int(line[8:24]) for line in text.splitlines() if line.startswith("GRID*")]
    assert [(grid, component) for grid in grids for component in range(1, 7)] == freedoms[:12]
    assert len(freedoms) == 15


@pytest.mark.parametrize("name", NAMES)
def test_npz_needs_no_pickle_for_names(name, reduced):
    """Names are stored as texts, which NumPy loads with allow_pickle=False."""
    renamed = replace(reduced, name=name)
    arrays = np.load(io.BytesIO(as_npz(renamed)), allow_pickle=False)
    assert str(arrays["about"]).startswith(f"{name}: ")
    (about,) = loadmat(io.BytesIO(as_simscape(renamed)))["about"]
    assert about.startswith(f"{name}: ")


@pytest.mark.parametrize("sign", ["\\u0085", "\\u009b2J", "\\u2028", "\\u202e", "\\u2066", "\\n"])
def test_control_characters_are_refused(sign, tmp_path):
    """Line ends, terminal codes and text direction marks in a robot's name."""
    with pytest.raises(
        InputError, match=r"name = .*: must be a text of 1 to 100 characters on one"
    ):
        robot_of(GANTRY.replace('"gantry"', f'"gan{sign}try"'), tmp_path)


def test_spreadsheet_formulas_are_escaped():
    """Texts that a spreadsheet would compute begin with an apostrophe; numbers do not."""
    formulas = ("=1+2", "+A1", "-A1*2", "@SUM(A1)", "\t=1", " =1", "\uff1d1", "-1-1", "-cmd|' '!A")
    numbers = ("-0.3", "+1.5e-3", "-0.6 0.8 0", "0.1, -0.2", "-12 %", "", "vjm", "a=1", "x-y")
    columns = {"=HYPERLINK(A1)": [*formulas, *numbers, -1.5, None]}
    (heading,), *rows = csv.reader(io.StringIO(csv_of(columns)))
    assert heading == "'=HYPERLINK(A1)"
    cells = [row[0] if row else "" for row in rows]
    assert cells == [*(f"'{formula}" for formula in formulas), *numbers, "-1.5", ""]


def test_face_names_keep_json_valid(tmp_path, command):
    """Control characters and quotes in the name of a CAD face, and in a robot's name."""
    part = read_part(ROCKER)
    renamed = replace(part.faces[0], name="\x85\x9b\u202e\U000e0001\"</script>'")
    part = replace(part, faces=(renamed, *part.faces[1:]))
    # On terminals unprintable characters are escaped in a form that JSON does not allow.
    assert face_list.as_json(part).isascii()
    assert json.loads(face_list.as_json(part))["faces"][0]["name"] == renamed.name
    robot = tmp_path / "robot.toml"
    robot.write_text(GANTRY.replace('"gantry"', '"\\u200b\\U000e0001"'), encoding="utf-8")
    assert command.json("kinematics", robot)["robot"] == "\u200b\U000e0001"


HOSTILE = '</text><script>alert(1)</script> --><svg onload="x"> id="a" &amp; ]]> $\\frac{'


def test_drawing_shows_markup_as_text():
    """Labels and titles of a chart are escaped in its SVG."""
    curve = np.array([0.0, 1.0])
    panels = [Panel([Series(HOSTILE, curve, curve)], HOSTILE, y_label=HOSTILE)]
    figure = Figure("a", "A", "", "Toys", svg=chart_svg(Chart(panels, HOSTILE)))
    tags = {element.tag.rpartition("}")[2] for element in ET.fromstring(figure.svg).iter()}  # noqa: S314  our own
    assert "path" in tags
    assert "script" not in tags


class Elements(HTMLParser):
    """List of (element, names of its attributes) of a page."""

    def __init__(self, markup):
        super().__init__()
        self.elements = []
        self.feed(markup)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, [name for name, _ in attributes]))


@pytest.mark.usefixtures("blank_charts")
def test_names_add_no_page_elements(monkeypatch):
    """The report with markup in all texts has the elements of the report with plain texts."""

    def page(text):
        def with_text(record, *names):
            copy = msgspec.structs.replace if isinstance(record, msgspec.Struct) else replace
            return copy(record, **{name: text for name in names if getattr(record, name)})

        matrix = replace(
            with_text(MATRIX, "robot"),
            notes=(text,),
            entries=tuple(
                with_text(entry, "reason", "reference", "remedy") for entry in MATRIX.entries
            ),
            models=tuple(with_text(model, "title") for model in MATRIX.models),
        )
        figures = [with_text(FIG_5, "title", "caption")]
        finding = with_text(FINDING, "where", "printed", "wrong", "evidence", "used")
        for name in ("robot", "robot_file", "machine"):
            monkeypatch.setitem(HEADER, name, text)
        outcomes = [unmeasured("a", "failed", text), unmeasured("b", "skipped", text)]
        report = sample_report(
            outcomes=outcomes, figures=figures, matrix=matrix, findings=(finding,)
        )
        return Elements(render(report)).elements

    plain = page("plain")
    assert ("script", []) in plain
    assert page(HOSTILE) == plain


@pytest.mark.parametrize(
    "markup",
    [
        "<script>alert(1)</script>",
        '<g onload="alert(1)"></g>',
        '<g  OnLoad="alert(1)"></g>',
        "<g onload=alert(1)></g>",
        "<foreignObject><b>x</b></foreignObject>",
        '<use xlink:href="https://example.org/x.svg#a"/>',
        '<image href="javascript:alert(1)"/>',
        '<path style="fill: url(https://example.org/a)"/>',
        "<style>@import 'https://example.org/a.css';</style>",
        "<!--><img src=x onerror=alert(1)>-->",
        "<!DOCTYPE svg>",
        "<title><img></title>",
        "<g",
    ],
)
def test_active_drawing_is_refused(markup):
    """Scripts, event handlers and foreign objects in an SVG."""
    with pytest.raises(ValueError, match="is not allowed in a drawing"):
        Figure("a", "A", "", "Toys", svg=f"<svg >{markup}</svg>")
