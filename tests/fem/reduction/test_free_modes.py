"""Solids that nothing holds: rings by Love's formulas, and their six rigid-body motions."""

import numpy as np
import pytest

from fem.bodies.part import free_part, meshed_part
from fem.reduction.free_modes import free_modes
from lumped.legs import Material
from lumped.sections import Circle
from meshes.part.boundary import PartMesh
from meshes.prism import extrude, stations
from meshes.section.section_mesh import section_mesh

E, NU, RHO = 2.1e11, 0.3, 7850.0
RADIUS, SLICES = 0.1, 72


def ring(thickness):
    """A ring of round section (diameter m) about z: an extruded mesh bent to a circle."""
    face = section_mesh(Circle(thickness), 4)
    straight = extrude(face, stations(2.0 * np.pi, SLICES))
    angle, outward, z = straight.nodes.T
    radius = RADIUS + outward
    # Along the section's y outwards, x runs clockwise so that cells stay right-handed.
    nodes = np.column_stack([radius * np.cos(angle), -radius * np.sin(angle), z])
    # The last plane of nodes is the first.
    count = len(nodes) - len(face.nodes)
    return PartMesh(nodes[:count], straight.cells % count, "hex27", faces={}, straightened=0)


def love(thickness, n):
    """Frequencies (Hz) of n waves in the plane of a thin ring, and out of it.

    A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., §293, for a round
    section with c = E I/(ρ A R⁴): ω² = c n²(n² − 1)²/(n² + 1) and c n²(n² − 1)²/(n² + 1 + ν).
    """
    c = E * (thickness / 4.0) ** 2 / (RHO * RADIUS**4)
    squares = [c * n**2 * (n**2 - 1) ** 2 / below for below in (n**2 + 1, n**2 + 1 + NU)]
    return np.sqrt(squares) / (2.0 * np.pi)


def computed(thickness):
    """The lowest eight frequencies: pairs of two and three waves, in and out of the plane."""
    meshed = meshed_part(ring(thickness), Material.isotropic(E, NU, RHO))
    modes = free_modes(free_part(meshed, "ring"), 8)
    assert modes.count >= 8
    pairs = modes.frequencies.reshape(4, 2)
    # Cosine and sine around the ring are one mode of a round mesh.
    assert pairs[:, 1] == pytest.approx(pairs[:, 0], rel=1e-6)
    out_of_2, in_2, out_of_3, in_3 = pairs[:, 0]
    return np.array([in_2, out_of_2, in_3, out_of_3])


def test_free_ring_has_loves_frequencies():
    """Shear and rotary inertia, which Love leaves out, lower them by a share of (a/R)².

    Halving the thickness leaves a quarter of the difference. What is left at zero thickness is of
    fourth order in a/R (8e-4 of three waves), and the mesh, whose area is 8e-4 too small.
    """
    shares = []
    for thickness in (0.02, 0.01):
        expected = np.concatenate([love(thickness, 2), love(thickness, 3)])
        shares.append(computed(thickness) / expected - 1.0)
    thick, thin = shares
    assert (thick < 0.0).all()
    assert thick / thin == pytest.approx(np.full(4, 4.0), abs=0.3)
    assert (4.0 * thin - thick) / 3.0 == pytest.approx(np.zeros(4), abs=1.2e-3)
    # In percent for a/R = 0.05, two waves.
    assert 100.0 * thin[:2] == pytest.approx([-0.29, -0.62], abs=0.05)


def test_two_unconnected_rings_are_refused():
    """Twelve motions without deformation are no body."""
    one = ring(0.02)
    count = len(one.nodes)
    both = PartMesh(
        np.vstack([one.nodes, one.nodes + np.array([0.0, 0.0, 0.1])]),
        np.vstack([one.cells, one.cells + count]),
        "hex27",
        faces={},
        straightened=0,
    )
    with pytest.raises(Exception, match="rings"):
        free_modes(free_part(meshed_part(both, Material.isotropic(E, NU, RHO)), "rings"), 2)
