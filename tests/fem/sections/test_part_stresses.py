"""Stresses in sections of two materials, against beam theory by hand and Lamé's cylinders."""

import numpy as np
import pytest

from fem.sections.moduli import part_moduli
from fem.sections.part_stresses import part_stresses
from fem.sections.stresses import section_stresses
from lumped.legs import Material
from lumped.sections import Channel, Composite, CompositePart, Rectangle
from meshes.section.section_mesh import SectionMesh, section_mesh

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
N, QY, QZ, T, MY, MZ = np.eye(6)
# A bimetal strip: 20 mm wide, 6 mm of aluminium under 4 mm of steel. Its axes have the origin in
# the middle of the aluminium.
WIDTH, LOWER, UPPER = 0.02, 0.006, 0.004
E_LOWER, E_UPPER = 7.0e10, 2.1e11


def bimetal(lower_ratio=0.3, upper_ratio=0.3, divisions=4):
    """Return the stresses of the strip, for the Poisson's ratios of both parts."""
    parts = (
        CompositePart(Rectangle(WIDTH, LOWER), E_LOWER, lower_ratio, 2700.0),
        CompositePart(
            Rectangle(WIDTH, UPPER), E_UPPER, upper_ratio, 7850.0, at=(0.0, (LOWER + UPPER) / 2.0)
        ),
    )
    mesh = section_mesh(Composite(parts), divisions)
    materials = [
        Material.isotropic(E_LOWER, lower_ratio, 2700.0),
        Material.isotropic(E_UPPER, upper_ratio, 7850.0),
    ]
    return part_stresses(mesh, part_moduli(mesh, materials))


# Timoshenko, Strength of Materials, beams of two materials: position of the neutral axis above the
# middle of the aluminium, EA, and EI about it.
EA = WIDTH * (E_LOWER * LOWER + E_UPPER * UPPER)
AXIS = E_UPPER * WIDTH * UPPER * (LOWER + UPPER) / 2.0 / EA
EI = E_LOWER * WIDTH * (LOWER**3 / 12.0 + LOWER * AXIS**2) + E_UPPER * WIDTH * (
    UPPER**3 / 12.0 + UPPER * ((LOWER + UPPER) / 2.0 - AXIS) ** 2
)


def test_bimetal_normal_stress_is_that_of_beam_theory():
    """σ = E_i (N/EA + My z/EI): each part by its own modulus, a step where both meet."""
    computed = bimetal()
    moduli = np.where(computed.parts == 0, E_LOWER, E_UPPER)
    for forces in (N, MY, 3.0 * N - 0.5 * MY):
        expected = moduli * (forces[0] / EA + forces[4] * computed.points[:, 1] / EI)
        scale = np.abs(expected).max()
        assert computed.normal @ forces == pytest.approx(expected, abs=1e-6 * scale)
        assert np.abs(computed.across @ forces).max() < 1e-6 * scale
        assert computed.von_mises(forces[None])[0] == pytest.approx(
            np.abs(expected), abs=2e-6 * scale
        )
    top = LOWER / 2.0 + UPPER - AXIS
    bottom = LOWER / 2.0 + AXIS
    assert computed.largest_by_part(MY) == pytest.approx(
        [E_LOWER * bottom / EI, E_UPPER * top / EI], rel=1e-6
    )


def test_bimetal_joint_carries_shear_flow():
    """Jourawski: the mean of τxz at the joint is Q ES/(b EI), with S of the upper part.

    The error falls with the square of the element size, from 5 % to 1 %.
    """
    static_moment = E_UPPER * WIDTH * UPPER * ((LOWER + UPPER) / 2.0 - AXIS)
    joint = LOWER / 2.0 - AXIS
    for part in (0, 1):
        errors = []
        for divisions in (4, 8):
            computed = bimetal(divisions=divisions)
            at_joint = np.abs(computed.points[:, 1] - joint) < 1e-9
            row = np.flatnonzero(at_joint & (computed.parts == part))
            row = row[np.argsort(computed.points[row, 0])]
            mean = np.trapezoid(computed.shear[1, row] @ QZ, computed.points[row, 0]) / WIDTH
            errors.append(abs(mean / (static_moment / (WIDTH * EI)) - 1.0))
        assert errors[1] < 0.015
        assert errors[1] < errors[0] / 3.0


