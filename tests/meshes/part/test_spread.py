"""A few nodes spread over a mesh: they have its volume and its extent."""

import numpy as np
import pytest

from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.part.spread import spread_over
from meshes.prism.extrude import extrude
from meshes.section.section_mesh import section_mesh


@pytest.fixture(scope="module")
def box():
    leg = ConstantLeg(0.5, Rectangle(0.05, 0.08), Material.isotropic(2.1e11, 0.3, 7850.0))
    return extrude(section_mesh(leg.section, 2), np.linspace(0.0, leg.length, 11))


def test_their_volumes_are_those_of_the_box(box):
    rows, volumes = spread_over(box)
    assert len(set(rows.tolist())) == len(rows) == len(volumes)
    assert volumes.sum() == pytest.approx(0.5 * 0.05 * 0.08, rel=1e-12)
    assert np.ptp(box.nodes[rows], axis=0) == pytest.approx([0.5, 0.05, 0.08])
    centre = volumes @ box.nodes[rows] / volumes.sum()
    # As far apart as a few places allow: the centre within a tenth of the length.
    assert centre == pytest.approx([0.25, 0.0, 0.0], abs=0.05)


def test_there_are_no_more_than_corners(box):
    rows, _ = spread_over(box, 10_000)
    assert len(rows) == 3 * 4 * 11
