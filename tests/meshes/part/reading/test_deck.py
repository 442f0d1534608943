"""Abaqus and CalculiX decks: all valid forms of a deck give one part, and CalculiX runs them."""

import shutil
import subprocess
from itertools import pairwise

import numpy as np
import pytest

from fem.calculix.run import PROGRAMS
from lumped.errors import InputError
from lumped.mechanism.body import ByName, PartInterface
from lumped.robot_file import included
from lumped.robot_file.included import part_content
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part

pytestmark = pytest.mark.usefixtures("in_this_process")

# A block of 1 × 1 × 2 m; ROOT is its face z = 0.
NODES = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 2.
6, 1., 0., 2.
7, 1., 1., 2.
8, 0., 1., 2.
"""
ELEMENT = "*ELEMENT, TYPE=C3D8, ELSET=EALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
ROOT = "*NSET, NSET=ROOT\n1, 2, 3, 4\n"
PLAIN = NODES + ELEMENT + ROOT

# Legal forms of the deck by name. CalculiX 2.20 runs these; those of OF_ABAQUS only Abaqus does.
FORMS = {
    "plain": PLAIN,
    "generate-two-values": NODES + ELEMENT + "*NSET, NSET=ROOT, GENERATE\n1, 4\n",
    "generate-three-values": NODES + ELEMENT + "*NSET, NSET=ROOT, GENERATE\n1, 3, 2\n2, 4, 2\n",
    "generate-beyond-last-node": PLAIN + "*NSET, NSET=X, GENERATE\n5, 99, 3\n",
    "generate-one-value": NODES + ELEMENT + "*NSET,NSET=ROOT,GENERATE\n1\n2\n3,4\n",
    "set-member-without-node": NODES + ELEMENT + "*NSET, NSET=ROOT\n1, 2, 3, 4, 99\n",
    "omitted-coordinates": "*NODE,NSET=NALL\n1\n2, 1.\n3, 1., 1.\n4, , 1.\n"
    + NODES[NODES.index("5,") :]
    + ELEMENT
    + ROOT,
    "fortran-exponents": PLAIN.replace("5, 0., 0., 2.", "5, 0.D0, 0., 0.2D+1").replace(
        "6, 1., 0., 2.", "6, 1.0+0, 0., 20.-1"
    ),
    "trailing-commas": PLAIN.replace("4, 0., 1., 0.", "4, 0., 1., 0.,").replace("7, 8", "7, 8,"),
    "normals-after-coordinates": PLAIN.replace("1, 0., 0., 0.", "1, 0., 0., 0., 0., 0., 1."),
    "nodes-in-two-blocks": PLAIN.replace("5, 0.", "*NODE, NSET=NALL\n5, 0."),
    "node-defined-again": PLAIN.replace("8, 0., 1., 2.", "8, 5., 5., 5.\n8, 0., 1., 2."),
    "element-before-nodes": ELEMENT + NODES + ROOT,
    "element-over-lines": PLAIN.replace("4, 5, 6", "4,\n5, 6"),
    "element-over-lines-without-comma": PLAIN.replace("4, 5, 6", "4\n5, 6"),
    "reduced-integration": PLAIN.replace("C3D8", "C3D8R"),
    "incompatible-modes": PLAIN.replace("C3D8", "C3D8I"),
    "other-elements": PLAIN + "*ELEMENT, TYPE=SPRING1, ELSET=SP\n9, 5\n*SPRING, ELSET=SP\n3\n1.\n",
    "blank-lines": PLAIN.replace("\n3,", "\n\n3,").replace("\n1, 1,", "\n\n1, 1,"),
    "comments": PLAIN.replace("\n3,", "\n** third\n3,").replace("\n1, 1,", "\n  ** one\n1, 1,"),
    "lower-case": PLAIN.lower(),
    "blanks": PLAIN.replace("*NODE,", "  * NODE ,").replace("TYPE=", " TYPE = "),
    "tabs": PLAIN.replace(", ", "\t,\t"),
    "windows-line-ends": PLAIN.replace("\n", "\r\n"),
    "set-of-sets": NODES
    + ELEMENT
    + "*NSET,NSET=A\n1,2\n*NSET,NSET=b\n3,4,\n*NSET,NSET=ROOT\na,B\n",
    "set-in-two-parts": NODES + ELEMENT + "*NSET,NSET=ROOT\n1,2\n*NSET,NSET=root\n3,4\n",
    "set-of-node-block": NODES.replace("NALL", "ROOT", 1).replace("5,", "*NODE\n5,", 1) + ELEMENT,
    "set-name-in-quotes": NODES + ELEMENT + '*NSET, NSET="ROOT"\n1, 2, 3, 4\n',
    "equals-in-set-name": PLAIN + "*NSET, NSET=a=b\n1\n",
    "heading": "*HEADING\nBlock, 1 by 1\n1, 2, 3\n" + PLAIN,
}
OF_ABAQUS = {
    "keyword-over-lines": PLAIN.replace("TYPE=C3D8, ", "TYPE=C3D8,\n"),
    "set-of-elements": NODES
    + ELEMENT
    + "*ELEMENT, TYPE=S4, ELSET=SKIN\n9, 1, 2, 3, 4\n*ELSET, ELSET=E, GENERATE\n1, 1\n"
    + ROOT
    + "*NSET, NSET=ALL, ELSET=E\n",
    "unsorted": PLAIN.replace("=ROOT", "=ROOT, UNSORTED"),
    # Node 1 of the assembly has the same number as a node of the part.
    "part-and-instance": f"*PART, NAME=P\n{NODES}{ELEMENT}*END PART\n*ASSEMBLY, NAME=A\n"
    "*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*NODE\n1, 9., 9., 9.\n*NSET, NSET=REF\n1\n"
    f"{ROOT.replace('=ROOT', '=ROOT, INSTANCE=P-1')}*END ASSEMBLY\n",
    "names-of-instances": f"*PART, NAME=P\n{NODES}{ELEMENT}*END PART\n*ASSEMBLY, NAME=A\n"
    "*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*NSET, NSET=ROOT\n"
    "P-1.1, P-1.2, P-1.3, P-1.4\n*END ASSEMBLY\n",
}
# Decks of several files: the text of the deck and the texts of its included files by name.
INCLUDED = {
    "included": ("*INCLUDE, INPUT=nodes.inp\n" + ELEMENT + ROOT, {"nodes.inp": NODES}),
    "included-data-lines": (
        f"*NODE, NSET=NALL\n*include,input=points.txt\n{ELEMENT}{ROOT}",
        {"points.txt": NODES.partition("\n")[2]},
    ),
    # Names of files are relative to the folder of the deck, also inside an included file.
    "included-in-folder": (
        "** a comment\n*INCLUDE, INPUT=mesh/all.inp\n" + ROOT,
        {
            "mesh/all.inp": "*INCLUDE, INPUT=mesh/nodes.inp\n" + ELEMENT,
            "mesh/nodes.inp": NODES,
        },
    ),
}
INCLUDED_OF_ABAQUS = {
    "included-over-lines": ("*INCLUDE,\nINPUT=nodes.inp\n" + ELEMENT + ROOT, {"nodes.inp": NODES}),
    "included-as-on-windows": (
        '* Include, Input = "mesh\\nodes.inp"\r\n' + ELEMENT + ROOT,
        {"mesh/nodes.inp": NODES.replace("\n", "\r\n")},
    ),
}


def read(folder, text):
    path = folder / "block.inp"
    path.write_bytes(text.encode())
    return read_part(path)


def written(folder, included_files):
    for name, text in included_files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(text.encode())


@pytest.mark.parametrize("form", [*FORMS, *OF_ABAQUS, *INCLUDED, *INCLUDED_OF_ABAQUS])
def test_deck_forms_give_same_part(tmp_path, form):
    """Bar of 1 × 1 × 2 m in each form of cards: the same mesh, faces and named interface."""
    text = (FORMS | OF_ABAQUS).get(form, "")
    if not text:
        text, included_files = (INCLUDED | INCLUDED_OF_ABAQUS)[form]
        written(tmp_path, included_files)
    part = read(tmp_path, text)
    assert part.mesh.element == "hex8"
    assert np.ptp(part.surface, axis=0) == pytest.approx([1.0, 1.0, 2.0], abs=1e-15)
    assert sorted(face.area for face in part.faces) == pytest.approx([1.0] * 2 + [2.0] * 4)
    (root,) = [face for face in part.faces if face.name.upper() == "ROOT"]
    assert root.centre == pytest.approx([0.5, 0.5, 0.0], abs=1e-15)
    assert root.direction == pytest.approx([0.0, 0.0, -1.0], abs=1e-15)
    assert find_interfaces(part, {"A": PartInterface(ByName(root.name))})[0].faces == (root.number,)


@pytest.mark.skipif(not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed")
def test_calculix_runs_legal_deck_forms(tmp_path):
    """One element clamped at one end under 1 N has the same displacement for every form."""
    program = next(path for name in PROGRAMS if (path := shutil.which(name)))
    analysis = (
        "*MATERIAL,NAME=S\n*ELASTIC\n2.1e11,0.3\n*SOLID SECTION,ELSET=EALL,MATERIAL=S\n"
        "*NSET,NSET=FIVE\n5\n*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n4,1,3\n*STEP\n*STATIC\n"
        "*CLOAD\n5,3,1.\n*NODE PRINT,NSET=FIVE\nU\n*END STEP\n"
    )
    displacements = {}
    forms = dict(FORMS)
    for form, (text, included_files) in INCLUDED.items():
        forms[form] = text
        written(tmp_path, included_files)
    for form, text in forms.items():
        (tmp_path / f"{form}.inp").write_bytes((text + analysis).encode())
        subprocess.run([program, form], cwd=tmp_path, check=True, capture_output=True)
        printed = (tmp_path / f"{form}.dat").read_text().split()
        displacements[form] = float(printed[-1])
    reduced = {"reduced-integration", "incompatible-modes", "other-elements"}
    for form in set(displacements) - reduced:
        # CalculiX prints seven digits.
        assert displacements[form] == pytest.approx(displacements["plain"], rel=2e-6), form


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (PLAIN.replace("1, 1, 2", "1, one, 2"), 'line 11: "one" is no num'),
        (PLAIN.replace("2, 1., 0.", "2, x, 0."), 'line 3: "x" is no number'),
        (PLAIN.replace("7, 8", "7"), r"line 11: element 1 has 7 nodes; must have 8 \(type C3D8\)"),
        (PLAIN.replace("7, 8", "7, 8, 8"), "line 11: element 1 has 9 nodes; must have 8"),
        (PLAIN.replace("7, 8", "7, 9"), "the file refers to node 9, which it does not contain"),
        (PLAIN + ELEMENT, "line 15: element 1 is given twice"),
        (PLAIN.replace("C3D8", "C3D27"), 'line 10: elements of the type "C3D27" are not known'),
        (PLAIN.replace(", TYPE=C3D8", ""), "line 10: elements of the type "),
        (PLAIN.replace("NSET=ROOT", ""), r"line 12: \*NSET must have a name: NSET="),
        (PLAIN.replace("3, 4\n", "3, QQ\n"), r'line 13: there is no \*NSET "QQ" above it'),
        (PLAIN + "*NSET,NSET=A,INSTANCE=P-1\n1\n", r'line 14: there is no \*INSTANCE "P-1"'),
        (PLAIN + "*NSET,NSET=A,GENERATE\n1,4,0\n", "line 15: the step of GENERATE is 0"),
    ],
)
def test_deck_error_has_line(tmp_path, text, fault):
    """Each fault gives one message with the line of the deck."""
    with pytest.raises(InputError, match=fault) as error:
        read(tmp_path, text)
    (line,) = error.value.faults
    assert "\n" not in line


@pytest.mark.parametrize(
    ("included_files", "fault"),
    [
        ({}, 'block.inp: line 2: *INCLUDE "a.inp": no such file; its name must count from the fo'),
        ({"a.inp": "\n*INCLUDE\n"}, "a.inp: line 2: *INCLUDE must name its file: INPUT=…"),
        ({"a.inp": "*INCLUDE, INPUT=../b.inp"}, 'a.inp: line 1: *INCLUDE "../b.inp": lies outside'),
        ({"a.inp": "*INCLUDE, INPUT=/etc/hosts"}, '*INCLUDE "/etc/hosts": lies outside the folder'),
        (
            {"a.inp": "\n*INCLUDE, INPUT=b.inp", "b.inp": "\n\n*INCLUDE, INPUT=a.inp"},
            'line 3: *INCLUDE "a.inp": includes itself (a.inp includes b.inp includes a.inp)',
        ),
        ({"a.inp": "*INCLUDE, INPUT=block.inp"}, "(block.inp includes a.inp includes block.inp)"),
        ({"a.inp": "*NODE\n9, one"}, 'a.inp: line 2: "one" is no number'),
        ({"a.inp/b": ""}, '*INCLUDE "a.inp": '),
        (
            {f"{'a' * k}.inp": f"*INCLUDE, INPUT={'a' * (k + 1)}.inp" for k in range(1, 12)},
            f'{10 * "a"}.inp: line 1: *INCLUDE "{11 * "a"}.inp": is more than 10 files deep',
        ),
    ],
)
def test_include_error_has_its_line(tmp_path, included_files, fault):
    """Missing file, circle, or fault inside an included file: the line of the cause."""
    written(tmp_path, included_files)
    with pytest.raises(InputError) as error:
        read(tmp_path, "\n*INCLUDE, INPUT=a.inp\n" + PLAIN)
    (line,) = error.value.faults
    assert fault in line
    assert line.startswith(str(tmp_path))


def test_include_outside_folder_is_refused(tmp_path):
    """A link in the folder that leads outside it."""
    (tmp_path / "secret.inp").write_text(NODES)
    folder = tmp_path / "deck"
    folder.mkdir()
    (folder / "nodes.inp").symlink_to(tmp_path / "secret.inp")
    with pytest.raises(InputError, match="lies outside the folder of the deck"):
        read(folder, "*INCLUDE, INPUT=nodes.inp\n" + ELEMENT + ROOT)


def test_include_size_is_bounded(tmp_path, monkeypatch):
    """Ten files of twenty lines, each including the next twenty times, would give 20¹⁰ lines."""
    monkeypatch.setattr(included, "LARGEST_DECK", 50_000)
    names = [f"{letter}.inp" for letter in "abcdefghij"]
    for name, following in pairwise(names):
        (tmp_path / name).write_text(20 * f"*INCLUDE, INPUT={following}\n")
    (tmp_path / names[-1]).write_text("** nothing\n")
    with pytest.raises(InputError, match=r"together are larger than 0\.05 MB"):
        read(tmp_path, "*INCLUDE, INPUT=a.inp\n" + PLAIN)


def test_part_digest_covers_includes(tmp_path):
    """Caches identify a part by its digest, which must change if an included file changes."""
    deck = tmp_path / "block.inp"
    text, included_files = INCLUDED["included"]
    deck.write_text(text)
    written(tmp_path, included_files)
    assert part_content(deck).split() == PLAIN.encode().split()
    content = part_content(deck)
    written(tmp_path, {"nodes.inp": NODES.replace("2.", "3.")})
    assert part_content(deck) != content
    # Without an *INCLUDE the content is that of the file, byte by byte.
    deck.write_bytes(PLAIN.replace("\n", "\r\n").encode())
    assert part_content(deck) == deck.read_bytes()
