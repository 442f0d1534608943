"""Element kinds against polynomials fitted to their nodes, VTK's elements, known measures."""

import itertools
from math import pi, sin, sqrt

import numpy as np
import pytest
from vtkmodules.vtkCommonCore import reference, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

from lumped.errors import ComputationError
from meshes.elements import ELEMENTS
from meshes.quality import check, quality
from meshes.section.section_mesh import SectionMesh
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import VolumeMesh

by_name = pytest.mark.parametrize("kind", ELEMENTS.values(), ids=ELEMENTS.keys())


def _exponents(kind) -> np.ndarray:
    powers = list(itertools.product(range(kind.order + 1), repeat=kind.dimension))
    if kind.name.startswith("t"):
        powers = [p for p in powers if sum(p) <= kind.order]
    elif len(powers) > kind.node_count:
        # Serendipity: at most one factor is squared (Arnold and Awanou, Found. Comput. Math. 11).
        powers = [p for p in powers if p.count(2) <= 1]
    return np.array(powers)


def _points(kind) -> np.ndarray:
    """Points inside the unit simplex, hence inside every reference cell."""
    inside = np.random.default_rng(1).dirichlet(np.ones(kind.dimension + 1), size=7)
    return inside[:, :-1].T


@by_name
def test_shape_functions_are_the_polynomials_that_are_one_at_their_node(kind):
    # Independent formulation: monomials and a Vandermonde matrix instead of scikit-fem.
    powers = _exponents(kind)
    vandermonde = np.prod(kind.nodes[:, None, :] ** powers[None], axis=2)
    at, d = _points(kind), kind.dimension
    monomials = np.prod(at.T[:, None, :] ** powers[None], axis=2)
    corners = kind.nodes[list(kind.corner_nodes)]
    assert np.all((corners == 0.0) | (corners == 1.0))
    # 1e-13: 27 terms of order one, rounding only.
    expected = np.linalg.solve(vandermonde.T, monomials.T)
    assert values(kind.name, at) == pytest.approx(expected, abs=1e-13)
    for i, step in enumerate(1e-5 * np.eye(d)[:, :, None]):
        slope = (values(kind.name, at + step) - values(kind.name, at - step)) / 2e-5
        # Central differences are exact for these polynomials but for order step² in cross terms.
        assert gradients(kind.name, at)[:, i] == pytest.approx(slope, abs=1e-8)
    points, weights = quadrature(kind.name, 4)
    # ∫ξ⁴ over the unit simplex of dimension d: 4! / (4 + d)!; over the unit cube: 1/5.
    exact = {2: 24 / 720, 3: 24 / 5040}[d] if kind.name.startswith("t") else 1 / 5
    assert points[0] ** 4 @ weights == pytest.approx(exact, rel=1e-12)


@by_name
def test_vtk_maps_a_curved_element_as_we_do(kind):
    # VTK's own interpolation of an element with scattered nodes: any wrong place in the
    # permutation would move the mapped points by the scatter.
    places = np.random.default_rng(2).uniform(-0.1, 0.1, size=(kind.node_count, 3))
    places[:, : kind.dimension] += kind.nodes
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    points.SetDataTypeToDouble()
    for place in places:
        points.InsertNextPoint(place)
    grid.SetPoints(points)
    grid.InsertNextCell(kind.vtk_type, kind.node_count, kind.vtk_order)
    at, theirs = _points(kind), [0.0, 0.0, 0.0]
    for point, ours in zip(at.T, values(kind.name, at).T @ places, strict=True):
        inside, weights = [*point, 0.0][:3], [0.0] * kind.node_count
        grid.GetCell(0).EvaluateLocation(reference(0), inside, theirs, weights)
        assert theirs == pytest.approx(ours, abs=1e-12)


def single(element, nodes):
    kind = SectionMesh if nodes.shape[1] == 2 else VolumeMesh
    return kind(nodes, np.arange(len(nodes))[None], element)


def measures(element, nodes):
    return tuple(float(measure[0]) for measure in quality(single(element, nodes)))


SQUARES_AND_CUBES = ("quad4", "quad9", "hex8", "hex27")
# Rows are where the reference cell's own sides go.
SHEARED = np.array([[1.0, 0.0, 0.0], [0.5, sqrt(3) / 2, 0.0], [0.0, 0.0, 1.0]])
REGULAR = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]])


@pytest.mark.parametrize(
    ("elements", "sides", "expected"),
    [
        (SQUARES_AND_CUBES, np.eye(3), (1.0, 1.0)),
        # By thirty degrees: the sine of sixty.
        (SQUARES_AND_CUBES, SHEARED, (sin(pi / 3), None)),
        # Longest by shortest side.
        (("quad9", "hex8"), np.diag([1.0, 5.0, 1.0]), (1.0, 5.0)),
        (("tri3", "tri6"), SHEARED, (1.0, 1.0)),
        (("tet4", "tet10"), REGULAR, (1.0, 1.0)),
        # Right corner of unit legs, largest product of sides at another corner: 1·√2, or 1·√2·√2.
        (("tri3",), np.eye(3), (2 / sqrt(3) / sqrt(2), sqrt(2))),
        (("tet4",), np.eye(3), (sqrt(2) / 2, sqrt(2))),
    ],
)
def test_measures_of_single_elements(elements, sides, expected):
    for element in elements:
        nodes = ELEMENTS[element].nodes
        d = nodes.shape[1]
        jacobian, aspect = measures(element, nodes @ sides[:d, :d])
        assert jacobian == pytest.approx(expected[0])
        assert expected[1] is None or aspect == pytest.approx(expected[1])


def test_mirrored_folded_and_slender_elements_are_refused():
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
