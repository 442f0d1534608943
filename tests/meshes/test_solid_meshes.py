"""Extruded hexahedra and tetrahedra: named ends, exact integrals, conforming neighbours."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from lumped.errors import InputError
from lumped.sections import Circle, Rectangle, Section, Tube
from meshes.prism.extrude import extrude, stations
from meshes.prism.hexahedra import hexahedra, slice_count
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh
from meshes.solid_mesh import SolidMesh

LENGTH = 0.3
every_solid = pytest.mark.parametrize("element", ["hex8", "hex27", "tet4", "tet10"])


@cache
def _leg(section: Section, element: str, divisions: int = 1) -> SolidMesh:
    if element.startswith("hex"):
        return hexahedra(section, LENGTH, divisions, element)
    return tetrahedra(section, LENGTH, divisions, 2 if element == "tet10" else 1)


@every_solid
def test_meshes_of_every_leg_are_sound(section, element, determinants, facets) -> None:
    mesh = _leg(section, element)
    sides, owners = facets(mesh)
    assert owners.max() == 2
    free = sides[owners == 1]
    for end, x in ((mesh.root, 0.0), (mesh.tip, LENGTH)):
        assert np.array_equal(end.nodes, np.flatnonzero(mesh.nodes[:, 0] == x))
        assert np.array_equal(mesh.nodes[end.nodes, 1:], end.mesh.nodes)
        assert np.isin(free, end.nodes).all(axis=1).sum() == len(end.mesh.cells)
    assert (mesh.nodes[:, 0].min(), mesh.nodes[:, 0].max(), mesh.length) == (0.0, LENGTH, LENGTH)
    assert not cKDTree(mesh.nodes).query_pairs(1e-6)
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.nodes)))
    # Right-handed.
    assert min(determinants(one).min() for one in (mesh, mesh.root.mesh, mesh.tip.mesh)) > 0.0


@every_solid
def test_integrals_of_straight_legs_are_exact(straight_section, element, integral) -> None:
    section = straight_section
    mesh = _leg(section, element)
    powers = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 2, 0), (0, 0, 2), (0, 1, 1)]
    found = [integral(mesh, lambda x, p=p: np.prod(x ** np.array(p), axis=-1)) for p in powers]
    volume, iy, iz = section.area * LENGTH, section.second_moment_y, section.second_moment_z
    exact = [volume, volume * LENGTH / 2, 0.0, 0.0, iz * LENGTH, iy * LENGTH, 0.0]
    # Rounding of some ten thousand terms of the largest size; first and mixed moments cancel.
    assert found == pytest.approx(exact, rel=1e-11, abs=1e-15)
    for end in (mesh.root, mesh.tip):
        area = integral(end.mesh, lambda x: x[..., 0] ** 0)
        assert area == pytest.approx(section.area, rel=1e-12)  # rounding


@pytest.mark.parametrize(
    ("element", "order"), [("hex8", 2), ("tet4", 2), ("hex27", 4), ("tet10", 4)]
)
def test_volume_of_a_round_leg_converges(element, order, integral) -> None:
    circle = Circle(0.1)
    exact = circle.area * LENGTH
    errors = [
        1 - integral(_leg(circle, element, divisions), lambda x: x[..., 0] ** 0) / exact
        for divisions in (4, 8)
    ]
    # 0.4: coarse arcs have terms of the next order, unstructured sides do not halve exactly.
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


@pytest.mark.parametrize(("flat", "planes"), [("quad4", 4), ("quad9", 7)])
def test_extrusion_numbers_nodes_and_cells_slice_by_slice(flat, planes) -> None:
    section = section_mesh(Rectangle(0.1, 0.2), 2, flat)
    mesh = extrude(section, np.array([0.0, 0.1, 0.15, 0.3]))
    assert mesh.slices == 3
    by_plane = mesh.nodes.reshape(planes, len(section.nodes), 3)
    assert np.all(np.ptp(by_plane[:, :, 0], axis=1) == 0.0)
    assert np.all(np.diff(by_plane[:, 0, 0]) > 0.0)
    assert np.all(by_plane[:, :, 1:] == section.nodes)
    per_slice = mesh.cells.reshape(3, len(section.cells), -1)
    step = len(section.nodes) * (1 if flat == "quad4" else 2)
    assert np.array_equal(per_slice[1] - per_slice[0], np.full_like(per_slice[0], step))


def test_slices_are_even_as_long_as_elements_are_wide_and_no_longer_than_is_accepted() -> None:
    assert stations(0.7, 7) == pytest.approx(np.arange(8) / 10, abs=2e-16)
    assert stations(0.7, 7)[-1] == 0.7
    assert slice_count(Rectangle(0.1, 0.2), 1.0, 4) == 40
    # Fifty times the thickness of 0.1 mm: 5 mm.
    assert slice_count(Tube(0.1, 0.0001), 1.0, 4) == 200


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda: stations(1.0, 0), "slices = 0"),
        (lambda: extrude(section_mesh(Circle(0.1), 4, "tri6"), stations(1.0, 2)), "tri6"),
        (lambda: extrude(section_mesh(Circle(0.1), 4), np.array([0.1, 0.2])), "ascend"),
        (lambda: hexahedra(Circle(0.1), 0.05, 4), "shorter than its circle section"),
        (lambda: tetrahedra(Circle(0.1), 0.05, 4), "shorter than its circle section"),
    ],
)
def test_impossible_requests_are_refused(call, reason) -> None:
    with pytest.raises(InputError, match=reason):
        call()
