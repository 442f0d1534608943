"""What rigid segments leave out of a beam's energies, to second order in their length h.

Their springs are exact in statics, so that a chain of them is a beam whose inertia acts at the
segments' centres. That takes from both energies of a mode with twists q along a leg:

kinetic  a rigid segment moves like its centre, q, the beam like q + q's + ½ q''s². By Euler's
         summation the beam has h²/12 (½ [m (q²)'] between the ends, less ∫ μ (φy² + φz²) dx, the
         rotary inertia of segments as rods) more, m = (μ, μ, μ, ρJ, ρIy, ρIz);
strain   inertia between two centres, ω² m q, bends no piece of a chain. The beam has
         h²/12 ∫ (ω² m q)²/k dx more, h³/12k the give of a piece clamped at both: k is EA, κGA and
         GJ, and 12 EI/h² + κGA against moments that bend.
"""

import numpy as np
from numpy.polynomial import legendre

from lumped.arrays import Array
from lumped.legs import BeamProperties
from validation.case import Allowance, Relative
from validation.studies.ritz.leg import fields, inertias

# Of what is left of a frequency in 20 segments.
TOLERANCE = Relative(1e-3)
REASON = "fourth order in 1/n: about the square of what the second explains, 2e-4 where that is 1 %"


def explained(amount: float) -> Allowance:
    """Of a frequency (Hz) in segments beside that of beams."""
    return Allowance(
        "inertia at the centres of rigid segments",
        float(amount),
        "both energies of polynomial modes, second order in 1/n (validation.studies.ritz.segments)",
    )


def left_out(
    beam: BeamProperties, length: float, segments: int, degree: int
) -> tuple[Array, Array]:
    """Twice the kinetic energy, and twice the strain energy over ω⁴, on coefficients of `of_beam`.

    Both n×n, SI: what the beam has more than so many segments.
    """
    h = length / segments
    points, weights = legendre.leggauss(degree + 2)
    weights = 0.5 * length * weights
    q, _ = fields(beam, length, points, degree)
    squares = np.array([(one.T * weights) @ one for one in q])
    at_ends, slopes = fields(beam, length, np.array([-1.0, 1.0]), degree)
    # ½ m (q²)' at the tip less that at the root, symmetric.
    outward = np.einsum("epi,p,epj->eij", at_ends, np.array([-1.0, 1.0]), slopes)
    outward = 0.5 * (outward + np.swapaxes(outward, 1, 2))
    against = (
        beam.EA,
        beam.GAy,
        beam.GAz,
        beam.GJ,
        12.0 * beam.EIy / h**2 + beam.GAz,
        12.0 * beam.EIz / h**2 + beam.GAy,
    )
    along = np.array(inertias(beam))
    kinetic = np.tensordot(along, outward, 1) - beam.mu * squares[4:].sum(axis=0)
    strain = np.tensordot(along**2 / np.array(against), squares, 1)
    return h**2 / 12.0 * kinetic, h**2 / 12.0 * strain
