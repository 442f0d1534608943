"""Parts read from CAD files: units, sizes and faces known by hand, and files that are no parts."""

import os
import re

import numpy as np
import pytest
from drawn_parts import written

from lumped.errors import InputError
from meshes.part import volume
from meshes.part.reading.read import read_part
from meshes.part.spread import cell_volumes
from meshes.part.volume import Grading, volume_mesh

pytestmark = pytest.mark.usefixtures("in_this_process")


def test_a_box_is_as_large_as_it_was_drawn(box_step):
    part = read_part(box_step)
    assert part.size == "read in mm: 100 × 20 × 30 mm"
    # Volume and moments of a box: V = abc, I = V(b² + c²)/12.
    assert part.exact.volume == pytest.approx(6e-5, rel=1e-12)
    assert part.exact.centre == pytest.approx([0.05, 0.0, 0.0], abs=1e-15)
    squares = np.square([0.1, 0.02, 0.03])
    inertia = 6e-5 / 12 * (squares.sum() - squares)
    assert np.diag(part.exact.inertia) == pytest.approx(inertia, rel=1e-10)
    assert [face.kind for face in part.faces] == ["plane"] * 6
    assert sum(face.area for face in part.faces) == pytest.approx(2 * (2 + 3 + 0.6) * 1e-3)
    outward = {tuple(face.direction): face.centre for face in part.faces}
    assert outward[1.0, 0.0, 0.0] == pytest.approx([0.1, 0.0, 0.0], abs=1e-12)
    assert outward[0.0, 0.0, -1.0] == pytest.approx([0.05, 0.0, -0.015], abs=1e-12)


def test_a_bore_written_as_splines_is_a_bore(tmp_path):
    def splines(occ):
        bar, bore = occ.addBox(-30, -20, 0, 60, 40, 30), occ.addCylinder(0, 0, -10, 0, 0, 60, 8)
        occ.cut([(3, bar)], [(3, bore)])
        # An affine map turns the kernel's cylinders into splines; this one is the identity.
        occ.affineTransform(occ.getEntities(3), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0])

    path = written(tmp_path / "splines.step", splines)
    assert "B_SPLINE_SURFACE" in path.read_text()
    (bore,) = [face for face in read_part(path).faces if face.radius]
    assert (bore.kind, bore.radius) == ("bore", pytest.approx(8e-3, rel=1e-6))


MILLIMETRE = "SI_UNIT(.MILLI.,.METRE.)"


def in_inches(text: str) -> str:
    """The same numbers declared as inches (ISO 10303-21, conversion based unit)."""
    unit = re.search(rf"#(\d+) = \( LENGTH_UNIT\(\) [^;]*{re.escape(MILLIMETRE)} \);", text)
    inch = (
        f"#{unit[1]} = ( CONVERSION_BASED_UNIT('INCH',#9001) LENGTH_UNIT() NAMED_UNIT(#9002) );\n"
        "#9001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9003);\n"
        "#9002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
        f"#9003 = ( LENGTH_UNIT() NAMED_UNIT(*) {MILLIMETRE} );"
    )
    return text.replace(unit[0], inch)


@pytest.mark.parametrize(
    ("edit", "unit", "length"),
    [
        (in_inches, "inch", 0.254),
        (lambda text: text.replace(MILLIMETRE, "SI_UNIT(.CENTI.,.METRE.)"), "cm", 0.1),
        (lambda text: text.replace(MILLIMETRE, "SI_UNIT($,.METRE.)"), "m", 10.0),
    ],
    ids=["inch", "cm", "m"],
)
def test_the_unit_of_the_file_is_honoured_and_said(tmp_path, edit, unit, length):
    path = written(tmp_path / "bar.step", lambda occ: occ.addBox(0, 0, 0, 10, 2, 3))
    path.write_text(edit(path.read_text()))
    part = read_part(path)
    assert part.unit == unit
    assert part.extent[0] == pytest.approx(length, rel=1e-9)
    assert part.size.startswith(f"read in {unit}: 10")


def refused(path, unit=None) -> str:
    with pytest.raises(InputError) as error:
        read_part(path, unit)
    (line,) = error.value.faults
    assert str(path) in line
    assert "\n" not in line
    return line


def test_a_brep_file_has_no_unit_and_takes_the_one_that_is_said(tmp_path):
    path = written(tmp_path / "bar.brep", lambda occ: occ.addBox(0, 0, 0, 100, 20, 30))
    part = read_part(path, "mm")
    assert part.extent == pytest.approx([0.1, 0.02, 0.03], rel=1e-6)
    assert part.exact.volume == pytest.approx(6e-5, rel=1e-9)
    assert "100 × 20 × 30 m is not the size of a robot's part; is it in mm" in refused(path)
    # The kernel's volume of the box is 40 cm³ then, that of its outline 60 cm³.
    line = refused(turned(path, 2), "mm")
    assert "looks inwards: its edges run as those of its neighbours do" in line


