"""Legs reduced to their ends by static condensation or Craig–Bampton, against unreduced legs.

Also against beam theory and the inertia of a box; frequency bounds against the error of a robot.
"""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import block_diag
from scipy.sparse import csr_array
from support.oracles.compliance_difference import scaled_difference
from support.robots.paper_legs import meshed
from support.robots.paper_robot_variants import EQUIVALENT, system_of

from fem.beams.beam import beam_leg
from fem.bodies.solid import clamped_leg, section_twists, solid_leg_matrices
from fem.reduction.craig_bampton import craig_bampton, frequency_bounds
from fem.reduction.superelement import ENDS, held_leg, held_solid_leg, static_superelement
from lumped.errors import ComputationError, InputError
from lumped.models.bodies import legs_of
from lumped.models.segments import segment_chain, segment_leg
from lumped.screws import shift
from lumped.system.solution import compliance, modes, solved

LEGS = legs_of(EQUIVALENT)
LEG_1, LEG_2 = LEGS.values()
MODELS = {
    "segments": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 8)),
    # Two rigid ends and one spring: no internal unknowns.
    "ends alone": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 2, "literal")),
    "beam": lambda leg: beam_leg(leg.timoshenko, leg.length, 12),
    "solid": lambda leg: solid_leg_matrices(meshed(leg, 1, 4)),
}
models = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


@models
def test_condensed_leg_is_schur_complement(model):
    """Dense K_bb − K_bi K_ii⁻¹ K_ib, and Guyan's mass matrix by the same transformation."""
    leg = model(LEG_2)
    k, m = leg.stiffness.toarray(), leg.mass.toarray()
    shapes = np.vstack([np.eye(12), -np.linalg.solve(k[12:, 12:], k[12:, :12])])
    superelement = static_superelement(held_leg(leg))
    reduced = superelement.matrices
    expected = k[:12, :12] + k[:12, 12:] @ shapes[12:]
    assert scaled_difference(reduced.stiffness.toarray(), expected) < 1e-9
    assert_allclose(reduced.mass.toarray(), shapes.T @ m @ shapes, rtol=0, atol=1e-9 * m.max())
    size = np.abs(shapes).max(axis=0)
    assert_allclose(superelement.recover(np.eye(12)) / size, shapes / size, atol=1e-9)
    x = np.array([0.0, 0.3, LEG_2.length])
    field = leg.centreline(x) @ shapes
    assert_allclose(reduced.centreline(x) @ np.eye(12) / size, field / size, atol=1e-9)


@pytest.mark.parametrize("reduce", [static_superelement, lambda leg: craig_bampton(leg, 500.0)])
def test_reduced_solid_releases_its_factor(reduce):
    """The factors of many legs would otherwise need gigabytes."""
    solid = meshed(LEG_2, 1, 4)
    clamped = clamped_leg(solid)
    matrices = reduce(held_solid_leg(clamped, solid.mesh)).matrices
    references = [weakref.ref(item) for item in (clamped, clamped.factor, clamped.solid)]
    del clamped
    gc.collect()
    assert [item() for item in references] == [None, None, None]
    assert matrices.centreline(np.array([0.0])).shape[0] == 6


@models
def test_condensed_leg_keeps_rigid_mass(model):
    """Mass and inertia of a box, m (b² + h²)/12, for every model; rigid motions need no force."""
    reduced = static_superelement(held_leg(model(LEG_1))).matrices
    mass, L, b, h = LEG_1.mass, LEG_1.length, *LEG_1.section.extent
    centre = np.array([L / 2.0, 0.0, 0.0])
    # Rigid motions about the centre; the reduced leg has only its twelve end unknowns.
    motions = np.zeros((reduced.size, 6))
    motions[:ENDS] = np.vstack([shift(-centre), shift(centre)])
    inertia = mass / 12.0 * np.diag([b**2 + h**2, L**2 + h**2, L**2 + b**2])
    expected = block_diag(mass * np.eye(3), inertia)
    assert_allclose(motions.T @ (reduced.mass @ motions), expected, rtol=1e-8, atol=1e-9 * mass)
    # Forces vanish up to rounding; rotations are multiplied by the leg's length.
    stiffness, unit = reduced.stiffness.toarray(), np.r_[np.ones(3), np.full(3, 1.0 / L)]
    ends = np.tile(unit, 2)
    forces = ends[:, None] * (stiffness @ motions) * unit
    assert np.abs(forces).max() < 1e-13 * np.abs(stiffness * np.outer(ends, ends)).max()
    energies = np.einsum("ij,ij->j", motions, stiffness @ motions)
    assert np.all(np.abs(energies) < 1e-12 * np.diag(stiffness)[6:])
    for matrix in (stiffness, reduced.mass.toarray()):
        assert np.array_equal(matrix, matrix.T)


