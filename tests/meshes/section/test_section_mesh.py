"""Section meshes of every shape: sound, symmetric, on the true outline, exact integrals."""

from math import cos, pi, sin

import numpy as np
import pytest
from scipy.spatial import cKDTree

from lumped.errors import ComputationError, InputError
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import require_leg, require_section, section_mesh, symmetrised

ELEMENTS_OF_SECTIONS = ["quad4", "quad9", "tri3", "tri6"]
every_element = pytest.mark.parametrize("element", ELEMENTS_OF_SECTIONS)


@every_element
def test_meshes_of_every_section_are_sound(section, element, determinants, facets) -> None:
    mesh, again = (section_mesh(section, 4, element) for _ in range(2))
    _, owners = facets(mesh)
    assert owners.max() == 2
    assert not cKDTree(mesh.nodes).query_pairs(1e-6)
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.nodes)))
    assert np.array_equal(mesh.nodes, again.nodes)
    assert np.array_equal(mesh.cells, again.cells)
    for divisions in (1, 3, 4, 9):
        # Counter-clockwise.
        assert determinants(section_mesh(section, divisions, element)).min() > 0.0


@pytest.mark.parametrize("element", ["quad4", "quad9"])
def test_quadrilaterals_are_symmetric_about_both_axes(section, element) -> None:
    for divisions in (1, 2, 4, 5):
        mesh = section_mesh(section, divisions, element)
        for places in (mesh.nodes, mesh.nodes[mesh.cells].mean(axis=1)):
            for mirror in ((-1.0, 1.0), (1.0, -1.0)):
                distance, _ = cKDTree(places).query(places * mirror)
                assert distance.max() < 1e-16  # rounding of coordinates of 0.1 m


@every_element
def test_integrals_of_straight_sections_are_exact(straight_section, element, integral) -> None:
    section = straight_section
    mesh = section_mesh(section, 4, element)
    found = [
        integral(mesh, lambda x, i=i, power=power: x[..., i] ** power)
        for i, power in ((0, 0), (0, 2), (1, 2))
    ]
    exact = [section.area, section.second_moment_z, section.second_moment_y]
    # 1e-13: straight cells are integrated exactly, some hundred terms of rounding.
    assert found == pytest.approx(exact, rel=1e-13)


def _polygon(radius: float, sides: int) -> float:
    return sides / 2 * radius**2 * sin(2 * pi / sides)


def _parabolas(radius: float, sides: int) -> float:
    """The polygon and a parabola's segment (2/3 chord × sagitta) over each side."""
    chord, sagitta = 2 * radius * sin(pi / sides), radius * (1 - cos(pi / sides))
    return _polygon(radius, sides) + sides * 2 / 3 * chord * sagitta


@pytest.mark.parametrize(("element", "area"), [("quad4", _polygon), ("quad9", _parabolas)])
def test_areas_of_round_sections_are_those_of_chords_or_parabolas(element, area, integral) -> None:
    def found(section, divisions):
        return integral(section_mesh(section, divisions, element), lambda x: x[..., 0] ** 0)

    for divisions in (4, 8, 16):
        # 1e-12: rounding
        circle = found(Circle(0.1), divisions)
        assert circle == pytest.approx(area(0.05, 2 * divisions), rel=1e-12)
    # A quarter of the middle line, 0.094 π/4, takes three elements of 0.1/4, so six at 8 divisions.
    tube = found(Tube(0.1, 0.006), 8)
    assert tube == pytest.approx(area(0.05, 24) - area(0.044, 24), rel=1e-12)


def test_two_divisions_count_elements_along_y_and_z() -> None:
    mesh = section_mesh(Rectangle(0.2, 0.3), (8, 4))
    assert mesh.cells.shape == (32, 9)
    assert len(np.unique(mesh.nodes[:, 0].round(9))) == 17
    assert len(np.unique(mesh.nodes[:, 1].round(9))) == 9


@pytest.mark.parametrize(("divisions", "across"), [(1, 1), (4, 1), (8, 2), (16, 4)])
def test_walls_get_one_element_across_per_four_divisions(divisions, across) -> None:
    mesh = section_mesh(HollowRectangle(0.1, 0.1, 0.005), divisions, "quad4")
    through_the_wall = mesh.nodes[(np.abs(mesh.nodes[:, 1] + 0.05) < 1e-9)]
    in_the_corner = np.sum(through_the_wall[:, 0] < -0.045 + 1e-9)
    assert in_the_corner == across + 1
    # None along it is longer than eight times what it is thick.
    thin = section_mesh(HollowRectangle(0.1, 0.1, 0.001), divisions, "quad4")
    assert np.ptp(thin.nodes[thin.cells], axis=1).max() <= 0.008


def test_doubled_divisions_halve_every_element(section) -> None:
    counts = [len(section_mesh(section, divisions, "quad4").cells) for divisions in (4, 8, 16)]
    assert counts[1:] == [4 * counts[0], 16 * counts[0]]


def test_a_mesh_without_symmetry_is_refused() -> None:
    with pytest.raises(ComputationError, match=r"section: .* not symmetric"):
        symmetrised(np.array([[0.0, 0.0], [1.0, 0.0], [-0.9, 0.0]]), "section")


@pytest.mark.parametrize(
    ("section", "divisions", "reason"),
    [
        (Rectangle(0.1, -0.2), 4, "height = -0.2: must be above 0 m"),
        (HollowRectangle(0.1, 0.2, 0.05), 4, "closes the hollow"),
        (Tube(0.1, 0.05), 4, "closes the bore"),
        (ISection(0.1, 0.2, 0.1, 0.01), 4, "leaves no web"),
        (ISection(0.1, 0.2, 0.01, 0.1), 4, "web = 0.1"),
        (Circle(0.1), 0, "divisions = 0: must be at least 1"),
        (Rectangle(0.1, 0.2), (4, 0), "both must be at least 1"),
        (Circle(0.1), (4, 4), "two numbers suit a solid rectangle alone"),
    ],
)
def test_impossible_sections_are_refused(section, divisions, reason) -> None:
    with pytest.raises(InputError, match=reason):
        require_section(section, divisions)


def test_all_faults_are_named_at_once() -> None:
    with pytest.raises(InputError) as caught:
        require_section(Rectangle(0.0, -1.0), 0)
    assert len(caught.value.faults) == 3


@pytest.mark.parametrize(
    ("length", "reason"),
    [
        *((length, "must be above 0 m") for length in (0.0, float("nan"))),
        (0.19, r"length = 0\.19: shorter .* 0\.2 m"),
    ],
)
def test_impossible_lengths_are_refused(length, reason) -> None:
    with pytest.raises(InputError, match=reason):
        require_leg(Rectangle(0.1, 0.2), length, 4)
    require_leg(Rectangle(0.1, 0.2), 0.2, 4)
