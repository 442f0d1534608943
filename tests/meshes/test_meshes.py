"""Elements, and meshes of sections and legs: shape functions, quality, outlines and integrals."""

import itertools
from math import cos, nan, pi, sin, sqrt

import numpy as np
import pytest
from scipy.spatial import cKDTree
from vtkmodules.vtkCommonCore import reference, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

from lumped.errors import ComputationError, InputError
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.elements import ELEMENTS
from meshes.prism import extrude, hexahedra, stations, tetrahedra
from meshes.quality import check, quality
from meshes.section.section_mesh import (
    SectionMesh,
    require_leg,
    require_section,
    section_mesh,
    symmetrised,
)
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import VolumeMesh

by_name = pytest.mark.parametrize("kind", ELEMENTS.values(), ids=ELEMENTS.keys())


def _exponents(kind) -> np.ndarray:
    powers = list(itertools.product(range(kind.order + 1), repeat=kind.dimension))
    if kind.name.startswith("t"):
        powers = [p for p in powers if sum(p) <= kind.order]
    elif len(powers) > kind.node_count:
        # Serendipity elements: at most one factor is squared (Arnold and Awanou, Found. Comput.
        # Math. 11).
        powers = [p for p in powers if p.count(2) <= 1]
    return np.array(powers)


def _points(kind) -> np.ndarray:
    """Return random points inside the unit simplex, hence inside every reference element."""
    inside = np.random.default_rng(1).dirichlet(np.ones(kind.dimension + 1), size=7)
    return inside[:, :-1].T


@by_name
def test_shape_functions_are_nodal_polynomials(kind):
    """Reference: monomials through the nodes by a Vandermonde matrix, and central differences."""
    # Independent of scikit-fem: monomials and a Vandermonde matrix.
    powers = _exponents(kind)
    vandermonde = np.prod(kind.nodes[:, None, :] ** powers[None], axis=2)
    positions, d = _points(kind), kind.dimension
    monomials = np.prod(positions.T[:, None, :] ** powers[None], axis=2)
    corners = kind.nodes[list(kind.corner_nodes)]
    assert np.all((corners == 0.0) | (corners == 1.0))
    # Rounding error of up to 27 terms of order one: below 1e-13.
    expected = np.linalg.solve(vandermonde.T, monomials.T)
    assert values(kind.name, positions) == pytest.approx(expected, abs=1e-13)
    for i, step in enumerate(1e-5 * np.eye(d)[:, :, None]):
        forward, backward = (values(kind.name, positions + sign * step) for sign in (1.0, -1.0))
        slope = (forward - backward) / 2e-5
        # Central differences of these polynomials are exact but for terms of order step².
        assert gradients(kind.name, positions)[:, i] == pytest.approx(slope, abs=1e-8)
    points, weights = quadrature(kind.name, 4)
    # ∫ξ⁴ over the unit simplex of dimension d: 4! / (4 + d)!; over the unit cube: 1/5.
    exact = {2: 24 / 720, 3: 24 / 5040}[d] if kind.name.startswith("t") else 1 / 5
    assert points[0] ** 4 @ weights == pytest.approx(exact, rel=1e-12)


@by_name
def test_curved_mapping_equals_vtk(kind):
    """Elements with displaced nodes map points as VTK's elements do."""
    # VTK interpolates an element with scattered nodes: a wrong entry in the permutation of nodes
    # would move the mapped points by the scatter.
    nodes = np.random.default_rng(2).uniform(-0.1, 0.1, size=(kind.node_count, 3))
    nodes[:, : kind.dimension] += kind.nodes
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    points.SetDataTypeToDouble()
    for node in nodes:
        points.InsertNextPoint(node)
    grid.SetPoints(points)
    grid.InsertNextCell(kind.vtk_type, kind.node_count, kind.vtk_order)
    positions, by_vtk = _points(kind), [0.0, 0.0, 0.0]
    mapped = values(kind.name, positions).T @ nodes
    for point, expected in zip(positions.T, mapped, strict=True):
        inside, weights = [*point, 0.0][:3], [0.0] * kind.node_count
        grid.GetCell(0).EvaluateLocation(reference(0), inside, by_vtk, weights)
        assert by_vtk == pytest.approx(expected, abs=1e-12)


def single(element, nodes):
    kind = SectionMesh if nodes.shape[1] == 2 else VolumeMesh
    return kind(nodes, np.arange(len(nodes))[None], element)


