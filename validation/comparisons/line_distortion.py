"""Distortion of the section in vibrating tapered legs: relative change of a beam frequency.

Input: a straight leg whose sections are boxes, tubes or I-sections, and one of its modes as a beam.
Output: the relative change of the frequency because inertia bends the walls (waves of 3-D
elasticity), and because walls that converge distort the section in torsion. Rule: no theory of
waves holds for a taper, but bending of the walls depends on the section at one position only.
Therefore it is computed for cantilever prisms. Each prism has the section at one position of the
leg, and the length at which its mode of the same kind and order has the frequency of the leg. The
change for the leg is the mean over its positions, weighted by kinetic energy. Two positions are
sufficient if the change is a quadratic function of the position.

Walls that bend at kinks lower a frequency as well. Only an upper bound of this is known
(`kinked_walls`), from the tension and the bending moments that the inertia of the mode causes.
Flanges of tapered I-sections raise torsional frequencies (`tapered_flanges`). This includes flanges
that bend because the torque varies along the leg. Waves of a prism include them, too. The change
for the leg is therefore that of the prisms less that of their flanges.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.polynomial import legendre

from fem.beams.beam_theory import CantileverFrequency, Kind, frequency_of_kind
from fem.beams.box_distortion import distortion_work
from fem.beams.kinked_walls import kink_works
from fem.beams.tapered_flanges import flange_work
from fem.sections.wall_frame import formula_frame_stiffness
from lumped.arrays import Array
from lumped.centre_line import straight_line
from lumped.legs import ConstantLeg, LineLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.models.bodies import clamped_modes
from lumped.sections import HollowRectangle, ISection, Tube
from validation.case import Skip
from validation.cases.leg_theory import WAVE_DIVISIONS, distortion, why_no_beam

# Sections with walls and two axes of symmetry. In those without walls, the change of frequencies
# that beam theory describes is below 0.1 %.
_WALLED = HollowRectangle | ISection | Tube
# Kinds of deformation by the largest translation or rotation of sections: about x, y, z.
_KINDS: tuple[Kind, ...] = ("tension", "bending z", "bending y", "torsion")
# Largest error of the change, relative, beyond half the difference of both prisms: 15 to 22 % of
# changes above 5 % in solids of seven tapered boxes, tubes and I-sections with one element across
# their walls. That of smaller changes is within the tolerance.
_WAVE_ERROR = 0.2
# Gauss points along a leg for energies of modes, a number exact for all modes that are compared.
_POINTS = 24
# Shortest and longest prism, relative to the leg.
_SHORTEST, _LONGEST = 0.1, 10.0


@dataclass(frozen=True, eq=False)
class _Mode:
    """Mode of a leg as a beam: kind, order and frequency (Hz), with samples along the leg.

    `positions` (n, in metres along the line) are points of a quadrature with `weights` (n, in
    metres). `twists` (n×6) are the mode shape and `energies` (n) the kinetic energy per length at
    these points; their scale is arbitrary.
    """

    kind: CantileverFrequency
    positions: Array
    weights: Array
    twists: Array
    energies: Array


def frequency_change(
    leg: LineLeg,
    beam: LegMatrices,
    index: int,
    frame_stiffness: Callable[[ConstantLeg], float] = formula_frame_stiffness,
) -> tuple[float, float]:
    """Relative change of frequency `index` (from 0) of the clamped `beam` due to distortion.

    The second result is its half-width: half the difference of the changes at the two positions,
    and a share of the change.

    Only boxes, tubes and I-sections along a straight line are computed. The result is zero for a
    curved leg and for any other section: solid sections hardly distort, and the waves of sections
    with walls are computed only if they have two axes of symmetry. Raises Skip if the mode lies
    above the frequencies at which beam theory applies to the section.
    `frame_stiffness` is a function that returns the stiffness (N) of a box against distortion.
    """
    walled = all(isinstance(section, _WALLED) for _, section in leg.stations)
    if not (leg.line.is_straight and walled):
        return 0.0, 0.0
    mode = _mode(leg, beam, index)
    shares = mode.weights * mode.energies
    shares /= shares.sum()
    mean = float(shares @ mode.positions)
    deviation = float(np.sqrt(shares @ (mode.positions - mean) ** 2))
    low, high = max(0.0, mean - deviation), min(leg.length, mean + deviation)
    changes = [_prism_change(leg, position, mode.kind) for position in (low, high)]
    change = float(np.mean(changes)) + _torsional_change(
        leg, mode, lambda torques: distortion_work(leg, torques, frame_stiffness)
    )
    return change, 0.5 * float(np.ptp(changes)) + _WAVE_ERROR * abs(change)


def kink_change(leg: LineLeg, beam: LegMatrices, index: int) -> float:
    """Lower bound (≤ 0) of the relative change of frequency `index` (from 0) by kinks of walls.

    The work of kinks is relative to the strain energy of the mode of the clamped `beam` (Rayleigh's
    quotient). Zero without kinks in walls of boxes and I-sections.
    """
    mode = _mode(leg, beam, index)
    along = leg.sections("timoshenko")
    masses = along.at(along.span_at(mode.positions), mode.positions).mass
    inertia = np.einsum("nij,nj->ni", masses, mode.twists).T
    moments = np.stack(
        [inertia[4] - mode.positions * inertia[2], inertia[5] + mode.positions * inertia[1]]
    )
    force_x, force_y, force_z, about_y, about_z = (
        _sum_towards_tip(leg, mode, density) for density in (*inertia[:3], *moments)
    )

    def resultants(position: float) -> Array:
        at = np.array([position])
        bending_y = about_y(at) + position * force_z(at)
        return np.array([force_x(at), bending_y, about_z(at) - position * force_y(at)])

    # The inertia of unit angular frequency deforms the leg by the twists over ω².
    strain = mode.weights @ mode.energies / (2.0 * np.pi * mode.kind.frequency) ** 2
    (work,) = kink_works(leg, resultants)
    return float((1.0 + work / strain) ** -0.5 - 1.0)


def flange_change(leg: LineLeg, beam: LegMatrices, index: int) -> float:
    """Relative change (≥ 0) of frequency `index` (from 0) by flanges of tapered I-sections.

    Zero for modes of the clamped `beam` that are not torsional.
    """
    return _torsional_change(
        leg, _mode(leg, beam, index), lambda torques: flange_work(leg, torques)
    )


def _mode(leg: LineLeg, beam: LegMatrices, index: int) -> _Mode:
    modes = clamped_modes(beam, index + 1)
    points, weights = legendre.leggauss(_POINTS)
    positions = 0.5 * leg.length * (points + 1.0)
    shapes = (beam.centreline(positions) @ modes.shapes).reshape(_POINTS, 6, -1)
    along = leg.sections("timoshenko")
    masses = along.at(along.span_at(positions), positions).mass
    energies = np.einsum("nim,nij,njm->nm", shapes, masses, shapes)
    own = np.einsum("n,nim,nii->im", weights, shapes**2, masses)[: len(_KINDS)]
    kinds = [_KINDS[row] for row in np.argmax(own, axis=0)]
    kind = CantileverFrequency(float(modes.frequencies[index]), kinds[index], kinds.count(
        kinds[index]
    ))  # fmt: skip
    return _Mode(
        kind, positions, 0.5 * leg.length * weights, shapes[..., index], energies[:, index]
    )


def _prism_change(leg: LineLeg, position: float, mode: CantileverFrequency) -> float:
    """Relative change of the frequency of `mode` by 3-D waves in a prism.

    The prism has the section of the leg at `position` (m along the line).
    """
    section, material = leg.section_at(position), leg.material

    def excess(length: float) -> float:
        prism = ConstantLeg(length, section, material)
        return frequency_of_kind(prism.timoshenko, length, mode.kind, mode.order) - mode.frequency

    bounds = _SHORTEST * leg.length, _LONGEST * leg.length
    prism = ConstantLeg(float(scipy.optimize.brentq(excess, *bounds)), section, material)
    if reason := why_no_beam(prism, mode):
        raise Skip(f"{mode.kind} mode {mode.order}, at {position:.4g} m: {reason}")
    change = float(distortion(prism, (WAVE_DIVISIONS,), mode)[0])
    return change - _prism_flange_change(prism, mode)


def _prism_flange_change(prism: ConstantLeg, mode: CantileverFrequency) -> float:
    """Relative change of the frequency of a `mode` by flanges of a prism that bend in torsion.

    The torque is T cos (n − ½)πx/L in mode n of a prism of length L. Zero for other modes, and
    for other sections than I-sections.
    """
    section, length = prism.section, float(prism.length)
    if mode.kind != "torsion" or not isinstance(section, ISection):
        return 0.0
    leg = LineLeg(straight_line(length), ((0.0, section), (length, section)), prism.material)
    number = (mode.order - 0.5) * np.pi / length
    work = flange_work(leg, lambda positions: np.cos(number * positions))
    strain = 0.5 * length / prism.timoshenko.GJ
    return float((1.0 + work / strain) ** -0.5 - 1.0)


def _torsional_change(
    leg: LineLeg, mode: _Mode, added_work: Callable[[Callable[[Array], Array]], float]
) -> float:
    """Relative change of a torsional frequency by a flexibility of tapers (Rayleigh's quotient).

    The torque on a section is due to the inertia of the part of the leg between it and the tip.
    `added_work` is a function that returns the work (J) that torques along the leg do on the
    flexibility. Zero for modes that are not torsional.
    """
    if mode.kind.kind != "torsion":
        return 0.0
    along = leg.sections("timoshenko")
    field = along.at(along.span_at(mode.positions), mode.positions)
    torques = _sum_towards_tip(leg, mode, field.mass[:, 3, 3] * mode.twists[:, 3])
    strain = mode.weights @ (torques(mode.positions) ** 2 * field.flexibility[:, 3, 3])
    return float((1.0 + added_work(torques) / strain) ** -0.5 - 1.0)


def _sum_towards_tip(leg: LineLeg, mode: _Mode, density: Array) -> Callable[[Array], Array]:
    """Function that returns the integrals (n) of a density from n positions to the tip.

    `density` (n, per m) is given at the positions of `mode`.
    """
    integral = legendre.Legendre.fit(
        mode.positions, density, _POINTS - 1, [0.0, leg.length]
    ).integ()
    return lambda positions: np.asarray(integral(leg.length) - integral(positions))
