"""Stresses of fibre layers by laminate theory, against closed forms and an orthotropic solid."""

from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.sections.composite import wrench_states
from fem.sections.layer_stresses import layer_stresses
from fem.sections.moduli import leg_moduli
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import strains
from lumped.legs import ConstantLeg, Material
from lumped.sections import LaminateBox, LaminateTube, Layer
from meshes.section.section_mesh import section_mesh

# T300/5208 carbon and epoxy (S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, 1980,
# table 1.7): Pa.
CARBON = {"E1": 181e9, "E2": 10.3e9, "G12": 7.17e9, "nu12": 0.28, "rho": 1600.0}
DIAMETER = 0.06


def layers(*angles, thickness):
    return tuple(Layer(**CARBON, thickness=thickness, angle=angle) for angle in angles)


def leg_of(section):
    return ConstantLeg(0.3, section, Material(*section.mean_material))


def loaded(section, *forces):
    return layer_stresses(section, leg_of(section).timoshenko, np.array(forces, dtype=float))


def test_axial_fibres_have_stresses_of_isotropic_tube():
    """N/A + M r/I and T r/J, with the tube's own constants, whatever the moduli."""
    thickness = 3e-3
    inner = DIAMETER - 2.0 * thickness
    area = pi / 4.0 * (DIAMETER**2 - inner**2)
    moment = pi / 64.0 * (DIAMETER**4 - inner**4)
    result = loaded(LaminateTube(layers(0, thickness=thickness), DIAMETER), 800, 0, 0, 60, 30, 40)
    along, across, shear = np.moveaxis(result.stresses, 1, 0)
    bending = np.hypot(30, 40) * 0.5 * DIAMETER / moment
    assert along.max() == pytest.approx(800 / area + bending, rel=1e-3)
    assert shear.max() == pytest.approx(60 * 0.5 * DIAMETER / (2.0 * moment), rel=1e-12)
    assert_allclose(across, 0.0, atol=1e-6 * along.max())


def test_inclined_layers_carry_torque_along_fibres():
    """Layers at ±45° in pure shear γ: σ1 = ±(Q11 − Q12) γ/2 and σ2 = ±(Q12 − Q22) γ/2."""
    section = LaminateTube(layers(45, -45, 45, -45, thickness=0.25e-3), DIAMETER)
    result = loaded(section, 0, 0, 0, 100, 0, 0)
    share = 1.0 - CARBON["nu12"] ** 2 * CARBON["E2"] / CARBON["E1"]
    q11, q22 = CARBON["E1"] / share, CARBON["E2"] / share
    q12 = CARBON["nu12"] * q22
    outer = result.layers == 3
    # A66 of layers at ±45°; γ at the middle line is q/A66t with the flow q = T/2πr².
    radius, a66 = 0.5 * (DIAMETER - 1e-3), 0.25 * (q11 + q22 - 2.0 * q12)
    gamma = 100 / (2.0 * pi * radius**2) / (a66 * 1e-3)
    largest = np.abs(result.stresses[outer]).max(axis=0)
    # At the outer face, γ is larger by half the thickness over the radius.
    assert largest[0] == pytest.approx(0.5 * (q11 - q12) * gamma * 0.03 / radius, rel=1e-3)
    assert largest[1] == pytest.approx(0.5 * (q22 - q12) * gamma * 0.03 / radius, rel=1e-3)
    assert largest[2] < 1e-6 * largest[0]
    assert result.stresses[outer, 0].max() < 0.0 < result.stresses[result.layers == 2, 0].min()


