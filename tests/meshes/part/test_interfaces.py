"""Interfaces chosen by number, name, cylinder and plane."""

import numpy as np
import pytest
from drawn_parts import meshed

from lumped.errors import InputError
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part

pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.fixture(scope="module")
def lug(lug_step):
    return read_part(lug_step)


def test_a_bore_is_found_by_its_radius_and_its_point_is_half_way_along_its_axis(lug):
    wanted = {
        "A": PartInterface(ByCylinder(0.008)),
        "C": PartInterface(ByCylinder(0.005, axis=(0.0, 0.0, -2.0)), "average"),
    }
    first, second = find_interfaces(lug, wanted)
    assert first.point == pytest.approx([0.02, 0.0, 0.0], abs=1e-9)
    assert second.point == pytest.approx([0.18, 0.0, 0.0], abs=1e-9)
    assert (first.coupling, second.coupling) == ("rigid", "average")
    assert first.because.startswith("rigid by default")
    by_number = {"A": PartInterface(ByFaces(first.faces), "pin")}
    assert find_interfaces(lug, by_number)[0].area == pytest.approx(first.area)


def test_a_plane_is_found_by_its_outward_normal_and_a_point(lug):
    wanted = {"end": PartInterface(ByPlane((1.0, 0.0, 0.0), point=(0.2, 0.01, 0.0)))}
    (end,) = find_interfaces(lug, wanted)
    assert end.area == pytest.approx(0.04 * 0.03, rel=1e-9)
    assert end.point == pytest.approx([0.2, 0.0, 0.0], abs=1e-9)


def fork(occ, s=1.0):
    """A bar 200 × 40 × 30 mm, two bores of radius 6 along z; a slot breaks that at x = 180."""
    bar = occ.addBox(0.0, -20.0 * s, -15.0 * s, 200.0 * s, 40.0 * s, 30.0 * s)
    bores = [
        (3, occ.addCylinder(x * s, 0.0, -30.0 * s, 0.0, 0.0, 60.0 * s, 6.0 * s))
        for x in (100.0, 180.0)
    ]
    slot = occ.addBox(150.0 * s, -40.0 * s, -5.0 * s, 100.0 * s, 80.0 * s, 10.0 * s)
    occ.cut([(3, bar)], [*bores, (3, slot)])


@pytest.mark.parametrize("suffix", ["step", "msh"])
def test_bores_of_one_radius_are_told_apart_by_place_and_a_broken_one_is_one(
    suffix, part_file, tmp_path
):
    if suffix == "msh":
        part = read_part(meshed(tmp_path / "fork.msh", fork, 20.0, 12.0), "mm")
    else:
        part = read_part(part_file("fork.step", fork))
    wanted = {
        name: PartInterface(ByCylinder(0.006, point=(x, 0.0, 0.0)))
        for name, x in (("whole", 0.1), ("broken", 0.18))
    }
    whole, broken = find_interfaces(part, wanted)
    assert (len(whole.faces), len(broken.faces)) == (1, 2)
    for bore, x, height in ((whole, 0.1, 0.03), (broken, 0.18, 0.02)):
        assert bore.point == pytest.approx([x, 0.0, 0.0], abs=1e-8)
        # The facets of a mesh are taken as plane: some twenty sides of a circle, 0.6 %.
        assert bore.area == pytest.approx(2.0 * np.pi * 0.006 * height, rel=1e-2)


FAULTS = {
    "number out of range": (
        ByFaces((99,)),
        None,
        "face 99 does not exist; its faces are numbered 1 to 8",
    ),
    "no number": (ByFaces(()), None, "no face is given"),
    "radius": (ByCylinder(0.009), None, "no cylinder of radius 0.009 m; the nearest is face"),
    "axis": (ByCylinder(0.008, axis=(1.0, 0.0, 0.0)), None, "of this radius, runs along"),
    "axis of length zero": (ByCylinder(0.008, axis=(0.0, 0.0, 0.0)), None, "must not be zero"),
    "not where the joint is": (
        ByCylinder(0.008),
        np.array([0.03, 0.0, 0.0]),
        "its axis passes 10 mm from (0.03, 0, 0); is the part where the joints are?",
    ),
    "no such normal": (ByPlane((1.0, 1.0, 0.0), (0.0, 0.0, 0.0)), None, "no plane face has"),
    "plane off": (ByPlane((1.0, 0.0, 0.0), (0.19, 0.0, 0.0)), None, "10 mm off"),
    "plane without a point": (ByPlane((1.0, 0.0, 0.0)), None, "a plane needs point"),
    "no name": (ByName("bore"), None, "the file names none"),
}


@pytest.mark.parametrize(("selection", "place", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_a_wrong_choice_says_what_was_nearest(lug, selection, place, message):
    points = {} if place is None else {"A": place}
    with pytest.raises(InputError) as error:
        find_interfaces(lug, {"A": PartInterface(selection)}, points)
    (line,) = error.value.faults
    assert message in line
    assert "lug.step: interface A: " in line


def test_faces_are_taken_once(lug):
    bore = PartInterface(ByCylinder(0.008))
    with pytest.raises(InputError, match="interfaces A and C both take face"):
        find_interfaces(lug, {"A": bore, "C": bore})
    top = PartInterface(ByPlane((0.0, 0.0, 1.0), (0.0, 0.0, 0.015)))
    with pytest.raises(InputError, match="A and C share the edge between their faces"):
        find_interfaces(lug, {"A": bore, "C": top})
    with pytest.raises(InputError, match="suits a bore alone"):
        find_interfaces(lug, {"A": PartInterface(ByPlane((1.0, 0, 0), (0.2, 0, 0)), "pin")})
    with pytest.raises(InputError, match="no interface is given"):
        find_interfaces(lug, {})