def test_grounded_or_unstable_leg_is_refused():
    """A stiffness to ground makes rigid motions cost energy; a negative one has no minimum."""
    leg = MODELS["beam"](LEG_1)
    grounded, loose = leg.stiffness.toarray(), leg.stiffness.toarray()
    grounded[13, 13] *= 1.0 + 1e-3
    with pytest.raises(ComputationError, match=r"beam leg: a rigid-body motion .* supported"):
        held_leg(replace(leg, stiffness=csr_array(grounded)))
    loose[13], loose[:, 13] = 0.0, 0.0
    loose[13, 13] = -1.0
    with pytest.raises(ComputationError, match="beam leg, both ends held"):
        held_leg(replace(leg, stiffness=csr_array(loose)))


def test_free_ends_have_constraint_modes():
    """Constraint modes have unit mean twists of the ends, and forces at the ends only."""
    solid = meshed(LEG_2, (2, 6), 8)
    clamped = clamped_leg(solid, "free")
    held_leg_body = held_solid_leg(clamped, solid.mesh)
    loads = clamped.solid.twists
    scale = np.abs(held_leg_body.constraint_modes).max(axis=0)
    assert_allclose(loads.T @ held_leg_body.constraint_modes / scale, np.eye(12) / scale, atol=1e-9)
    # The forces of a constraint mode act only at the ends and are in equilibrium: K Ψ = B S.
    forces = solid.stiffness @ held_leg_body.constraint_modes
    expected = loads @ held_leg_body.stiffness
    size = np.abs(expected).max(axis=0)
    assert_allclose(forces / size, expected / size, atol=1e-7)
    force = np.random.default_rng(3).standard_normal((held_leg_body.size, 2))
    response = held_leg_body.flexibility(force)
    assert np.abs(loads.T @ response).max() < 1e-9 * np.abs(response).max()
    assert_allclose(force.T @ response, response.T @ solid.stiffness @ response, rtol=1e-7)
    x = np.array([0.2, 0.5])
    assert_allclose(held_leg_body.centreline(x).toarray(), section_twists(solid.mesh, x).toarray())


def test_solid_leg_equals_matrix_reduction():
    """Condensation slice by slice against that of the assembled matrices of one leg."""
    solid = meshed(LEG_1, 1, 3)
    condensed = static_superelement(held_solid_leg(clamped_leg(solid), solid.mesh)).matrices
    expected = static_superelement(held_leg(solid_leg_matrices(solid))).matrices
    assert scaled_difference(condensed.stiffness.toarray(), expected.stiffness.toarray()) < 1e-9
    assert scaled_difference(condensed.mass.toarray(), expected.mass.toarray()) < 1e-9
    x = np.array([0.2, 0.85])
    assert_allclose(
        condensed.centreline(x).toarray(), expected.centreline(x).toarray(), rtol=0.0, atol=1e-9
    )


# Positions (m) of the paper's robot; 3800 Hz is just above its twentieth frequency in all of them.
POSTURES, COUNT, HIGHEST = (0.145, 0.85), 20, 3800.0


