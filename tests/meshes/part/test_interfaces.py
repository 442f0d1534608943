"""Interfaces chosen by number, name, cylinder and plane."""

import numpy as np
import pytest
from drawn_parts import meshed, read_here, written

from lumped.errors import InputError
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces


@pytest.fixture(scope="module")
def lug(tmp_path_factory):
    """A bar 200 × 40 × 30 mm with bores of radius 8 and 5 along z at x = 20 and 180."""

    def draw(occ):
        bar = occ.addBox(0, -20, -15, 200, 40, 30)
        bores = [(3, occ.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((20, 8), (180, 5))]
        occ.cut([(3, bar)], bores)

    return read_here(written(tmp_path_factory.mktemp("parts") / "lug.step", draw))


def test_a_bore_is_found_by_its_radius_and_a_plane_by_its_outward_normal_and_a_point(lug):
    wanted = {
        "A": PartInterface(ByCylinder(0.008)),
        "C": PartInterface(ByCylinder(0.005, axis=(0.0, 0.0, -2.0)), "average"),
        "end": PartInterface(ByPlane((1.0, 0.0, 0.0), point=(0.2, 0.01, 0.0))),
    }
    first, second, end = find_interfaces(lug, wanted)
    # Half way along its axis, or in the middle.
    for found, x in ((first, 0.02), (second, 0.18), (end, 0.2)):
        assert found.point == pytest.approx([x, 0.0, 0.0], abs=1e-9)
    assert (first.coupling, second.coupling) == ("rigid", "average")
    assert first.because.startswith("rigid by default")
    assert end.area == pytest.approx(0.04 * 0.03, rel=1e-9)
    by_number = {"A": PartInterface(ByFaces(first.faces), "pin")}
    assert find_interfaces(lug, by_number)[0].area == pytest.approx(first.area)


def fork(occ):
    """A bar 200 × 40 × 30 mm, two bores of radius 6 along z; a slot breaks that at x = 180."""
    bar, slot = occ.addBox(0, -20, -15, 200, 40, 30), occ.addBox(150, -40, -5, 100, 80, 10)
    bores = [occ.addCylinder(x, 0, -30, 0, 0, 60, 6) for x in (100, 180)]
    occ.cut([(3, bar)], [(3, one) for one in (*bores, slot)])


@pytest.mark.parametrize("suffix", ["step", "msh"])
def test_bores_of_one_radius_are_told_apart_by_place_and_a_broken_one_is_one(suffix, tmp_path):
    path = tmp_path / f"fork.{suffix}"
    file = meshed(path, fork, 20.0, 12.0) if suffix == "msh" else written(path, fork)
    wanted = {
        name: PartInterface(ByCylinder(0.006, point=(x, 0.0, 0.0)))
        for name, x in (("whole", 0.1), ("broken", 0.18))
    }
    whole, broken = find_interfaces(read_here(file, "mm"), wanted)
    assert (len(whole.faces), len(broken.faces)) == (1, 2)
    for bore, x, height in ((whole, 0.1, 0.03), (broken, 0.18, 0.02)):
        assert bore.point == pytest.approx([x, 0.0, 0.0], abs=1e-8)
        # The facets of a mesh are taken as plane: some twenty sides of a circle, 0.6 %.
        assert bore.area == pytest.approx(2.0 * np.pi * 0.006 * height, rel=1e-2)


END, BORE = ByPlane((1.0, 0.0, 0.0), (0.2, 0.0, 0.0)), ByCylinder(0.008)


@pytest.mark.parametrize(
    ("selection", "message"),
    [
        (ByFaces((99,)), "face 99 does not exist; its faces are numbered 1 to 8"),
        (ByFaces(()), "no face is given"),
        (ByCylinder(0.009), "no cylinder of radius 0.009 m; the nearest is face"),
        (ByCylinder(0.008, axis=(1.0, 0.0, 0.0)), "of this radius, runs along"),
        (ByCylinder(0.008, axis=(0.0, 0.0, 0.0)), "must not be zero"),
        (BORE, "its axis passes 10 mm from (0.03, 0, 0); is the part where the joints are?"),
        (ByPlane((1.0, 1.0, 0.0), (0.0, 0.0, 0.0)), "no plane face has"),
        (ByPlane((1.0, 0.0, 0.0), (0.19, 0.0, 0.0)), "10 mm off"),
        (ByPlane((1.0, 0.0, 0.0)), "a plane needs point"),
        (ByName("bore"), "the file names none"),
    ],
)
def test_a_wrong_choice_says_what_was_nearest(lug, selection, message):
    points = {"A": np.array([0.03, 0.0, 0.0])} if selection is BORE else {}
    with pytest.raises(InputError) as error:
        find_interfaces(lug, {"A": PartInterface(selection)}, points)
    (line,) = error.value.faults
    assert message in line
    assert "lug.step: interface A: " in line


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"A": (BORE, None), "C": (BORE, None)}, "interfaces A and C both take face"),
        (
            {"A": (BORE, None), "C": (ByPlane((0.0, 0.0, 1.0), (0.0, 0.0, 0.015)), None)},
            "A and C share the edge between their faces",
        ),
        ({"A": (END, "pin")}, "suits a bore alone"),
        ({}, "no interface is given"),
    ],
)
def test_faces_are_taken_once_and_by_what_suits_them(lug, wanted, message):
    with pytest.raises(InputError, match=message):
        find_interfaces(lug, {name: PartInterface(*one) for name, one in wanted.items()})
