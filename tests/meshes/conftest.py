"""Sections of every shape, and what the tests ask of any mesh: integrals, facets, outlines."""

from collections.abc import Callable

import numpy as np
import pytest

from lumped.arrays import Array, IntArray
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from meshes.elements import ELEMENTS
from meshes.section.section_mesh import SectionMesh
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import SolidMesh

SECTIONS: list[Section] = [
    Rectangle(0.16, 0.26),
    HollowRectangle(0.10, 0.16, 0.02),
    Circle(0.10),
    Tube(0.10, 0.02),
    ISection(0.10, 0.16, 0.03, 0.02),
]

Mesh = SectionMesh | SolidMesh


@pytest.fixture(params=SECTIONS, ids=lambda section: section.shape)
def section(request: pytest.FixtureRequest) -> Section:
    return request.param


@pytest.fixture
def integral() -> Callable[[Mesh, Callable[[Array], Array]], float]:
    """∫ f over a mesh; f takes the coordinates (…×d)."""

    def integrate(mesh: Mesh, f: Callable[[Array], Array]) -> float:
        points, weights = quadrature(mesh.element, 6)
        corners = mesh.nodes[mesh.cells]
        jacobian = np.einsum("mki,kjq->mqij", corners, gradients(mesh.element, points))
        at = np.einsum("mki,kq->mqi", corners, values(mesh.element, points))
        determinant = np.linalg.det(jacobian)
        # Right-handed.
        assert determinant.min() > 0.0
        return float(((determinant * f(at)) @ weights).sum())

    return integrate


def _facets_of_reference_cell(nodes: Array) -> list[IntArray]:
    """Local nodes on each side of a reference cell, found from the planes that bound it."""
    sides = [nodes[:, i] == 0.0 for i in range(nodes.shape[1])]
    if np.any(nodes.sum(axis=1) > 1.0):
        sides += [nodes[:, i] == 1.0 for i in range(nodes.shape[1])]
    else:
        sides.append(nodes.sum(axis=1) == 1.0)
    return [np.flatnonzero(side) for side in sides]


@pytest.fixture
def facets() -> Callable[[Mesh], tuple[IntArray, IntArray]]:
    """Distinct facets (F×n node numbers, sorted) and how many cells own each."""

    def find(mesh: Mesh) -> tuple[IntArray, IntArray]:
        sides = _facets_of_reference_cell(ELEMENTS[mesh.element].nodes)
        every = np.vstack([mesh.cells[:, side] for side in sides])
        return np.unique(np.sort(every, axis=1), axis=0, return_counts=True)

    return find
