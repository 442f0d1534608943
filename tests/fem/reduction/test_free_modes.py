"""Solids without supports: free rings against Love's formulas."""

import numpy as np
import pytest

from fem.bodies.part import free_part, meshed_part
from fem.reduction.free_modes import free_modes
from fem.solvers.factor import NotPositiveDefiniteError
from lumped.legs import Material
from lumped.sections import Circle
from meshes.part.boundary import PartMesh
from meshes.prism import extrude, stations
from meshes.section.section_mesh import section_mesh

E, NU, RHO = 2.1e11, 0.3, 7850.0
RADIUS, SLICES = 0.1, 72


def ring(thickness):
    """Return a ring about z with a round section of diameter `thickness` (m)."""
    face = section_mesh(Circle(thickness), 4)
    straight = extrude(face, stations(2.0 * np.pi, SLICES))
    angle, outward, z = straight.nodes.T
    radius = RADIUS + outward
    # The section's y points outwards; x runs clockwise, so that the elements stay right-handed.
    nodes = np.column_stack([radius * np.cos(angle), -radius * np.sin(angle), z])
    # The last plane of nodes coincides with the first.
    count = len(nodes) - len(face.nodes)
    return PartMesh(nodes[:count], straight.cells % count, "hex27", faces={}, straightened=0)


def love(thickness, n):
    """Return the frequencies (Hz) of n waves around a thin ring, in its plane and out of it.

    A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., §293, for a round
    section with c = E I/(ρ A R⁴): ω² = c n²(n² − 1)²/(n² + 1) and c n²(n² − 1)²/(n² + 1 + ν).
    """
    c = E * (thickness / 4.0) ** 2 / (RHO * RADIUS**4)
    squares = [c * n**2 * (n**2 - 1) ** 2 / below for below in (n**2 + 1, n**2 + 1 + NU)]
    return np.sqrt(squares) / (2.0 * np.pi)


def computed(thickness):
    """Return the frequencies (Hz) of two and three waves, in and out of the ring's plane."""
    meshed = meshed_part("ring", ring(thickness), Material.isotropic(E, NU, RHO))
    modes = free_modes(free_part(meshed), 8)
    assert modes.count >= 8
    pairs = modes.frequencies.reshape(4, 2)
    # The mesh is rotationally symmetric: cosine and sine waves have equal frequencies.
    assert pairs[:, 1] == pytest.approx(pairs[:, 0], rel=1e-6)
    out_of_2, in_2, out_of_3, in_3 = pairs[:, 0]
    return np.array([in_2, out_of_2, in_3, out_of_3])


@pytest.mark.slow
def test_free_ring_modes_equal_love():
    """Shear and rotary inertia, which Love neglects, lower the frequencies by terms in (a/R)².

    Halving the thickness leaves a quarter of the difference. Extrapolated to zero thickness, a term
    of fourth order in a/R (8e-4 for three waves) and the mesh, whose area is 8e-4 too small,
    remain.
    """
    differences = []
    for thickness in (0.02, 0.01):
        expected = np.concatenate([love(thickness, 2), love(thickness, 3)])
        differences.append(computed(thickness) / expected - 1.0)
    thick, thin = differences
    assert (thick < 0.0).all()
    assert thick / thin == pytest.approx(np.full(4, 4.0), abs=0.3)
    assert (4.0 * thin - thick) / 3.0 == pytest.approx(np.zeros(4), abs=1.2e-3)
    # Differences in percent for two waves and a/R = 0.05.
    assert 100.0 * thin[:2] == pytest.approx([-0.29, -0.62], abs=0.05)


@pytest.mark.slow
def test_unconnected_rings_are_refused():
    """A body has six motions without deformation; two rings together have twelve."""
    first = ring(0.02)
    count = len(first.nodes)
    two_rings = PartMesh(
        np.vstack([first.nodes, first.nodes + np.array([0.0, 0.0, 0.1])]),
        np.vstack([first.cells, first.cells + count]),
        "hex27",
        faces={},
        straightened=0,
    )
    with pytest.raises(NotPositiveDefiniteError, match="free to move as a rigid body"):
        free_modes(free_part(meshed_part("rings", two_rings, Material.isotropic(E, NU, RHO))), 2)
