"""Parts read from CAD files: units, sizes and faces that can be computed by hand."""

import re

import numpy as np
import pytest

from lumped.errors import InputError
from meshes.part.reading.read import read_part

pytestmark = pytest.mark.usefixtures("in_this_process")


def test_a_box_is_as_large_as_it_was_drawn(box_step):
    part = read_part(box_step)
    assert part.size == "read in mm: 100 × 20 × 30 mm"
    # Volume and moments of a box: V = abc, I = V(b² + c²)/12.
    assert part.exact.volume == pytest.approx(6e-5, rel=1e-12)
    assert part.exact.centre == pytest.approx([0.05, 0.0, 0.0], abs=1e-15)
    assert np.diag(part.exact.inertia) == pytest.approx(
        6e-5 / 12 * np.array([0.02**2 + 0.03**2, 0.1**2 + 0.03**2, 0.1**2 + 0.02**2]), rel=1e-10
    )
    assert [face.kind for face in part.faces] == ["plane"] * 6
    assert sum(face.area for face in part.faces) == pytest.approx(2 * (2 + 3 + 0.6) * 1e-3)
    outward = {tuple(face.direction): face.centre for face in part.faces}
    assert outward[1.0, 0.0, 0.0] == pytest.approx([0.1, 0.0, 0.0], abs=1e-12)
    assert outward[0.0, 0.0, -1.0] == pytest.approx([0.05, 0.0, -0.015], abs=1e-12)


def test_a_bore_written_as_splines_is_a_bore(part_file):
    def splines(occ, s):
        bar = occ.addBox(-30 * s, -20 * s, 0.0, 60 * s, 40 * s, 30 * s)
        bore = occ.addCylinder(0.0, 0.0, -10 * s, 0.0, 0.0, 60 * s, 8 * s)
        occ.cut([(3, bar)], [(3, bore)])
        # An affine map turns the kernel's cylinders into splines; this one is the identity.
        occ.affineTransform(occ.getEntities(3), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0])

    path = part_file("splines.step", splines)
    assert "B_SPLINE_SURFACE" in path.read_text()
    (bore,) = [face for face in read_part(path).faces if face.radius]
    assert (bore.kind, bore.radius) == ("bore", pytest.approx(8e-3, rel=1e-6))


def in_inches(text: str) -> str:
    """The same numbers declared as inches (ISO 10303-21, conversion based unit)."""
    unit = re.search(r"#(\d+) = \( LENGTH_UNIT\(\) [^;]*SI_UNIT\(\.MILLI\.,\.METRE\.\) \);", text)
    inch = (
        f"#{unit[1]} = ( CONVERSION_BASED_UNIT('INCH',#9001) LENGTH_UNIT() NAMED_UNIT(#9002) );\n"
        "#9001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9003);\n"
        "#9002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
        "#9003 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );"
    )
    return text.replace(unit[0], inch)


@pytest.mark.parametrize(
    ("edit", "unit", "length"),
    [
        (in_inches, "inch", 2.54),
        (
            lambda text: text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.CENTI.,.METRE.)"),
            "cm",
            1.0,
        ),
        (lambda text: text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"), "m", 10.0),
    ],
    ids=["inch", "cm", "m"],
)
def test_the_unit_of_the_file_is_honoured_and_said(part_file, tmp_path, edit, unit, length):
    path = part_file("bar.step", lambda occ, _: occ.addBox(0, 0, 0, 100, 20, 30))
    if unit == "m":
        path = part_file("short.step", lambda occ, _: occ.addBox(0, 0, 0, 10, 2, 3))
    other = tmp_path / "other.step"
    other.write_text(edit(path.read_text()))
    part = read_part(other)
    assert part.unit == unit
    assert part.extent[0] == pytest.approx(length, rel=1e-9)
    assert part.size.startswith(f"read in {unit}: 10")


def test_a_brep_file_has_no_unit_and_takes_the_one_that_is_said(part_file):
    path = part_file("bar.brep", lambda occ, _: occ.addBox(0, 0, 0, 100, 20, 30))
    part = read_part(path, "mm")
    assert part.extent == pytest.approx([0.1, 0.02, 0.03], rel=1e-6)
    assert part.exact.volume == pytest.approx(6e-5, rel=1e-9)
    with pytest.raises(
        InputError, match=r"100 × 20 × 30 m is not the size of a robot's part; is it in mm"
    ):
        read_part(path)
