"""Energies by kind of a solid leg against beams in pure states, and their bounds."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from prismatic_legs import STEEL

from fem.bodies.leg_energies import DISTORTION, kind_energies
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.sections import Rectangle
from meshes.prism.tetrahedra import tetrahedra

LEG = ConstantLeg(0.6, Rectangle(width=0.08, height=0.12), STEEL)
# Wrench on the tip and the kind that carries all of its energy.
PURE = {0: "tension", 3: "torsion", 1: "bending z", 2: "bending y", 4: "bending y", 5: "bending z"}


@pytest.fixture(scope="module")
def solid():
    return solid_leg(LEG, solid_mesh(LEG, 2))


def test_saint_venants_states_are_of_one_kind(solid):
    clamped = clamped_leg(solid, "free")
    loads = clamped.ends.tip_loads()
    fields = clamped.ends.expanded(clamped.factor.solve(loads))
    energies = kind_energies(solid, fields)
    # Clapeyron: half the work of the load on its own displacement.
    work = 0.5 * np.einsum("ij,ij->j", loads, fields)
    for wrench, kind in PURE.items():
        # Bending by a force is cubic in x, the elements are quadratic: 1e-4 is left to them.
        assert_allclose(energies[kind][wrench], work[wrench], rtol=1e-3)
        others = sum(energy[wrench] for name, energy in energies.items() if name != kind)
        assert abs(others) < 1e-3 * work[wrench]
    assert_allclose(sum(energies.values()), work, rtol=1e-9)


def test_rigid_motions_have_no_energy(solid):
    x, y, _ = solid.mesh.nodes.T
    turned = np.stack([-y, x, np.zeros_like(x)], axis=1).reshape(-1, 1)
    scale = LEG.timoshenko.EIz / LEG.length
    for energy in kind_energies(solid, turned).values():
        assert np.abs(energy).max() < 1e-9 * scale


def test_no_kind_is_negative_for_any_displacement(solid):
    """Bessel's inequality: beam theory's part of the energy is never more than all of it."""
    random = np.random.default_rng(1)
    smooth = np.cos(random.uniform(0.0, 20.0, (3, 12)).T @ solid.mesh.nodes.T).T
    fields = np.einsum("nk,ck->nck", smooth, random.normal(size=(3, 12))).reshape(-1, 12)
    energies = kind_energies(solid, fields)
    whole = sum(energies.values())
    for energy in energies.values():
        assert np.all(energy > -1e-10 * whole)
    assert np.all(energies[DISTORTION] > 0.0)


def test_tetrahedra_are_refused():
    mesh = tetrahedra(LEG.section, LEG.length, 1)
    with pytest.raises(InputError, match="extruded"):
        kind_energies(solid_leg(LEG, mesh), np.zeros((3 * len(mesh.nodes), 1)))