def measures(element, nodes):
    return tuple(float(measure[0]) for measure in quality(single(element, nodes)))


SQUARES_AND_CUBES = ("quad4", "quad9", "hex8", "hex27")
# Rows are the images of the unit vectors of the reference element.
SHEARED = np.array([[1.0, 0.0, 0.0], [0.5, sqrt(3) / 2, 0.0], [0.0, 0.0, 1.0]])
REGULAR = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]])


@pytest.mark.parametrize(
    ("elements", "sides", "expected"),
    [
        (SQUARES_AND_CUBES, np.eye(3), (1.0, 1.0)),
        # Sheared by 30°: the quality is the sine of the remaining angle of 60°.
        (SQUARES_AND_CUBES, SHEARED, (sin(pi / 3), None)),
        # The aspect ratio is the longest side over the shortest.
        (("quad9", "hex8"), np.diag([1.0, 5.0, 1.0]), (1.0, 5.0)),
        (("tri3", "tri6"), SHEARED, (1.0, 1.0)),
        (("tet4", "tet10"), REGULAR, (1.0, 1.0)),
        # Right-angled corner with unit sides; the largest product of sides at a corner is 1·√2 for
        # the triangle and 1·√2·√2 for the tetrahedron.
        (("tri3",), np.eye(3), (2 / sqrt(3) / sqrt(2), sqrt(2))),
        (("tet4",), np.eye(3), (sqrt(2) / 2, sqrt(2))),
    ],
)
def test_element_quality_is_exact(elements, sides, expected):
    """Scaled Jacobian and aspect ratio of squares, cubes and sheared ones: sin 60° for 60°."""
    for element in elements:
        nodes = ELEMENTS[element].nodes
        d = nodes.shape[1]
        jacobian, aspect = measures(element, nodes @ sides[:d, :d])
        assert jacobian == pytest.approx(expected[0])
        assert expected[1] is None or aspect == pytest.approx(expected[1])


def test_bad_elements_are_refused():
    """Inverted elements of each type, and one 101 times as long as wide."""
    for element, kind in ELEMENTS.items():
        mirrored = kind.nodes * np.where(np.arange(kind.dimension) == 0, -1.0, 1.0)
        assert measures(element, mirrored)[0] < 0.0
        with pytest.raises(ComputationError, match=r"leg 1: .* inverted"):
            check(single(element, mirrored), "leg 1")
    # x(ξ) = 4 m ξ (1 − ξ) + ξ (2ξ − 1) has slope 4m − 1 at ξ = 0: negative below m = 1/4.
    nodes = ELEMENTS["quad9"].nodes.copy()
    nodes[nodes[:, 0] == 0.5, 0] = 0.24
    assert measures("quad9", nodes)[0] < 0.0
    slender = ELEMENTS["hex8"].nodes * np.array([101.0, 1.0, 1.0])
    with pytest.raises(ComputationError, match=r"101 times as long as wide.*more slices"):
        check(single("hex8", slender), "leg 2")


BOX, LENGTH = Rectangle(0.16, 0.26), 0.3
SECTIONS = [
    BOX,
    HollowRectangle(0.10, 0.16, 0.02),
    Circle(0.10),
    Tube(0.10, 0.02),
    ISection(0.10, 0.16, 0.03, 0.02),
]
by_shape = pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)


def moments(mesh, powers):
    """Return ∫ Π x_i^p_i over a mesh of right-handed elements, one value for each row of powers."""
    points, weights = quadrature(mesh.element, 6)
    corners = mesh.nodes[mesh.cells]
    slopes = gradients(mesh.element, points)
    determinant = np.linalg.det(np.einsum("mki,kjq->mqij", corners, slopes))
    assert determinant.min() > 0.0
    positions = np.einsum("mki,kq->mqi", corners, values(mesh.element, points))
    return [float((determinant * (positions**p).prod(axis=-1) @ weights).sum()) for p in powers]


