"""Marks of result files: commands replace earlier results and no files of the user."""

import ast
import csv
import io
from xml.etree import ElementTree as ET

import matplotlib.image
import numpy as np
import pytest
from scipy.io import loadmat, savemat
from support.pages.report_sample import PIXEL
from support.robots.gantry import GANTRY

from lumped.errors import InputError
from validation.console.marks import is_marked, with_mark
from validation.console.typed import require_writable, write

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


# A small file of each kind, and a function that reads its content.
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
    ".vtu": (
        b'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid"><a/></VTKFile>\n',
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
def test_marked_output_file_keeps_content(kind):
    """Result files have a mark, which distinguishes them from files of the user."""
    content, reader = KINDS[kind]
    assert with_mark(content, kind) != content
    assert reader(with_mark(content, kind)) == reader(content)


def test_kind_without_mark_is_replaced_on_request(tmp_path):
    """A new output format works before marks know its suffix."""
    path = tmp_path / "table.md"
    write(path, b"| a |\n", ".md")
    assert path.read_bytes() == b"| a |\n"
    with pytest.raises(InputError, match="--force"):
        require_writable(path, ".md", force=False)
    require_writable(path, ".md", force=True)


@pytest.mark.parametrize("kind", KINDS)
def test_changed_file_loses_its_mark(kind, tmp_path):
    """One changed byte anywhere in a result file; CSV files are recognised by their line ends."""
    content, path = KINDS[kind][0], tmp_path / f"own{kind}"
    result = with_mark(content, kind)
    path.write_bytes(result)
    assert is_marked(path, kind)
    # The mark of a table is no digest, because CSV has no comments.
    for position in () if kind == ".csv" else range(0, len(result), max(1, len(result) // 40)):
        changed = bytearray(result)
        changed[position] ^= 0x01
        path.write_bytes(changed)
        assert not is_marked(path, kind), position
    foreign_contents = [content, b"", FOREIGN, b"\n", b"\r\n", b"a\nb"]
    foreign_contents += [b"a\r\nb\r\n", b"a\rb\rc\r"]
    if kind != ".csv":
        foreign_contents += [result[:-1], result + b"\n", result[:40]]
    for foreign in foreign_contents:
        path.write_bytes(foreign)
        assert not is_marked(path, kind), foreign
    assert not is_marked(tmp_path, kind)
    # A mark of one format is not valid in another, except in two formats with equal comments.
    for other in KINDS:
        path.write_bytes(with_mark(KINDS[other][0], other))
        equal_comments = {kind, other} <= {".svg", ".html", ".vtu"}
        assert is_marked(path, kind) is (kind == other or equal_comments), other


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
def test_command_replaces_only_own_results(name, folder, command):
    """Files of the user and results changed by the user need --force."""
    path, words = folder / name, WRITTEN[name]
    path.write_bytes(FOREIGN)
    message = command.error_line(*words)
    assert message.startswith(f"flexproof: {name}: exists already and was not written by flexproof")
    assert message.endswith("give another name, or replace it with --force")
    assert path.read_bytes() == FOREIGN
    command.output(*words, "--force")
    first = path.read_bytes()
    assert FOREIGN not in first
    command.output(*words)
    # Dates of archives and headers may differ.
    assert len(path.read_bytes()) == len(first)
    changed = path.read_bytes()[:-1] + b"\r\n"
    path.write_bytes(changed)
    assert "or was changed since" in command.error_line(*words)
    assert path.read_bytes() == changed


@pytest.mark.parametrize("kind", KINDS)
def test_own_result_without_suffix_is_replaced(kind, folder):
    """The file name has no suffix, as in `identify --out matrices`, and is written twice."""
    path, (content, _) = folder / "matrices", KINDS[kind]
    for _ in range(2):
        require_writable(path, kind)
        write(path, content, kind)
    assert is_marked(path, kind)
    # A foreign file without the ending is not replaced, even with --force.
    path.write_bytes(FOREIGN)
    for force in (False, True):
        with pytest.raises(
            InputError, match=rf"is not a \{kind} file; give the name of a new file"
        ):
            require_writable(path, kind, force=force)


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
def test_foreign_file_is_never_replaced(name, words, folder, command):
    """The command is refused before its computation, which would fail here."""
    path = folder / name
    path.write_bytes(FOREIGN)
    command.error_line(*words)
    assert path.read_bytes() == FOREIGN
    assert {file.name for file in folder.iterdir()} == {ROBOT, name}