def solid_stresses(section, forces):
    """Wall stresses by finite elements of the section.

    The result is the points (p×2) with stresses (p×3: σx, σs, τxs), and the index (p) of the layer
    of each point.
    """
    leg = leg_of(section)
    mesh = section_mesh(section, 2)
    moduli = leg_moduli(leg, mesh)
    states = wrench_states(mesh, moduli)
    quad = section_quadrature(mesh)
    across = strains(quad, 0.0)
    along = strains(quad, 1.0) - across
    along[:, :, 0] *= -1.0
    fields = ((states.displacements, across), (states.slopes, along))
    strain = sum(
        np.einsum("mqsi,mi->mqs", matrix, (field @ forces).reshape(-1, 3)[mesh.cells].reshape(
            len(mesh.cells), -1
        ))
        for field, matrix in fields
    )  # fmt: skip
    _, yy, zz, yz, xz, xy = stress = np.moveaxis(
        np.einsum("mqst,mqt->mqs", moduli.on(quad), strain), 2, 0
    )
    y, z = quad.points
    radius = np.hypot(y, z)
    c, s = y / radius, z / radius
    wall = np.stack([stress[0], s * s * yy + c * c * zz - 2.0 * s * c * yz, c * xz - s * xy], -1)
    faces = np.cumsum([0.5 * section.diameter - section.thickness, *section.thicknesses])
    return wall.reshape(-1, 3), np.searchsorted(faces, radius.ravel()) - 1


@pytest.mark.parametrize(
    ("angles", "thickness"), [((0,), 3e-3), ((45, -45, 0), 1e-3), ((30,), 2e-3), ((0, 30), 5e-4)]
)
def test_half_widths_contain_orthotropic_solid(angles, thickness):
    """The largest stresses of each layer of a tube, under each section force alone."""
    section = LaminateTube(layers(*angles, thickness=thickness), DIAMETER)
    for force in 1e3 * np.diag([1.0, 1.0, 1.0, 0.1, 0.1, 0.1]):
        by_theory = loaded(section, *force)
        stresses, layer_of_point = solid_stresses(section, force)
        scale = np.abs(by_theory.stresses).max()
        for number, layer in enumerate(section.layers):
            c, s = np.cos(np.radians(layer.angle)), np.sin(np.radians(layer.angle))
            xx, ss, xs = stresses[layer_of_point == number].T
            turned = (
                c * c * xx + s * s * ss + 2.0 * c * s * xs,
                s * s * xx + c * c * ss - 2.0 * c * s * xs,
                c * s * (ss - xx) + (c * c - s * s) * xs,
            )
            inside = by_theory.layers == number
            for solid, theory, width in zip(
                turned,
                by_theory.stresses[inside].T,
                by_theory.half_widths[inside].T,
                strict=True,
            ):
                error = np.abs(solid).max() - np.abs(theory).max()
                assert abs(error) < width.max() + 0.01 * scale


def test_box_has_flow_of_force_and_torque():
    """Resultants of the shear flow and of the axial stresses of a box of axial fibres."""
    section = LaminateBox(layers(0, thickness=1e-3), 0.06, 0.04)
    b, h, t = 0.059, 0.039, 1e-3
    torque = loaded(section, 0, 0, 0, 50, 0, 0)
    assert_allclose(torque.stresses[:, 2], 50 / (2.0 * b * h * t), rtol=1e-12)
    sheared = loaded(section, 0, 0, 700, 0, 0, 0)
    # Each web: parabola between both ends, by Simpson's rule on its three values.
    web = np.isclose(sheared.points[:, 0], 0.03) & (np.abs(sheared.points[:, 1]) < 0.0201)
    flows, z = t * sheared.stresses[web, 2], sheared.points[web, 1]
    ends, middle = flows[np.abs(z) > 0.0199].min(), flows[np.abs(z) < 1e-9].max()
    assert 2.0 * h * (2.0 * ends + 4.0 * middle) / 6.0 == pytest.approx(700, rel=1e-9)
    bent = loaded(section, 0, 0, 0, 0, 30, 0)
    moment = leg_of(section).timoshenko.EIy / CARBON["E1"]
    assert bent.stresses[:, 0].max() == pytest.approx(30 * 0.02 / moment, rel=1e-3)
