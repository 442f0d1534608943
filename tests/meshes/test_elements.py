"""Element kinds against polynomials fitted to their nodes, and against VTK's own elements."""

import itertools

import numpy as np
import pytest
import vtk

from meshes.elements import ELEMENTS, ElementKind
from meshes.shape_functions import gradients, quadrature, values

KINDS = list(ELEMENTS.values())
by_name = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)


def _is_simplex(kind: ElementKind) -> bool:
    return kind.name.startswith("t")


def _exponents(kind: ElementKind) -> np.ndarray:
    powers = list(itertools.product(range(kind.order + 1), repeat=kind.dimension))
    if _is_simplex(kind):
        powers = [p for p in powers if sum(p) <= kind.order]
    elif len(powers) > kind.node_count:
        # Serendipity: at most one factor is squared (Arnold and Awanou, Found. Comput. Math. 11).
        powers = [p for p in powers if p.count(2) <= 1]
    return np.array(powers)


def _points(kind: ElementKind) -> np.ndarray:
    """Points inside the unit simplex, hence inside every reference cell."""
    inside = np.random.default_rng(1).dirichlet(np.ones(kind.dimension + 1), size=7)
    return inside[:, :-1].T


@by_name
def test_shape_functions_are_the_polynomials_that_are_one_at_their_node(kind: ElementKind) -> None:
    # Independent formulation: monomials and a Vandermonde matrix instead of scikit-fem.
    powers = _exponents(kind)
    vandermonde = np.prod(kind.nodes[:, None, :] ** powers[None], axis=2)
    at = _points(kind)
    monomials = np.prod(at.T[:, None, :] ** powers[None], axis=2)
    corners = kind.nodes[list(kind.corner_nodes)]
    assert np.all((corners == 0.0) | (corners == 1.0))
    # 1e-13: 27 terms of order one, rounding only.
    assert values(kind.name, at) == pytest.approx(
        np.linalg.solve(vandermonde.T, monomials.T), abs=1e-13
    )


@by_name
def test_gradients_are_slopes_and_quadrature_has_the_moments_of_the_cell(kind: ElementKind) -> None:
    at, step, d = _points(kind), 1e-5, kind.dimension
    for i, direction in enumerate(np.eye(d)[:, :, None] * step):
        slope = (values(kind.name, at + direction) - values(kind.name, at - direction)) / (2 * step)
        # Central differences are exact for these polynomials but for order step² in cross terms.
        assert gradients(kind.name, at)[:, i] == pytest.approx(slope, abs=1e-8)
    points, weights = quadrature(kind.name, 4)
    # ∫ξ⁴ over the unit simplex of dimension d: 4! / (4 + d)!; over the unit cube: 1/5.
    exact = {2: 24 / 720, 3: 24 / 5040}[d] if _is_simplex(kind) else 1 / 5
    assert points[0] ** 4 @ weights == pytest.approx(exact, rel=1e-12)


@by_name
def test_vtk_maps_a_curved_element_as_we_do(kind: ElementKind) -> None:
    # VTK's own interpolation of an element with scattered nodes: any wrong place in the
    # permutation would move the mapped points by the scatter.
    scatter = np.random.default_rng(2).uniform(-0.1, 0.1, size=(kind.node_count, 3))
    places = np.zeros((kind.node_count, 3))
    places[:, : kind.dimension] = kind.nodes
    places += scatter
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for place in places:
        points.InsertNextPoint(place)
    grid.SetPoints(points)
    grid.InsertNextCell(kind.vtk_type, kind.node_count, kind.vtk_order)
    cell = grid.GetCell(0)
    at = _points(kind)
    for point, ours in zip(at.T, values(kind.name, at).T @ places, strict=True):
        theirs = [0.0, 0.0, 0.0]
        inside = [*point, 0.0][:3]
        cell.EvaluateLocation(vtk.reference(0), inside, theirs, [0.0] * kind.node_count)
        assert theirs == pytest.approx(ours, abs=1e-12)
