"""Static superelements against the unreduced legs, beam theory and the inertia of a box."""

from dataclasses import replace

import numpy as np
import pytest
from compliances import scaled_difference
from like_ifw import EQUIVALENT
from numpy.testing import assert_allclose
from prismatic_legs import meshed
from scipy.linalg import block_diag
from scipy.sparse import csr_array

from fem.beams.beam import beam_leg
from fem.bodies.solid import clamped_leg, section_twists, solid_leg_matrices
from fem.reduction.superelement import ENDS, held_leg, held_solid_leg, static_superelement
from lumped.errors import ComputationError
from lumped.models.bodies import legs_of
from lumped.models.segments import segment_chain, segment_leg
from lumped.screws import shift

LEG_1, LEG_2 = legs_of(EQUIVALENT).values()


MODELS = {
    "segments": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 8)),
    # Two rigid ends and one spring: nothing to condense.
    "ends alone": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 2, "literal")),
    # 11 unknowns inside: not in threes, the order of elimination takes them all the same.
    "beam": lambda leg: beam_leg(leg.timoshenko, leg.length, 3),
    "solid": lambda leg: solid_leg_matrices(meshed(leg, 1, 3)),
}
models = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


@models
def test_condensation_is_the_schur_complement_and_recovers_the_field(model):
    """Dense K_bb − K_bi K_ii⁻¹ K_ib, and Guyan's mass with the same transformation."""
    leg = model(LEG_2)
    k, m = leg.stiffness.toarray(), leg.mass.toarray()
    modes = np.vstack([np.eye(12), -np.linalg.solve(k[12:, 12:], k[12:, :12])])
    superelement = static_superelement(held_leg(leg))
    reduced = superelement.matrices
    expected = k[:12, :12] + k[:12, 12:] @ modes[12:]
    assert scaled_difference(reduced.stiffness.toarray(), expected) < 1e-9
    assert_allclose(reduced.mass.toarray(), modes.T @ m @ modes, rtol=0, atol=1e-9 * m.max())
    size = np.abs(modes).max(axis=0)
    assert_allclose(superelement.recover(np.eye(12)) / size, modes / size, atol=1e-9)
    at = np.array([0.0, 0.3, LEG_2.length])
    field = leg.centreline(at) @ modes
    assert_allclose(reduced.centreline(at) @ np.eye(12) / size, field / size, atol=1e-9)


@models
def test_rigid_leg_keeps_mass_and_inertia(model):
    """A box about its centre: m (b² + h²)/12 and so on, whatever the model; no force, no energy."""
    reduced = static_superelement(held_leg(model(LEG_1))).matrices
    mass, L, b, h = LEG_1.mass, LEG_1.length, *LEG_1.section.extent
    centre = np.array([L / 2.0, 0.0, 0.0])
    # About the centre; a motion of the reduced leg has no amplitudes inside.
    motions = np.zeros((reduced.size, 6))
    motions[:ENDS] = np.vstack([shift(-centre), shift(centre)])
    inertia = mass / 12.0 * np.diag([b**2 + h**2, L**2 + h**2, L**2 + b**2])
    expected = block_diag(mass * np.eye(3), inertia)
    assert_allclose(motions.T @ (reduced.mass @ motions), expected, rtol=1e-8, atol=1e-9 * mass)
    # Rounding, by construction from the tip's stiffness; rotations counted by the leg's length.
    stiffness, unit = reduced.stiffness.toarray(), np.r_[np.ones(3), np.full(3, 1.0 / L)]
    ends = np.tile(unit, 2)
    forces = ends[:, None] * (stiffness @ motions) * unit
    assert np.abs(forces).max() < 1e-13 * np.abs(stiffness * np.outer(ends, ends)).max()
    energies = np.einsum("ij,ij->j", motions, stiffness @ motions)
    assert np.all(np.abs(energies) < 1e-12 * np.diag(stiffness)[6:])
    for matrix in (stiffness, reduced.mass.toarray()):
        assert np.array_equal(matrix, matrix.T)


def test_supported_legs_and_loose_parts_are_refused():
    leg = MODELS["beam"](LEG_1)
    stiffness = leg.stiffness.toarray()
    grounded, loose = stiffness.copy(), stiffness.copy()
    grounded[13, 13] *= 1.0 + 1e-3
    with pytest.raises(ComputationError, match=r"beam leg: a rigid motion .* supported"):
        held_leg(replace(leg, stiffness=csr_array(grounded)))
    loose[13], loose[:, 13] = 0.0, 0.0
    loose[13, 13] = -1.0
    with pytest.raises(ComputationError, match="beam leg, both ends held"):
        held_leg(replace(leg, stiffness=csr_array(loose)))


@pytest.fixture(scope="module")
def free_leg_2():
    solid = meshed(LEG_2, (3, 9), 12)
    return solid, clamped_leg(solid, "free")


def test_free_constraint_modes_have_the_twists_they_are_named_for(free_leg_2):
    solid, clamped = free_leg_2
    held = held_solid_leg(clamped, solid.mesh)
    loads = clamped.solid.twists
    scale = np.abs(held.constraint_modes).max(axis=0)
    assert_allclose(loads.T @ held.constraint_modes / scale, np.eye(12) / scale, atol=1e-9)
    # Forces of a constraint mode act at the ends alone: K Ψ = B S, in equilibrium.
    forces = solid.stiffness @ held.constraint_modes
    expected = loads @ held.stiffness
    size = np.abs(expected).max(axis=0)
    assert_allclose(forces / size, expected / size, atol=1e-7)
    force = np.random.default_rng(3).standard_normal((held.size, 2))
    held_response = held.flexibility(force)
    assert np.abs(loads.T @ held_response).max() < 1e-9 * np.abs(held_response).max()
    assert_allclose(
        force.T @ held_response, held_response.T @ solid.stiffness @ held_response, rtol=1e-7
    )
    at = np.array([0.2, 0.5])
    assert_allclose(held.centreline(at).toarray(), section_twists(solid.mesh, at).toarray())


def test_a_solid_leg_with_rigid_ends_is_that_of_its_matrices():
    solid = meshed(LEG_1, 1, 3)
    found = static_superelement(held_solid_leg(clamped_leg(solid), solid.mesh)).matrices
    expected = static_superelement(held_leg(solid_leg_matrices(solid))).matrices
    assert scaled_difference(found.stiffness.toarray(), expected.stiffness.toarray()) < 1e-9
    assert scaled_difference(found.mass.toarray(), expected.mass.toarray()) < 1e-9
    at = np.array([0.2, 0.85])
    ours, theirs = (one.centreline(at).toarray() for one in (found, expected))
    assert_allclose(ours, theirs, rtol=0.0, atol=1e-9)
