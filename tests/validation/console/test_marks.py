"""Files that a command writes replace earlier results, and nothing of the user's own."""

import ast
import csv
import io
from xml.etree import ElementTree as ET

import matplotlib.image
import numpy as np
import pytest
from gantry import GANTRY
from report_sample import PIXEL
from scipy.io import loadmat, savemat

from lumped.errors import InputError
from validation.console.marks import is_marked, marked
from validation.console.typed import require_place, write

ROBOT = "robot.toml"
FOREIGN = b"written by flexproof? No, by me.\n"


def archive():
    content = io.BytesIO()
    np.savez_compressed(content, K=np.eye(3))
    return content.getvalue()


def matlab():
    content = io.BytesIO()
    savemat(content, {"K": np.eye(3)})
    return content.getvalue()


# A small file of each kind, and its content as programs read it.
KINDS = {
    ".py": (b"# -*- coding: utf-8 -*-\n\nK = 1\n", lambda text: ast.dump(ast.parse(text))),
    ".bdf": (
        b"$ deck\nGRID,1\n",
        lambda text: [line for line in text.split(b"\n") if line[:1] != b"$"],
    ),
    ".csv": (
        'x (µm),"a, b"\n1.5,"c\nd"\n,2\n'.encode(),
        lambda text: list(csv.reader(io.StringIO(text.decode(), newline=""))),
    ),
    ".svg": (
        b'<svg >\n<g id="a"/></svg>\n',
        lambda text: ET.canonicalize(text.decode(), strip_text=True),
    ),
    ".html": (
        b"<!DOCTYPE html>\n<html><p>x</p></html>\n",
        lambda text: text[text.index(b"<html>") :],
    ),
    ".png": (PIXEL, lambda text: matplotlib.image.imread(io.BytesIO(text)).tolist()),
    ".npz": (archive(), lambda text: np.load(io.BytesIO(text))["K"].tolist()),
    ".mat": (matlab(), lambda text: loadmat(io.BytesIO(text))["K"].tolist()),
}


@pytest.mark.parametrize("kind", KINDS)
def test_marked_file_is_read_as_before(kind):
    content, read = KINDS[kind]
    assert marked(content, kind) != content
    assert read(marked(content, kind)) == read(content)


@pytest.mark.parametrize("kind", KINDS)
def test_mark_holds_for_the_unchanged_file_alone(kind, tmp_path):
    content, own = KINDS[kind][0], tmp_path / f"own{kind}"
    whole = marked(content, kind)
    own.write_bytes(whole)
    assert is_marked(own, kind)
    # The mark of a table, which has no room for one, is no digest.
    for place in () if kind == ".csv" else range(0, len(whole), max(1, len(whole) // 40)):
        changed = bytearray(whole)
        changed[place] ^= 0x01
        own.write_bytes(changed)
        assert not is_marked(own, kind), place
    foreign_ones = [content, b"", FOREIGN, b"\n", b"\r\n", b"a\nb", b"a\r\nb\r\n", b"a\rb\rc\r"]
    if kind != ".csv":
        foreign_ones += [whole[:-1], whole + b"\n", whole[:40]]
    for foreign in foreign_ones:
        own.write_bytes(foreign)
        assert not is_marked(own, kind), foreign
    assert not is_marked(tmp_path, kind)
    # A mark of one format means nothing in another.
    for other in KINDS:
        own.write_bytes(marked(KINDS[other][0], other))
        alike = {kind, other} <= {".svg", ".html"}
        assert is_marked(own, kind) is (kind == other or alike), other


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ROBOT).write_text(GANTRY, encoding="utf-8")
    return tmp_path


VARY = ("solve", "five-bar", "--model", "simplified", "--vary", "tool.mass=1:2:2")
WRITTEN = {
    "robot.npz": ("export", ROBOT, "--to", "npz", "--modes", 3),
    "robot.py": ("export", ROBOT, "--to", "exudyn", "--modes", 3),
    "robot.statespace.npz": ("export", ROBOT, "--to", "statespace", "--modes", 3),
    "robot.statespace.mat": (
        *("export", ROBOT, "--to", "statespace", "--modes", 3),
        *("--out", "robot.statespace.mat"),
    ),
    "table.csv": (*VARY, "--csv", "table.csv"),
    "picture.png": (*VARY, "--picture", "picture.png"),
    "studies.csv": ("converge", "five-bar", "--elements", "2,4,8", "--csv", "studies.csv"),
    "studies.svg": ("converge", "five-bar", "--elements", "2,4,8", "--picture", "studies.svg"),
}


@pytest.mark.parametrize("name", WRITTEN)
def test_command_replaces_its_own_result_and_no_other(name, folder, command):
    path, words = folder / name, WRITTEN[name]
    path.write_bytes(FOREIGN)
    said = command.refused(*words)
    assert said.startswith(f"flexproof: {name}: exists already and was not written by flexproof")
    assert said.endswith("must be the name of a new file, or be replaced with --force")
    assert path.read_bytes() == FOREIGN
    command.told(*words, "--force")
    first = path.read_bytes()
    assert FOREIGN not in first
    command.told(*words)
    # Dates of archives and headers may differ.
    assert len(path.read_bytes()) == len(first)
    changed = path.read_bytes()[:-1] + b"\r\n"
    path.write_bytes(changed)
    assert "or was changed since" in command.refused(*words)
    assert path.read_bytes() == changed


@pytest.mark.parametrize("kind", KINDS)
def test_own_result_is_replaced_whatever_its_name(kind, folder):
    """`identify --out matrices` refused its own file, and called it a foreign one."""
    path, (content, _) = folder / "matrices", KINDS[kind]
    for _ in range(2):
        require_place(path, kind)
        write(path, content, kind)
    assert is_marked(path, kind)
    # Without the ending no foreign file is replaced, not even by force.
    path.write_bytes(FOREIGN)
    for force in (False, True):
        with pytest.raises(InputError, match=rf"only \{kind} files are replaced"):
            require_place(path, kind, force=force)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("arm.bdf", ("export", ROBOT, "--to", "nastran", "--body", "bridge", "--out", "arm.bdf")),
        ("arm.mat", ("export", ROBOT, "--to", "simscape", "--body", "bridge", "--out", "arm.mat")),
        ("drawn.png", ("kinematics", ROBOT, "--picture", "drawn.png")),
        ("part.npz", ("identify", ROBOT, "--body", "bridge", "--out", "part.npz")),
        ("part.step.faces.png", ("faces", "part.step")),
        ("part.step.faces.html", ("faces", "part.step")),
        ("run.json", ("run", ROBOT, "--preset", "quick", "--out", ".")),
        (ROBOT, ("new", ROBOT)),
    ],
)
def test_no_command_writes_over_a_foreign_file(name, words, folder, command):
    """Refused before anything is computed: none of these robots and parts has such results."""
    path = folder / name
    path.write_bytes(FOREIGN)
    command.refused(*words)
    assert path.read_bytes() == FOREIGN
    assert {one.name for one in folder.iterdir()} == {ROBOT, name}
