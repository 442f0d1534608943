"""Guards of the pairing of modes: shapes whose MAC, partners and angle can be written down."""

import numpy as np

from fem.beams.beam import beam_leg
from lumped.legs import BeamProperties, ConstantLeg, Material
from lumped.models.cantilever import clamped_modes
from lumped.sections import Rectangle
from validation.agreement.differences import farthest_off
from validation.agreement.mode_pairing import (
    centreline_samples,
    centreline_weights,
    largest_angle,
    mac_matrix,
    pair_modes,
)
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import SECTION
from validation.context import Context

# Masses and inertias differ by powers of ten, as those of metres and radians do.
_WEIGHTS = np.array([2.0, 0.05, 7.0, 0.3])
_ANGLE = 0.4
_LEG = ConstantLeg(0.85, Rectangle(0.1, 0.16), Material.isotropic(2.1e11, 0.3, 7850.0))

cases = CaseGroup(
    section=SECTION, group="guard.pairing", unit="1", reference_kind="closed-form", effort=0.01
)


def _orthonormal() -> np.ndarray:
    """Four shapes (4×4), orthonormal in the product of the weights."""
    start = np.array([[1.0, 2, 0, 1], [0.5, -1, 1, 0], [2, 1, 1, -1], [0, 1, 3, 1]])
    orthogonal, _ = np.linalg.qr(np.sqrt(_WEIGHTS)[:, None] * start)
    return np.asarray(orthogonal / np.sqrt(_WEIGHTS)[:, None])


@cases.case(
    "guard.pairing.mac",
    "MAC of two shapes at a known angle in the product of the masses",
    quantity="difference of the MAC from cos² of the angle",
    citation="MAC = cos² of the angle in that product (Allemang and Brown, IMAC 1982)",
    tolerance=Absolute(1e-12),
    tolerance_reason="rounding",
)
def _mac(_context: Context) -> Measurement:
    shapes = _orthonormal()
    turned = 3.0 * (np.cos(_ANGLE) * shapes[:, 0] + np.sin(_ANGLE) * shapes[:, 1])
    found = mac_matrix(5.0 * shapes[:, :1], turned[:, None], _WEIGHTS)
    return Measurement(float(found[0, 0] - np.cos(_ANGLE) ** 2), 0.0, exact=True)


@cases.case(
    "guard.pairing.partners",
    "Modes in another order and with other signs find their partners",
    quantity="modes with a wrong partner",
    citation="a permutation of orthogonal shapes",
    tolerance=Absolute(0.5),
    tolerance_reason="a count: nothing but none will do",
)
def _partners(_context: Context) -> Measurement:
    shapes, order = _orthonormal(), np.array([2, 0, 3, 1])
    others = (shapes * np.array([-1.0, 2.0, -3.0, 0.5]))[:, order]
    found = pair_modes(shapes[:, :3], others, _WEIGHTS)
    wrong = np.sum(order[found.partner] != np.arange(3)) + np.sum(np.abs(found.mac - 1.0) > 1e-9)
    return Measurement(float(wrong), 0.0, exact=True)


def _sampled_beam() -> tuple[np.ndarray, np.ndarray]:
    """First modes of the clamped guards' leg at Gauss stations (k×m), and their weights (k)."""
    beam = beam_leg(_LEG.timoshenko, _LEG.length, 20)
    stations, lengths = centreline_samples(_LEG.length, 24)
    shapes = beam.centreline(stations) @ clamped_modes(beam, 6).shapes
    return np.asarray(shapes), centreline_weights(_LEG.timoshenko, lengths)


@cases.case(
    "guard.pairing.orthogonal",
    "Sampled modes of a clamped beam are orthogonal to each other",
    quantity="largest difference of the MAC between them from the unit matrix",
    citation="orthogonality of modes in the product of the masses, rotary inertia included",
    tolerance=Absolute(1e-7),
    tolerance_reason="24 Gauss stations integrate the first modes to 1e-4 and better, squared in "
    "MAC",
)
def _orthogonal(_context: Context) -> Measurement:
    shapes, weights = _sampled_beam()
    found = mac_matrix(shapes, shapes, weights)
    return farthest_off(found - np.eye(len(found)))


