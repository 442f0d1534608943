"""Errors of the whole displacement against sampled forces; pairing of modes."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from fem.beams.beam import beam_leg
from lumped.acceptance.quantities import ANY_FORCE, UNIT_LOADS
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import clamped_modes
from lumped.sections import Rectangle
from validation.responses.displacement import FLOOR, relative, sizes, worst_force
from validation.responses.mode_pairing import (
    centreline_samples,
    centreline_weights,
    mac_matrix,
    pair_modes,
    sampled_modes,
)
from validation.responses.statics_and_modes import Statics


def fraction(difference: Array, reference: Array, forces: Array) -> Array:
    """Relative errors |D f| / max(|C f|, s/20) under unit forces f along the columns of `forces`.

    D is the difference, C the reference, s its largest compliance."""
    force = forces / np.linalg.norm(forces, axis=0)
    lengths = np.linalg.norm(reference @ force, axis=0)
    floor = FLOOR * np.linalg.norm(reference, 2)
    return np.linalg.norm(difference @ force, axis=0) / np.maximum(lengths, floor)


def statics(compliances: Array) -> Statics:
    """Statics of a robot without loads."""
    return Statics(compliances, np.zeros((len(compliances), 0, 6)))


def compliance(rng: np.random.Generator, yields: Array) -> Array:
    """Compliance (3×3) with the principal values `yields` along random axes."""
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.asarray(axes * yields @ axes.T)


@pytest.mark.parametrize("seed", range(6))
def test_worst_force_matches_direct_search(seed: int) -> None:
    """Largest relative error over 8000 random directions, improved by Nelder–Mead."""
    rng = np.random.default_rng([24, seed])
    # From one direction that alone yields to a reference that is singular.
    yields = 10.0 ** -rng.uniform(0.0, 3.0, 3) * 1e-8
    yields[: rng.integers(0, 3)] *= rng.choice([1.0, 0.0])
    reference = compliance(rng, yields)
    difference = 10.0 ** rng.uniform(-12.0, -8.0) * rng.normal(size=(3, 3))
    if seed % 3 == 0:
        difference = compliance(rng, yields) - reference
    worst = worst_force(difference[None], reference[None])
    assert np.linalg.norm(worst.force[0]) == pytest.approx(1.0)
    error_at_force = fraction(difference, reference, worst.force.T)
    assert error_at_force == pytest.approx(worst.error, rel=1e-9)
    # Neither above what the sphere has nor below it: climbed to from the best of many directions.
    forces = rng.normal(size=(3, 8000))
    climbed = max(
        -minimize(
            lambda force: -fraction(difference, reference, force[:, None])[0],
            forces[:, start],
            method="Nelder-Mead",
            options={"xatol": 1e-10, "fatol": 1e-12},
        ).fun
        for start in np.argsort(fraction(difference, reference, forces))[-6:]
    )
    # The search ends at 3e-7, elsewhere by each kernel of OpenBLAS.
    assert worst.error[0] == pytest.approx(climbed, rel=5e-6)


def test_stiff_direction_is_not_the_worst() -> None:
    """Errors of 3 % along x and 1000 % along the stiff z: the worst force has 3.6 %."""
    reference, difference = np.diag([1.0, 1.0, 1e-4]), np.diag([0.03, 0.0, 1e-3])
    worst = worst_force(difference[None], reference[None])
    # Along z alone ten times too soft: 2 % of a twentieth. The worst force has both errors in it.
    assert worst.error[0] == pytest.approx(np.hypot(0.03, 0.02), rel=1e-3)
    assert np.abs(worst.force[0]) == pytest.approx([0.05, 0.0, 1.0], abs=2e-3)
    # Along that force it is off by (0.03/400 + 1e-3)/(1 + 1/400), of the same twentieth.
    matrices = np.zeros((2, 1, 6, 6))
    matrices[:, 0, :3, :3] = difference, reference
    assert relative(*map(statics, matrices), ANY_FORCE).along == pytest.approx(0.0214, rel=0.01)


def test_error_has_norm_and_signed_component() -> None:
    """The size of an error is a norm; its component along the load has a sign."""
    rng = np.random.default_rng(7)
    exact, other = (
        factors @ np.swapaxes(factors, 1, 2) for factors in rng.normal(size=(2, 3, 6, 6))
    )
    errors = sizes(statics(other - exact), statics(exact))
    for k, quantity in enumerate(UNIT_LOADS[:6]):
        rows = slice(3) if k < 3 else slice(3, 6)
        due, displaced = exact[:, rows, k], other[:, rows, k]
        plain = np.linalg.norm(displaced - due, axis=1) / np.linalg.norm(due, axis=1)
        assert errors[:, k] == pytest.approx(plain, rel=1e-12)
        along = relative(statics(other - exact), statics(exact), quantity).along
        assert along == pytest.approx(other[:, k, k] / exact[:, k, k] - 1.0, rel=1e-12)
    # No axis is worse than the worst direction: here every direction yields more than the floor.
    assert (errors[:, 6] >= errors[:, :3].max(axis=1) * (1.0 - 1e-9)).all()
    assert UNIT_LOADS[6] == ANY_FORCE


def test_rigid_reference_gives_infinite_error() -> None:
    """A model that yields where the reference is rigid; zero relative to zero is no error."""
    reference, rigid, yielding = (statics(compliances) for compliances in np.zeros((3, 2, 6, 6)))
    reference.compliances[:, 0, 0] = 1e-8
    yielding.compliances[1, 1, 1] = 1e-9
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not sizes(rigid, reference).any()
        alone, everywhere = sizes(yielding, reference), sizes(yielding, rigid)
    assert alone[1] == pytest.approx([0.0, np.inf, 0.0, 0.0, 0.0, 0.0, 2.0], rel=1e-9)
    assert everywhere[1, 6] == np.inf
    assert not everywhere[0].any()


def test_clamped_beam_modes_are_paired():
    """Shapes are compared by the mass matrix, which includes rotary inertia (Rayleigh beam)."""
    leg = ConstantLeg(0.85, Rectangle(0.1, 0.16), Material.isotropic(2.1e11, 0.3, 7850.0))
    beam = beam_leg(leg.timoshenko, leg.length, 20)
    stations, lengths = centreline_samples(leg.length, 24)
    modes = clamped_modes(beam, 6)
    shapes = beam.centreline(stations) @ modes.shapes
    weights = centreline_weights(leg.timoshenko, lengths)
    per_station = weights.reshape(-1, 6)
    assert_allclose(per_station[:, 1].sum(), leg.mass)
    assert_allclose(per_station[:, 3].sum(), leg.timoshenko.rho_J * 0.85)
    # Gauss stations integrate the first modes to 1e-4 and better, squared in MAC.
    root = np.sqrt(weights)[:, None]
    sampled = sampled_modes(modes.frequencies, root * shapes)
    assert_allclose(
        mac_matrix(sampled, sampled_modes(modes.frequencies, -3.0 * root * shapes)),
        np.eye(6),
        atol=1e-7,
    )
    reversed_order = sampled_modes(modes.frequencies, root * shapes[:, ::-1])
    assert pair_modes(sampled, reversed_order).partner.tolist() == [5, 4, 3, 2, 1, 0]