def free_sides(mesh):
    """Return the sides that belong to a single element, by their sorted nodes; check the mesh.

    No side may belong to more than two elements, and no two nodes may coincide. The sides of the
    reference element are found from the planes that bound it.
    """
    nodes = ELEMENTS[mesh.element].nodes
    sides = [nodes[:, i] == 0.0 for i in range(nodes.shape[1])]
    is_simplex = (nodes.sum(axis=1) <= 1.0).all()
    sides += [nodes.sum(axis=1) == 1.0] if is_simplex else [side == 1.0 for side in nodes.T]
    every = np.vstack([np.sort(mesh.cells[:, side], axis=1) for side in sides])
    distinct, owners = np.unique(every, axis=0, return_counts=True)
    assert owners.max() == 2
    assert not cKDTree(mesh.nodes).query_pairs(1e-6)
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.nodes)))
    return distinct[owners == 1]


@by_shape
def test_section_meshes_are_valid(section):
    """Area, second moments, quality and mirror symmetry for 1, 4 and 5 divisions."""
    for divisions in (1, 4, 5):
        mesh = section_mesh(section, divisions)
        free_sides(mesh)
        integrals = moments(mesh, [(0, 0), (2, 0), (0, 2)])
        if not isinstance(section, Circle | Tube):
            exact = [section.area, section.second_moment_z, section.second_moment_y]
            # Straight elements are integrated exactly: rounding errors of some hundred terms.
            assert integrals == pytest.approx(exact, rel=1e-13)
        assert quality(mesh)[0].min() > 0.3
        for points in (mesh.nodes, mesh.nodes[mesh.cells].mean(axis=1)):
            for mirror in ((-1.0, 1.0), (1.0, -1.0)):
                distance, _ = cKDTree(points).query(points * mirror)
                # Symmetric up to the rounding of coordinates of 0.1 m.
                assert distance.max() < 1e-16


def extruded(section, length, divisions):
    """Return a hexahedral leg mesh with slices as long as the smaller side, or a quarter of it."""
    slices = np.ceil(4.0 * length / min(section.extent))
    return hexahedra(section, length, divisions, int(divisions * slices))


@pytest.mark.parametrize(
    ("section", "family"),
    [*((section, extruded) for section in SECTIONS), (BOX, tetrahedra)],
    ids=lambda value: getattr(value, "shape", None),
)
def test_leg_meshes_have_moments_of_leg(section, family):
    """Volume, first and second moments, and nodes on both ends, for each section."""
    mesh = family(section, LENGTH, 1)
    free = free_sides(mesh)
    # Rounding errors of some ten thousand terms; a circle of four parabolas errs by up to 5 %.
    rel = 5e-2 if isinstance(section, Circle | Tube) else 1e-11
    for end, x in ((mesh.root, 0.0), (mesh.tip, LENGTH)):
        assert np.array_equal(end.nodes, np.flatnonzero(mesh.nodes[:, 0] == x))
        assert np.array_equal(mesh.nodes[end.nodes, 1:], end.mesh.nodes)
        assert np.isin(free, end.nodes).all(axis=1).sum() == len(end.mesh.cells)
        assert moments(end.mesh, [(0, 0)]) == pytest.approx([section.area], rel=rel)
    assert (mesh.nodes[:, 0].min(), mesh.nodes[:, 0].max(), mesh.length) == (0.0, LENGTH, LENGTH)
    # Limits that the manual of Verdict calls acceptable.
    assert quality(mesh)[0].min() > (0.3 if family is extruded else 0.2)
    powers = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 2, 0), (0, 0, 2), (0, 1, 1)]
    volume, iy, iz = section.area * LENGTH, section.second_moment_y, section.second_moment_z
    exact = [volume, volume * LENGTH / 2, 0.0, 0.0, iz * LENGTH, iy * LENGTH, 0.0]
    assert moments(mesh, powers) == pytest.approx(exact, rel=rel, abs=1e-15)


def _parabolas(radius: float, sides: int) -> float:
    """Return the area of a polygon with a parabolic segment (2/3 chord × sagitta) on each side."""
    chord, sagitta = 2 * radius * sin(pi / sides), radius * (1 - cos(pi / sides))
    return sides / 2 * radius**2 * sin(2 * pi / sides) + sides * 2 / 3 * chord * sagitta


def test_parabolic_sides_give_circle_area():
    """The area of quadratic elements is that of the parabolas through their boundary nodes."""
    for divisions in (4, 16):
        # Equal up to rounding errors.
        circle = moments(section_mesh(Circle(0.1), divisions), [(0, 0)])
        assert circle == pytest.approx([_parabolas(0.05, 2 * divisions)], rel=1e-12)
    # A quarter of the middle line, 0.094 π/4 m, has three elements of 0.1/4 m at 4 divisions, hence
    # six at 8 divisions.
    tube = moments(section_mesh(Tube(0.1, 0.006), 8), [(0, 0)])
    assert tube == pytest.approx([_parabolas(0.05, 24) - _parabolas(0.044, 24)], rel=1e-12)