def turned(path, face):
    """The BREP file with one face of its last shell turned inside out."""
    text = path.read_text()
    start = text.rindex("\nSh\n")
    signed = list(re.finditer(r"([+-])\d+ 0 ", text[start:]))[face].start() + start
    other = {"+": "-", "-": "+"}[text[signed]]
    damaged = path.with_name("turned.brep")
    damaged.write_text(text[:signed] + other + text[signed + 1 :])
    return damaged


def test_tetrahedra_fill_what_the_faces_enclose(tmp_path, monkeypatch):
    """A cavity whose one face looks inwards has no neighbour: the kernel counts it as filled."""

    def hollow(occ):
        block, ball = occ.addBox(0, 0, 0, 40, 40, 40), occ.addSphere(20, 20, 20, 10)
        occ.cut([(3, block)], [(3, ball)])

    path = written(tmp_path / "hollow.brep", hollow)
    sound = volume_mesh(read_part(path, "mm"), (), Grading(0.02))
    # 64 cm³ less the ball; facets of 12 sides are within 0.1 % of its volume.
    assert cell_volumes(sound).sum() == pytest.approx(64e-6 - 4e-6 / 3 * np.pi, rel=1e-3)
    part = read_part(turned(path, 0), "mm")
    # No way of meshing mends it; two of them are tried.
    monkeypatch.setattr(volume, "_TRIED", volume._TRIED[:2])
    with pytest.raises(InputError, match=r"enclose 68\.\d+ cm³, tetrahedra .* fill 59\.8"):
        volume_mesh(part, (), Grading(0.02))


def extruded(occ, *outline):
    points = [occ.addPoint(x, y, 0) for x, y in outline]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 0, 10)


def two_solids(occ):
    occ.addBox(0, 0, 0, 10, 10, 10)
    occ.addBox(20, 0, 0, 10, 10, 10)


def box_and_line(occ):
    occ.addBox(0, 0, 0, 10, 10, 10)
    occ.addLine(occ.addPoint(5, 0, 0), occ.addPoint(30, 0, 0))


SHAPES = {
    "two solids": (two_solids, r"2 solids \(1 cm³ at \(0.005, 0.005, 0.005\) m; 1 cm³ at"),
    "sheet": (
        lambda occ: occ.addRectangle(0, 0, 0, 10, 10),
        "1 face, but no solid: sheet bodies, or a shell that is open at the edge",
    ),
    "tiny edge": (
        lambda occ: extruded(occ, (0, 0), (100, 0), (100, 20), (4e-4, 20), (0, 20 - 4e-4)),
        "m long, no mesh can follow it",
    ),
    "bow tie": (
        lambda occ: extruded(occ, (0, 0), (20, 20), (20, 0), (0, 20)),
        "crosses itself|no volume",
    ),
    "box and line": (
        box_and_line,
        r"the point \(0.03, 0, 0\) m lies 0.02 m outside the solid, 1e-07 m is allowed",
    ),
}


@pytest.mark.parametrize(("build", "message"), SHAPES.values(), ids=SHAPES.keys())
def test_a_shape_that_is_no_solid_part(tmp_path, build, message):
    assert re.search(message, refused(written(tmp_path / "shape.step", build)))


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


def _astronomical(point: re.Match) -> str:
    numbers = ",".join(f"{1e12 * float(number):.6E}" for number in point.group(1).split(","))
    return f"CARTESIAN_POINT('',({numbers}))"


def test_a_changed_text_is_not_mended_in_silence_and_its_names_and_comments_say_nothing(
    tmp_path, box_step
):
    """The kernel drops what it does not find, and never returns from what is no number."""
    text, path = box_step.read_text(), tmp_path / "changed.step"
    point = re.search(r"\n#(\d+) = CARTESIAN_POINT\('',\((-?[\d.]+),", text)
    numbers = re.compile(r"CARTESIAN_POINT\('',\((.*?)\)\)", re.DOTALL)
    for changed, message in (
        (text.replace(MILLIMETRE, "SI_UNIT(.PICO.,.METRE.)"), "length, 'pico', is not known here"),
        (numbers.sub(_astronomical, text), "mm is not the size of a robot's part; is its unit ri"),
        (
            text.replace(point.group(), point.group().replace(point.group(2), "NAN")),
            "says NAN where a value must be",
        ),
        (
            text.replace(f"\n#{point.group(1)} =", "\n#99999 ="),
            f"refers to #{point.group(1)}, which it does not hold",
        ),
    ):
        path.write_text(changed)
        assert message in refused(path)
    text = text.replace("CARTESIAN_POINT('',", "CARTESIAN_POINT('#77777 (NAN)',")
    path.write_text(text.replace("HEADER;", "HEADER;\n/* once #77777,\n(NAN) */"))
    assert len(read_part(path).faces) == 6
