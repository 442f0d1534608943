"""Warping of legs by their constants: lines of `check`, against Vlasov's closed form."""

from math import sqrt, tanh

import numpy as np
import pytest

from fem.sections.nonuniform_torsion import held_torsion_compliance, warping_rod
from fem.sections.section_constants import section_constants
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import robot_of
from lumped.sections import Channel, SectionProperties
from meshes.section.section_mesh import section_mesh
from validation.models.plausibility import held_stiffening, warping_text

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# An IPE 200, as tables print it (cm², cm⁴, cm⁶): A 28.5, Iy 1943, Iz 142.4, It 6.98, Iw 12990.
IPE_200 = {
    "shape": "properties",
    "A": 28.5e-4,
    "Iy": 1943e-8,
    "Iz": 142.4e-8,
    "J": 6.98e-8,
    "Iw": 12990e-12,
}


def text_of(section, **leg):
    arm = {"from": "A", "to": "P", "section": section, **leg}
    arm["material"] = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
    robot = {
        "schema": 2,
        "name": "cantilever",
        "points": {"A": [0.0, 0.0, 0.0], "P": [2.0, 0.0, 0.0]},
        "bodies": {"arm": arm},
        "joints": {"root": {"type": "fixed", "between": ["ground", "arm"], "at": "A"}},
        "tool": {"body": "arm", "point": "P", "moves": []},
    }
    return warping_text(robot_of(robot).mechanism)


def test_held_ends_stiffen_as_vlasov():
    """GJ/L becomes GJ/(L − (2/k) tanh(kL/2)) with k² = GJ/EIw, for J far below the polar moment."""
    k = sqrt(6.98e-8 / 2.6 / 12990e-12)
    stiffening = 1.0 / (1.0 - tanh(k) / k) - 1.0
    text = text_of(IPE_200)
    assert text.startswith("arm: would be ")
    assert text.endswith(
        " % stiffer in torsion if both ends prevented warping (Iw); all models let it warp"
    )
    assert float(text.split()[3]) == pytest.approx(100.0 * stiffening, rel=0.02)
    assert text_of(IPE_200, ends="rigid") == text
    assert text_of(IPE_200, ends="free") == ""


def test_large_stiffening_is_stated_as_factor():
    """A hundred times the warping constant: Vlasov's factor, limited by the polar moment of area.

    The compliance is the sum of Vlasov's, (1 − tanh(k)/k) L/GJ, and L/GIp.
    """
    k = sqrt(6.98e-8 / 2.6 / 12990e-10)
    text = text_of({**IPE_200, "Iw": 100.0 * IPE_200["Iw"]})
    assert " times as stiff in torsion if both ends prevented warping" in text
    factor = 1.0 / (1.0 - tanh(k) / k + 6.98 / (1943.0 + 142.4))
    assert float(text.split()[3]) == pytest.approx(factor, rel=0.01)


def test_constants_of_mesh_give_its_stiffening():
    """A channel by its computed constants: the same number as by its section mesh."""
    mesh = section_mesh(Channel(0.05, 0.1, 0.0085, 0.006), 4)
    constants = section_constants(mesh, STEEL.nu)
    ys, zs = np.subtract(constants.shear_centre, constants.centroid)
    section = SectionProperties(
        constants.area,
        constants.second_moment_y,
        constants.second_moment_z,
        constants.torsion_constant,
        ys=ys,
        zs=zs,
        Iw=constants.warping_constant,
    )
    leg = ConstantLeg(0.6, section, STEEL)
    free = leg.length / (STEEL.G * section.J)
    held = held_torsion_compliance(warping_rod(constants, STEEL), leg.length)
    assert held_stiffening(leg, section) == pytest.approx(free / held - 1.0, rel=1e-9)
    assert 1.8 < held_stiffening(leg, section) < 1.95


def test_rigid_ends_without_warping_constant_are_named():
    """The effect of ends declared rigid is unknown. Unspecified ends give no line."""
    section = {name: value for name, value in IPE_200.items() if name != "Iw"}
    assert text_of(section) == ""
    assert text_of(section, ends="rigid").startswith("arm: has no warping constant Iw; by how much")
