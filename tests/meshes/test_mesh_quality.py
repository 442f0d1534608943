"""Quality of elements whose measures are known by hand."""

from math import pi, sin, sqrt

import numpy as np
import pytest

from lumped.errors import ComputationError
from meshes.elements import ELEMENTS
from meshes.prism.hexahedra import hexahedra
from meshes.prism.tetrahedra import tetrahedra
from meshes.quality import check, quality
from meshes.section.section_mesh import SectionMesh, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh

NOWHERE = EndFace(
    np.empty(0, dtype=np.int64),
    SectionMesh(np.empty((0, 2)), np.empty((0, 4), dtype=np.int64), "quad4"),
)


def _single(element: str, nodes: np.ndarray) -> SectionMesh | SolidMesh:
    cell = np.arange(len(nodes))[None]
    if nodes.shape[1] == 2:
        return SectionMesh(nodes, cell, element)
    return SolidMesh(nodes, cell, element, NOWHERE, NOWHERE, None)


def _measures(element: str, nodes: np.ndarray) -> tuple[float, float]:
    found = quality(_single(element, nodes))
    return float(found.scaled_jacobian[0]), float(found.aspect[0])


@pytest.mark.parametrize("element", ["quad4", "quad9", "hex8", "hex27"])
def test_squares_and_cubes_are_perfect(element) -> None:
    assert _measures(element, ELEMENTS[element].nodes) == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize("element", ["quad4", "quad9", "hex8", "hex27"])
def test_shear_by_thirty_degrees_leaves_the_sine_of_sixty(element) -> None:
    sheared = ELEMENTS[element].nodes.copy()
    sheared[:, 0] = sheared[:, 0] + sheared[:, 1] / 2
    sheared[:, 1] = sheared[:, 1] * sqrt(3) / 2
    assert _measures(element, sheared)[0] == pytest.approx(sin(pi / 3))


@pytest.mark.parametrize("element", ["quad9", "hex8"])
def test_aspect_is_longest_by_shortest_side(element) -> None:
    stretched = ELEMENTS[element].nodes.copy()
    stretched[:, 1] *= 5.0
    assert _measures(element, stretched) == pytest.approx((1.0, 5.0))


@pytest.mark.parametrize("element", ["tri3", "tri6"])
def test_equilateral_triangle_is_perfect(element) -> None:
    equilateral = ELEMENTS[element].nodes @ np.array([[1.0, 0.0], [0.5, sqrt(3) / 2]])
    assert _measures(element, equilateral) == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize("element", ["tet4", "tet10"])
def test_regular_tetrahedron_is_perfect(element) -> None:
    edges = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]])
    assert _measures(element, ELEMENTS[element].nodes @ edges) == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize(
    ("element", "value"),
    # Right corner of unit legs, largest product of sides at another corner: 1·√2, or 1·√2·√2.
    [("tri3", 2 / sqrt(3) / sqrt(2)), ("tet4", sqrt(2) / 2)],
)
def test_right_angled_simplices(element, value) -> None:
    assert _measures(element, ELEMENTS[element].nodes) == pytest.approx((value, sqrt(2)))


@pytest.mark.parametrize("element", sorted(ELEMENTS))
def test_mirrored_elements_are_negative_and_refused(element) -> None:
    mirrored = ELEMENTS[element].nodes * np.eye(ELEMENTS[element].dimension)[0] * -2
    mirrored = ELEMENTS[element].nodes + mirrored
    assert _measures(element, mirrored)[0] < 0.0
    with pytest.raises(ComputationError, match=r"leg 1: .* inverted"):
        check(_single(element, mirrored), "leg 1")


def test_a_midside_node_beyond_the_quarter_point_folds_the_element() -> None:
    # x(ξ) = 4 m ξ (1 − ξ) + ξ (2ξ − 1) has slope 4m − 1 at ξ = 0: negative below m = 1/4.
    nodes = ELEMENTS["quad9"].nodes.copy()
    nodes[nodes[:, 0] == 0.5, 0] = 0.24
    assert _measures("quad9", nodes)[0] < 0.0


def test_slender_elements_are_refused_with_a_way_out() -> None:
    nodes = ELEMENTS["hex8"].nodes * np.array([101.0, 1.0, 1.0])
    with pytest.raises(ComputationError, match=r"101 times as long as wide.*more slices"):
        check(_single("hex8", nodes), "leg 2")


def test_meshes_of_every_section_are_well_shaped(section) -> None:
    # 0.3 for quadrilaterals and 0.1 for tetrahedra: what Verdict's manual calls acceptable is
    # 0.3 and 0.2; gmsh's curved tetrahedra on coarse arcs fall a little below.
    for divisions in (1, 4):
        for element in ("quad4", "quad9", "tri3", "tri6"):
            assert quality(section_mesh(section, divisions, element)).scaled_jacobian.min() > 0.3
        assert quality(hexahedra(section, 0.3, divisions)).scaled_jacobian.min() > 0.3
    # The coarsest follow arcs worst.
    assert quality(tetrahedra(section, 0.26, 1)).scaled_jacobian.min() > 0.1
