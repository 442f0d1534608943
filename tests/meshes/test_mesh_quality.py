"""Quality of elements whose measures are known by hand."""

from math import pi, sin, sqrt

import numpy as np
import pytest

from lumped.errors import ComputationError
from meshes.elements import ELEMENTS
from meshes.quality import check, quality
from meshes.section.section_mesh import SectionMesh
from meshes.solid_mesh import VolumeMesh


def single(element, nodes):
    kind = SectionMesh if nodes.shape[1] == 2 else VolumeMesh
    return kind(nodes, np.arange(len(nodes))[None], element)


def measures(element, nodes):
    return tuple(float(measure[0]) for measure in quality(single(element, nodes)))


SQUARES, CUBES = ("quad4", "quad9"), ("hex8", "hex27")
# Rows are where the reference cell's own sides go.
SHEARED = np.array([[1.0, 0.0, 0.0], [0.5, sqrt(3) / 2, 0.0], [0.0, 0.0, 1.0]])
REGULAR = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]])


@pytest.mark.parametrize(
    ("elements", "sides", "expected"),
    [
        (SQUARES + CUBES, np.eye(3), (1.0, 1.0)),
        # By thirty degrees: the sine of sixty.
        (SQUARES + CUBES, SHEARED, (sin(pi / 3), None)),
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