@pytest.fixture(scope="module", params=["beam", "solid"])
def robots(request):
    """Return unreduced legs and legs with held ends, by name, and (x, robot, modes) by posture."""
    unreduced = {name: MODELS[request.param](leg) for name, leg in LEGS.items()}
    unreduced_robots = [solved(system_of(x, *unreduced.values())) for x in POSTURES]
    held_legs = {name: held_leg(leg) for name, leg in unreduced.items()}
    return (
        unreduced,
        held_legs,
        [
            (x, robot, modes(robot, COUNT))
            for x, robot in zip(POSTURES, unreduced_robots, strict=True)
        ],
    )


def reduced_to(held_legs, *frequencies):
    """Return legs reduced up to these frequencies (Hz), and a function x → robot of these legs."""
    reduced = {name: craig_bampton(leg, *frequencies) for name, leg in held_legs.items()}
    return reduced, lambda x: system_of(x, *(leg.matrices for leg in reduced.values()))


def test_reduced_robot_equals_unreduced_robot(robots):
    """Required: statics to 1e-9, twenty frequencies to 1e-4, mass-weighted MAC of 0.9999."""
    unreduced, held_legs, unreduced_robots = robots
    reduced, robot_at = reduced_to(held_legs, HIGHEST)
    for x, unreduced_robot, exact in unreduced_robots:
        robot = solved(robot_at(x))
        assert scaled_difference(compliance(robot), compliance(unreduced_robot)) < 1e-9
        approximate = modes(robot, COUNT)
        assert_allclose(approximate.frequencies, exact.frequencies, rtol=1e-4)
        # The mass-weighted product of two mass-normalised shapes is the root of their MAC; 46 kg is
        # the mass of the tool.
        tool, exact_tool = (
            solution.system.tool[:3] @ solved_modes.shapes
            for solution, solved_modes in ((robot, approximate), (unreduced_robot, exact))
        )
        gram = 46.0 * tool.T @ exact_tool
        for name, leg in unreduced.items():
            field = reduced[name].recover(robot.system.body_unknowns(name, approximate.shapes))
            gram += field.T @ (leg.mass @ unreduced_robot.system.body_unknowns(name, exact.shapes))
        assert np.min(np.diag(gram) ** 2) > 0.9999


@pytest.mark.parametrize("factor", [1.1, 2.5])
def test_frequency_bounds_enclose_truth(robots, factor):
    """Truth: the unreduced robot. Cut-offs of 1.1 and 2.5 times the highest frequency."""
    _, held_legs, unreduced_robots = robots
    reduced, robot_at = reduced_to(held_legs, HIGHEST, factor * HIGHEST)
    # Rounding error of the dense frequencies, 1e-12, with a margin.
    rounding = 1e-10
    for x, _, exact in unreduced_robots:
        bounds = frequency_bounds(robot_at(x), reduced, COUNT)
        assert np.all(bounds.lower <= exact.frequencies * (1.0 + rounding))
        assert np.all(exact.frequencies <= bounds.upper * (1.0 + rounding))
        error = bounds.upper / exact.frequencies - 1.0
        assert np.all(error <= bounds.relative_width + rounding)
        # A cut-off just above the highest frequency gives errors above 1e-4; the usual one gives
        # bounds that are close enough.
        if factor == 1.1:
            assert error.max() > 1e-4
        else:
            assert bounds.relative_width.max() < 2e-4


def test_low_cut_off_is_refused():
    """The cut-off must be above the highest frequency that is requested."""
    held_legs = {name: held_leg(MODELS["beam"](leg)) for name, leg in LEGS.items()}
    with pytest.raises(InputError, match=r"cut-off = 900 Hz: must be above .*, 1000 Hz"):
        reduced_to(held_legs, 1000.0, 900.0)
    with pytest.raises(InputError, match=r"highest frequency = -1\.0 Hz"):
        reduced_to(held_legs, -1.0)
    reduced, robot_at = reduced_to(held_legs, 400.0, 500.0)
    with pytest.raises(InputError, match=r"frequency 12 .* cut off at 500 Hz"):
        frequency_bounds(robot_at(0.4975), reduced, 12)
