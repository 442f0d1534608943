"""Files that are no parts: each gives one clear line that says what and where."""

import os
import re

import numpy as np
import pytest

from lumped.errors import InputError
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes
from meshes.part.volume import Grading, volume_mesh

pytestmark = pytest.mark.usefixtures("in_this_process")


def two_solids(occ, s):
    occ.addBox(0, 0, 0, 10 * s, 10 * s, 10 * s)
    occ.addBox(20 * s, 0, 0, 10 * s, 10 * s, 10 * s)


def sheet(occ, s):
    occ.addRectangle(0, 0, 0, 10 * s, 10 * s)


def extruded(occ, s, outline):
    points = [occ.addPoint(x * s, y * s, 0) for x, y in outline]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 0, 10 * s)


def tiny_edge(occ, s):
    extruded(occ, s, [(0, 0), (100, 0), (100, 20), (4e-4, 20), (0, 20 - 4e-4)])


def bow_tie(occ, s):
    extruded(occ, s, [(0, 0), (20, 20), (20, 0), (0, 20)])


def box_and_line(occ, s):
    occ.addBox(0, 0, 0, 10 * s, 10 * s, 10 * s)
    occ.addLine(occ.addPoint(5 * s, 0, 0), occ.addPoint(30 * s, 0, 0))


SHAPES = {
    "two solids": (two_solids, "2 solids (1 cm³ at (0.005, 0.005, 0.005) m; 1 cm³ at"),
    "sheet": (sheet, "1 face, but no solid: sheet bodies, or a shell that is open at the edge"),
    "tiny edge": (tiny_edge, "m long, no mesh can follow it"),
    "box and line": (
        box_and_line,
        "the point (0.03, 0, 0) m lies 0.02 m outside the solid, 1e-07 m is allowed",
    ),
}


def refused(path, unit=None) -> str:
    with pytest.raises(InputError) as error:
        read_part(path, unit)
    (line,) = error.value.faults
    assert str(path) in line
    assert "\n" not in line
    return line


@pytest.mark.parametrize(("build", "message"), SHAPES.values(), ids=SHAPES.keys())
def test_a_shape_that_is_no_solid_part(part_file, build, message):
    assert message in refused(part_file(f"{build.__name__}.step", build))


def block(occ, s):
    occ.addBox(0.0, 0.0, 0.0, 100.0 * s, 20.0 * s, 30.0 * s)


def turned(path, face):
    """The BREP file with one face of its last shell turned inside out."""
    text = path.read_text()
    start = text.rindex("\nSh\n")
    signed = list(re.finditer(r"([+-])\d+ 0 ", text[start:]))[face].start() + start
    other = {"+": "-", "-": "+"}[text[signed]]
    damaged = path.with_name("turned.brep")
    damaged.write_text(text[:signed] + other + text[signed + 1 :])
    return damaged


def test_a_face_that_looks_inwards(part_file):
    """The kernel's volume of the box is 40 cm³ then, that of its outline 60 cm³."""
    line = refused(turned(part_file("block.brep", block, 1e-3), 2), "m")
    assert "looks inwards: its edges run as those of its neighbours do" in line


def hollow(occ, s):
    block = occ.addBox(0, 0, 0, 40 * s, 40 * s, 40 * s)
    occ.cut([(3, block)], [(3, occ.addSphere(20 * s, 20 * s, 20 * s, 10 * s))])


def test_tetrahedra_fill_what_the_faces_enclose(part_file):
    """A cavity whose one face looks inwards has no neighbour: the kernel counts it as filled."""
    path = part_file("hollow.brep", hollow, 1e-3)
    sound = volume_mesh(read_part(path), (), Grading(0.02))
    # 64 cm³ less the ball; facets of 12 sides are within 0.1 % of its volume.
    assert cell_volumes(sound).sum() == pytest.approx(64e-6 - 4e-6 / 3 * np.pi, rel=1e-3)
    part = read_part(turned(path, 0))
    with pytest.raises(InputError, match=r"enclose 68\.\d+ cm³, tetrahedra .* fill 59\.8"):
        volume_mesh(part, (), Grading(0.02))


def test_a_surface_that_crosses_itself(part_file):
    line = refused(part_file("bow_tie.step", bow_tie))
    assert "crosses itself" in line or "no volume" in line


TEXTS = [
    (None, ".step", "no such file"),
    (b"", ".step", "is empty"),
    (b"solid cube\n", ".step", "is not a STEP file; it must begin with ISO-10303-21"),
    (b"ISO-10303-21;\nHEADER;\n", ".step", "the STEP file is cut off"),
    (b"ISO-10303-21;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", ".step", "no unit of length"),
    (b"hello", ".brep", "is not a BREP file"),
    (b"hello", ".msh", "cannot be read as a mesh"),
    (b"hello", ".stl", "not a part; must be one of .step"),
]


def test_files_that_are_no_parts_and_units_that_contradict_them(tmp_path, box_step):
    for number, (content, suffix, message) in enumerate(TEXTS):
        path = tmp_path / f"part{number}{suffix}"
        if content is not None:
            path.write_bytes(content)
        assert message in refused(path)
    folder = tmp_path / "part.step"
    folder.mkdir()
    assert "is a folder" in refused(folder)
    assert "is in mm, and unit = 'inch' contradicts it" in refused(box_step, "inch")
    large = tmp_path / "large.step"
    large.touch()
    os.truncate(large, 500_000_001)
    assert "is larger than 500 MB" in refused(large)
    path = tmp_path / "feet.step"
    text = box_step.read_text().replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.PICO.,.METRE.)")
    path.write_text(text)
    assert "its unit of length, 'pico', is not known here" in refused(path)
    points = re.compile(r"CARTESIAN_POINT\('',\((.*?)\)\)", re.DOTALL)
    path.write_text(points.sub(_astronomical, box_step.read_text()))
    assert "mm is not the size of a robot's part; is its unit right?" in refused(path)


def _astronomical(point: re.Match) -> str:
    numbers = ",".join(f"{1e12 * float(number):.6E}" for number in point.group(1).split(","))
    return f"CARTESIAN_POINT('',({numbers}))"


def test_a_damaged_file_is_not_mended_in_silence(tmp_path, box_step):
    """The kernel drops what it does not find, and never returns from what is no number."""
    text = box_step.read_text()
    path = tmp_path / "damaged.step"
    point = re.search(r"\n#(\d+) = CARTESIAN_POINT\('',\((-?[\d.]+),", text)
    path.write_text(text.replace(point.group(), point.group().replace(point.group(2), "NAN")))
    assert "says NAN where a value must be" in refused(path)
    path.write_text(text.replace(f"\n#{point.group(1)} =", "\n#99999 ="))
    assert f"refers to #{point.group(1)}, which it does not hold" in refused(path)


def test_names_and_comments_say_nothing_of_the_part(tmp_path, box_step):
    path = tmp_path / "commented.step"
    text = box_step.read_text().replace("CARTESIAN_POINT('',", "CARTESIAN_POINT('#77777 (NAN)',")
    path.write_text(text.replace("HEADER;", "HEADER;\n/* once #77777,\n(NAN) */"))
    assert len(read_part(path).faces) == 6