@cases.case(
    "guard.pairing.reversed",
    "Modes of a clamped beam find themselves in reversed order",
    quantity="modes with a wrong partner",
    citation="each is its own partner",
    tolerance=Absolute(0.5),
    tolerance_reason="a count: nothing but none will do",
)
def _reversed(_context: Context) -> Measurement:
    shapes, weights = _sampled_beam()
    found = pair_modes(shapes, shapes[:, ::-1], weights)
    return Measurement(float(np.sum(found.partner != np.arange(6)[::-1])), 0.0, exact=True)


@cases.case(
    "guard.pairing.angle",
    "The largest angle between two spaces of known angle",
    quantity="largest principal angle less the known one (rad)",
    unit="rad",
    citation="Bjorck and Golub, Math. Comp. 27 (1973) 579, in the product of the masses",
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding; angles are found to the root of it at worst",
)
def _angle(_context: Context) -> Measurement:
    shapes = _orthonormal()
    turned = np.cos(_ANGLE) * shapes[:, 1] + np.sin(_ANGLE) * shapes[:, 2]
    second = np.column_stack([turned + shapes[:, 0], turned - shapes[:, 0]])
    return Measurement(largest_angle(shapes[:, :2], second, _WEIGHTS) - _ANGLE, 0.0, exact=True)


@cases.case(
    "guard.pairing.span",
    "Two modes of a clamped beam, and the same with one leaning to a third: their spans' angle",
    quantity="largest principal angle less the known one (rad)",
    unit="rad",
    citation="modes of a beam are orthogonal in the product of its masses (Rayleigh)",
    tolerance=Absolute(1e-3),
    tolerance_reason="24 Gauss stations leave the first modes orthogonal to 3e-4",
)
def _span(_context: Context) -> Measurement:
    shapes, weights = _sampled_beam()
    unit = shapes / np.sqrt(weights @ np.square(shapes))
    # The third bends in the plane of the first.
    leaning = np.cos(_ANGLE) * unit[:, 0] + np.sin(_ANGLE) * unit[:, 2]
    second = np.column_stack([unit[:, 1], leaning])
    return Measurement(largest_angle(unit[:, :2], second, weights) - _ANGLE, 0.0, exact=True)


@cases.case(
    "guard.pairing.weights",
    "Weights on a centreline are the masses of a rigid leg",
    quantity="largest relative difference of m, ρJ L, ρIy L + m L²/3 and ρIz L + m L²/3",
    citation="kinetic energy of a prism in its rigid motions about the root",
    tolerance=Absolute(1e-12),
    tolerance_reason="Gauss stations integrate polynomials exactly",
)
def _weights(_context: Context) -> Measurement:
    beam: BeamProperties = _LEG.timoshenko
    stations, lengths = centreline_samples(_LEG.length, 24)
    twists = np.zeros((len(stations), 6, 4))
    twists[:, 0, 0] = 1.0
    twists[:, 3, 1] = 1.0
    twists[:, 4, 2], twists[:, 2, 2] = 1.0, -stations
    twists[:, 5, 3], twists[:, 1, 3] = 1.0, stations
    motions = twists.reshape(-1, 4)
    found = centreline_weights(beam, lengths) @ np.square(motions)
    mass, swing = beam.mu * _LEG.length, beam.mu * _LEG.length**3 / 3.0
    section = _LEG.section
    inertia = [
        _LEG.material.rho * i * _LEG.length
        for i in (
            section.second_moment_y + section.second_moment_z,
            section.second_moment_y,
            section.second_moment_z,
        )
    ]
    wanted = np.array([mass, inertia[0], inertia[1] + swing, inertia[2] + swing])
    return farthest_off(found / wanted - 1.0)
