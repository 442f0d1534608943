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
from scipy.linalg import block_diag

from lumped.arrays import Array
from lumped.legs import BeamProperties
from validation.case import Allowance, Relative
from validation.studies.ritz.leg import sampled

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
    weights, values, _ = sampled(length, degree)
    squares = (values.T * weights) @ values
    of_unit = legendre.legder(np.eye(degree + 1))
    ends = np.zeros((degree + 1, degree + 1))
    for end in (-1.0, 1.0):
        slope = legendre.legval(end, of_unit) * 2.0 / length
        outward = end * np.outer(legendre.legvander(end, degree), slope)
        ends += 0.5 * (outward + outward.T)
    inertias = (beam.mu, beam.mu, beam.mu, beam.rho_J, beam.rho_Iy, beam.rho_Iz)
    rods = (0.0, 0.0, 0.0, 0.0, beam.mu, beam.mu)
    against = (
        beam.EA,
        beam.GAy,
        beam.GAz,
        beam.GJ,
        12.0 * beam.EIy / h**2 + beam.GAz,
        12.0 * beam.EIz / h**2 + beam.GAy,
    )
    kinetic = (m * ends - rod * squares for m, rod in zip(inertias, rods, strict=True))
    strain = (m**2 / k * squares for m, k in zip(inertias, against, strict=True))
    return h**2 / 12.0 * block_diag(*kinetic), h**2 / 12.0 * block_diag(*strain)