def test_unequal_contraction_strains_both_parts():
    """Under tension the part with the larger ratio is pulled sideways, the other one pressed."""
    computed = bimetal(lower_ratio=0.45, upper_ratio=0.1)
    middle = np.abs(computed.points[:, 0]) < WIDTH / 10.0
    sideways = computed.across[0] @ N
    assert sideways[middle & (computed.parts == 0)].mean() > 0.0
    assert sideways[middle & (computed.parts == 1)].mean() < 0.0
    # Over a cut along the strip they have no resultant.
    resultant = [
        thickness * sideways[middle & (computed.parts == part)].mean()
        for part, thickness in enumerate((LOWER, UPPER))
    ]
    assert abs(sum(resultant)) < 0.1 * abs(resultant[0])


def test_stress_converges_beside_free_end_of_joint():
    """Tension, ratios 0.1 and 0.45: where the joint ends, finer meshes have larger stresses.

    Those across grow by a fifth and more with each halving of the elements. The largest stress of
    the lower part was there and grew by 3.2 %. Without these points it converges. Parts of one
    ratio have no such points.
    """
    largest, at_ends = [], []
    for divisions in (4, 8):
        computed = bimetal(0.1, 0.45, divisions)
        y, z = computed.points.T
        end = np.hypot(np.abs(y) - WIDTH / 2.0, z - (LOWER / 2.0 - AXIS)) < 1e-9
        assert end.sum() == 4
        assert not computed.regular[end].any()
        at_ends.append(np.abs(computed.across @ N)[:, end].max())
        largest.append(computed.largest_by_part(N))
    assert at_ends[1] > 1.2 * at_ends[0]
    assert largest[1] == pytest.approx(largest[0], rel=1e-3)
    assert bimetal().regular.all()


def test_parts_of_one_material_equal_its_section():
    """A channel with all cells in one region: the states and Saint-Venant's potentials agree."""
    mesh = section_mesh(Channel(0.05, 0.1, 0.02, 0.02), 4)
    regions = np.zeros(len(mesh.cells), dtype=int)
    marked = SectionMesh(mesh.nodes, mesh.cells, mesh.element, regions)
    computed = part_stresses(marked, part_moduli(marked, [STEEL]))
    expected = section_stresses(mesh, STEEL)
    assert (computed.regular == expected.regular).all()
    for forces in (N, QY, QZ, T / 0.05, MY / 0.05, MZ / 0.05, np.ones(6)):
        reference = expected.von_mises(forces[None])[0]
        difference = np.abs(computed.von_mises(forces[None])[0] - reference)[expected.regular]
        assert difference.max() < 0.01 * reference.max()


def test_stress_converges_beside_corner_between_parts():
    """A steel rail on an aluminium flange: both parts are convex, but form corners together.

    With the corners, the largest stress grows by a fifth with each finer mesh, without a limit.
    """
    flange, rail = Rectangle(0.06, 0.006), Rectangle(0.006, 0.04)
    parts = (
        CompositePart(flange, E_LOWER, 0.3, 2700.0),
        CompositePart(rail, E_UPPER, 0.3, 7850.0, at=(0.0, 0.023)),
    )
    materials = [Material.isotropic(part.E, part.nu, part.rho) for part in parts]
    largest = []
    for divisions in (4, 8):
        mesh = section_mesh(Composite(parts), divisions)
        stresses = part_stresses(mesh, part_moduli(mesh, materials))
        y, z = stresses.points.T
        # The origin is at the centre weighted by E, 12.3 mm above the top of the flange.
        near = np.hypot(np.abs(y) - 0.003, z + 0.01233) < 0.002
        assert set(stresses.parts[near]) == {0, 1}
        assert not stresses.regular[near].any()
        largest.append(max(stresses.largest_by_part(QZ)))
    assert largest[1] == pytest.approx(largest[0], rel=0.05)
