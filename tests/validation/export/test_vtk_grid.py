"""VTK's own measures of our meshes."""

import numpy as np
import pytest

from lumped.sections import Rectangle
from meshes.prism.hexahedra import hexahedra
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh
from validation.export.vtk_files import grid

SECTION = Rectangle(0.1, 0.2)


@pytest.mark.parametrize("family", [hexahedra, tetrahedra])
def test_vtk_finds_the_volume(family) -> None:
    volumes = grid(family(SECTION, 0.5, 2)).compute_cell_sizes()["Volume"]
    assert volumes.min() > 0.0
    assert volumes.sum() == pytest.approx(0.1 * 0.2 * 0.5, rel=1e-6)  # VTK works in float32 parts


def test_a_section_lies_in_the_plane_of_the_root() -> None:
    flat = section_mesh(SECTION, 2)
    drawn = grid(flat)
    assert np.array_equal(drawn.points[:, 1:], flat.nodes)
    assert np.all(drawn.points[:, 0] == 0.0)
    assert drawn.compute_cell_sizes()["Area"].sum() == pytest.approx(0.1 * 0.2, rel=1e-6)
