"""Section meshes of every shape: sound, symmetric, on the true outline, exact integrals."""

from math import cos, pi, sin

import numpy as np
import pytest
from scipy.spatial import cKDTree

from lumped.errors import ComputationError, InputError
from lumped.sections import Circle, HollowRectangle, Rectangle, Tube
from meshes.quality import quality
from meshes.section.section_mesh import require_leg, require_section, section_mesh, symmetrised


def test_meshes_of_every_section_are_sound(section, integral, facets):
    mesh = section_mesh(section, 4)
    _, owners = facets(mesh)
    assert owners.max() == 2
    assert not cKDTree(mesh.nodes).query_pairs(1e-6)
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.nodes)))
    for divisions in (1, 4, 5):
        mesh = section_mesh(section, divisions)
        found = [
            integral(mesh, lambda x, i=i, power=power: x[..., i] ** power)
            for i, power in ((0, 0), (0, 2), (1, 2))
        ]
        if not isinstance(section, Circle | Tube):
            exact = [section.area, section.second_moment_z, section.second_moment_y]
            # 1e-13: straight cells are integrated exactly, some hundred terms of rounding.
            assert found == pytest.approx(exact, rel=1e-13)
        assert quality(mesh)[0].min() > 0.3
        for places in (mesh.nodes, mesh.nodes[mesh.cells].mean(axis=1)):
            for mirror in ((-1.0, 1.0), (1.0, -1.0)):
                distance, _ = cKDTree(places).query(places * mirror)
                assert distance.max() < 1e-16  # rounding of coordinates of 0.1 m


def _parabolas(radius: float, sides: int) -> float:
    """The polygon and a parabola's segment (2/3 chord × sagitta) over each side."""
    chord, sagitta = 2 * radius * sin(pi / sides), radius * (1 - cos(pi / sides))
    return sides / 2 * radius**2 * sin(2 * pi / sides) + sides * 2 / 3 * chord * sagitta


def test_areas_of_round_sections_are_those_of_parabolas(integral):
    def found(section, divisions):
        return integral(section_mesh(section, divisions), lambda x: x[..., 0] ** 0)

    for divisions in (4, 8, 16):
        # 1e-12: rounding
        circle = found(Circle(0.1), divisions)
        assert circle == pytest.approx(_parabolas(0.05, 2 * divisions), rel=1e-12)
    # A quarter of the middle line, 0.094 π/4, takes three elements of 0.1/4, so six at 8 divisions.
    tube = found(Tube(0.1, 0.006), 8)
    assert tube == pytest.approx(_parabolas(0.05, 24) - _parabolas(0.044, 24), rel=1e-12)


def test_two_divisions_count_elements_along_y_and_z():
    mesh = section_mesh(Rectangle(0.2, 0.3), (8, 4))
    assert mesh.cells.shape == (32, 9)
    assert len(np.unique(mesh.nodes[:, 0].round(9))) == 17
    assert len(np.unique(mesh.nodes[:, 1].round(9))) == 9


def test_walls_get_one_element_across_per_four_divisions_and_doubled_ones_halve_all():
    counts = []
    for divisions, across in ((1, 1), (4, 1), (8, 2), (16, 4)):
        mesh = section_mesh(HollowRectangle(0.1, 0.1, 0.005), divisions)
        through_the_wall = mesh.nodes[(np.abs(mesh.nodes[:, 1] + 0.05) < 1e-9)]
        in_the_corner = np.sum(through_the_wall[:, 0] < -0.045 + 1e-9)
        assert in_the_corner == 2 * across + 1
        counts.append(len(mesh.cells))
        # None along it is longer than eight times what it is thick.
        thin = section_mesh(HollowRectangle(0.1, 0.1, 0.001), divisions)
        assert np.ptp(thin.nodes[thin.cells], axis=1).max() <= 0.008
    assert counts[2:] == [4 * counts[1], 16 * counts[1]]


def test_a_mesh_without_symmetry_is_refused():
    with pytest.raises(ComputationError, match=r"section: .* not symmetric"):
        symmetrised(np.array([[0.0, 0.0], [1.0, 0.0], [-0.9, 0.0]]), "section")


@pytest.mark.parametrize(
    ("section", "divisions", "reason"),
    [
        (Rectangle(0.1, -0.2), 4, "height = -0.2: must be above 0 m"),
        (Circle(0.1), 0, "divisions = 0: must be at least 1"),
        (Rectangle(0.1, 0.2), (4, 0), "both must be at least 1"),
        (Circle(0.1), (4, 4), "two numbers suit a solid rectangle alone"),
    ],
)
def test_impossible_sections_are_refused(section, divisions, reason):
    with pytest.raises(InputError, match=reason):
        require_section(section, divisions)


def test_impossible_lengths_and_all_faults_at_once_are_refused():
    section = Rectangle(0.1, 0.2)
    for length, reason in (
        *((length, "must be above 0 m") for length in (0.0, float("nan"))),
        (0.19, r"length = 0\.19: shorter .* 0\.2 m"),
    ):
        with pytest.raises(InputError, match=reason):
            require_leg(section, length, 4)
    require_leg(section, 0.2, 4)
    with pytest.raises(InputError) as caught:
        require_section(Rectangle(0.0, -1.0), 0)
    assert len(caught.value.faults) == 3