def test_wall_has_one_element_per_4_divisions():
    """At least one across the wall; along it, thin walls have cells of limited length."""
    counts = []
    for divisions, across in ((1, 1), (4, 1), (8, 2), (16, 4)):
        mesh = section_mesh(HollowRectangle(0.1, 0.1, 0.005), divisions)
        through_the_wall = mesh.nodes[(np.abs(mesh.nodes[:, 1] + 0.05) < 1e-9)]
        in_the_corner = np.sum(through_the_wall[:, 0] < -0.045 + 1e-9)
        assert in_the_corner == 2 * across + 1
        counts.append(len(mesh.cells))
        # No element is longer than eight times the thickness of the wall.
        thin = section_mesh(HollowRectangle(0.1, 0.1, 0.001), divisions)
        assert np.ptp(thin.nodes[thin.cells], axis=1).max() <= 0.008
    assert counts[2:] == [4 * counts[1], 16 * counts[1]]


def test_extrusion_is_numbered_slice_by_slice():
    """Nodes of a slice, and cells of a slice, differ from the next by a constant step."""
    # Two numbers of divisions are the numbers of elements along y and along z.
    section = section_mesh(Rectangle(0.1, 0.2), (4, 2))
    assert [len(np.unique(along.round(9))) for along in section.nodes.T] == [9, 5]
    mesh = extrude(section, np.array([0.0, 0.1, 0.15, 0.3]))
    assert mesh.slices == 3
    by_plane = mesh.nodes.reshape(7, len(section.nodes), 3)
    assert np.all(np.ptp(by_plane[:, :, 0], axis=1) == 0.0)
    assert np.all(np.diff(by_plane[:, 0, 0]) > 0.0)
    assert np.all(by_plane[:, :, 1:] == section.nodes)
    per_slice = mesh.cells.reshape(3, len(section.cells), -1)
    step = 2 * len(section.nodes)
    assert np.array_equal(per_slice[1] - per_slice[0], np.full_like(per_slice[0], step))
    assert stations(0.7, 7) == pytest.approx(np.arange(8) / 10, abs=2e-16)
    assert stations(0.7, 7)[-1] == 0.7


@pytest.mark.parametrize(
    ("request_one", "reason"),
    [
        (lambda: require_section(Rectangle(0.1, -0.2), 4), "height = -0.2: must be above 0 m"),
        (lambda: require_section(Circle(0.1), 0), "divisions = 0: must be at least 1"),
        (lambda: require_section(Rectangle(0.1, 0.2), (4, 0)), "both must be at least 1"),
        (
            lambda: require_section(Circle(0.1), (4, 4)),
            "two numbers are allowed only for a solid rectangle",
        ),
        (lambda: require_leg(BOX, 0.0, 4), "must be above 0 m"),
        (lambda: require_leg(BOX, nan, 4), "must be above 0 m"),
        (lambda: require_leg(BOX, 0.25, 4), r"length = 0\.25: shorter .* 0\.26 m"),
        (lambda: extruded(BOX, 0.2, 4), "shorter than its rectangle section"),
        (lambda: tetrahedra(BOX, 0.2, 4), "shorter than its rectangle section"),
        (lambda: tetrahedra(Circle(0.1), 0.2, 4), "only solid rectangles"),
        (lambda: stations(1.0, 0), "slices = 0"),
    ],
)
def test_impossible_leg_mesh_is_refused(request_one, reason):
    """Negative sizes and too many divisions, slices or unknowns, each with its reason."""
    with pytest.raises(InputError, match=reason):
        request_one()


def test_all_faults_of_section_are_listed():
    """Sides of 0 and −1 m with 0 divisions: three faults.

    Sections without symmetry have no mesh.
    """
    require_leg(BOX, 0.26, 4)
    with pytest.raises(InputError) as caught:
        require_section(Rectangle(0.0, -1.0), 0)
    assert len(caught.value.faults) == 3
    with pytest.raises(ComputationError, match=r"section: .* not symmetric"):
        symmetrised(np.array([[0.0, 0.0], [1.0, 0.0], [-0.9, 0.0]]), "section")
