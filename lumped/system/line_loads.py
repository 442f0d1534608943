"""Loads along a leg, the wrenches on its ends that represent them, and those in its sections.

The wrench in a section follows from equilibrium of the part of the leg before it. It does not
depend on the stiffness of the leg, and is the same for straight, bent and curved legs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, distinct
from lumped.beam_properties import BeamProperties
from lumped.centre_line import CentreLine
from lumped.line_sections import TOGETHER, LineSections, cumulative, gauss_points
from lumped.mechanism.kinematics.accelerations import Motion
from lumped.mechanism.load import DistributedLoad, LineLoad
from lumped.screws import shift

_ALONG = np.array([1.0, 0.0, 0.0])
# Number of elements in each span: they halve a taper within the reach of one quadrature.
_HALVINGS = 4


def end_wrenches(sections: LineSections, load: LineLoad) -> Array:
    """Wrenches (2×6, leg axes) on root and tip of a leg that represent a load along it.

    They are opposite to the reactions of clamped ends, so that displacements of the ends are exact
    for every taper, step, corner and arc. If only the root is clamped, the section at s carries the
    wrench W(s) of the part of the load beyond s. The tip then moves by ∫ X F Xᵀ W ds, as in
    `lumped.line_sections`. The wrench on the tip causes the same displacement as the load. The
    wrench on the root follows from equilibrium.
    """
    tip = sections.line.chord * _ALONG
    halved = sections.edges(_HALVINGS * (len(sections.ends) - 1))
    edges = np.union1d(halved, np.clip([load.start, load.stop], 0.0, sections.ends[-1]))
    edges = distinct(edges, TOGETHER * sections.ends[-1])
    lengths, middles = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    points, weights = gauss_points()
    stations = middles[:, None] + 0.5 * lengths[:, None] * points
    per_length = load.per_length(stations.ravel()).reshape(*stations.shape, 6)
    per_length[(middles < load.start) | (middles > load.stop)] = 0.0
    field = sections.along(edges)
    to_tip = shift(tip - field.points)
    at_tip = np.einsum("egji,egj->egi", shift(field.points - tip), per_length)
    integral = 0.5 * lengths[:, None] * weights
    of_elements = np.einsum("eg,egi->ei", integral, at_tip)
    before = np.cumsum(of_elements, axis=0) - of_elements
    total = of_elements.sum(axis=0)
    beyond = total - before[:, None] - cumulative(at_tip, lengths)
    strained = np.einsum("egij,egkj,egk->egi", field.flexibility, to_tip, beyond)
    displacement = np.einsum("eg,egij,egj->i", integral, to_tip, strained)
    on_tip = np.linalg.solve(sections.tip_compliance, displacement)
    return np.array([shift(tip).T @ (total - on_tip), on_tip])


def section_wrenches(
    line: CentreLine,
    root: Array,
    loads: Sequence[DistributedLoad],
    stations: Array,
    points: Array,
) -> Array:
    """Wrenches (s×6, leg axes) that sections transmit at s `stations` (m along the line) of a leg.

    Each is the wrench of the part of the leg beyond the section on the part before it, referred to
    the section's point. `points` (s×3, in m) are these points. `root` (6, leg axes) is the wrench
    on the root of the leg, `loads` are the loads along it. Integrals of loads are exact on straight
    pieces and for loads that are polynomials of degree 22 between two stations.
    """
    stations = np.clip(stations, 0.0, line.length)
    ends = [end for load in loads for end in (load.start, load.stop)]
    edges = np.unique(np.clip([0.0, *line.ends, *ends, *stations], 0.0, line.length))
    middles, halves = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    coordinates, weights = gauss_points()
    positions = middles[:, None] + halves[:, None] * coordinates
    applied = np.zeros((*positions.shape, 6))
    for load in loads:
        inside = (middles > load.start) & (middles < load.stop)
        per_length = load.per_length(positions[inside].ravel())
        applied[inside] += per_length.reshape(-1, *applied.shape[1:])
    pieces = np.repeat(line.piece_at(middles), len(coordinates))
    places = line.frames(positions.ravel(), pieces)[0].reshape(*positions.shape, 3)
    at_root = np.einsum("egji,egj->egi", shift(places), applied)
    sums = np.cumsum(np.einsum("e,g,egi->ei", halves, weights, at_root), axis=0)
    before = np.vstack([np.zeros(6), sums])[np.searchsorted(edges, stations)]
    return np.asarray(-np.einsum("sji,sj->si", shift(-points), root + before))


@dataclass(frozen=True, eq=False)
class InertiaLoad:
    """Inertia forces and weight of a leg with `sections` along a line, which moves as a rigid body.

    `motion` is the motion of the leg in leg axes, with its origin at the root. The acceleration of
    gravity is subtracted from its linear acceleration.
    """

    sections: LineSections
    motion: Motion

    @property
    def start(self) -> float:
        """Position (m along the line) at which the load begins: the root."""
        return 0.0

    @property
    def stop(self) -> float:
        """Position (m along the line) at which the load ends: the tip."""
        return self.sections.line.length

    def per_length(self, stations: Array) -> Array:
        """Forces and moments per length (s×6, leg axes) at s `stations` (m) on the line.

        By Newton and Euler with the mass matrix M of a section about its point of the line, the
        first moment S of its mass, and its moments of inertia J:

            −M a − (ω × (ω × S), ω × J ω)
        """
        field = self.sections.at(self.sections.span_at(stations), stations)
        turning = self.motion.angular_acceleration
        motions = [np.append(self.motion.acceleration_at(point), turning) for point in field.points]
        load = -np.einsum("sij,sj->si", field.mass, motions)
        spin = self.motion.angular_velocity
        if spin.any():
            moments = field.mass[:, [5, 3, 4], [1, 2, 0]]
            load[:, :3] -= np.cross(spin, np.cross(spin, moments))
            load[:, 3:] -= np.cross(spin, field.mass[:, 3:, 3:] @ spin)
        return np.asarray(load)


def spread_load(sections: LineSections, at_ends: Array) -> DistributedLoad:
    """Load along a leg from wrenches on its ends.

    It has the resultant force and moment of the wrenches `at_ends` (12, in N and N m, leg axes) on
    root and tip together. Along a straight leg it varies linearly, see `linear_load`. Along a bent
    leg it is the inertia of a rigid motion of the leg.
    """
    if sections.line.is_straight:
        return linear_load(at_ends[:6], at_ends[6:], sections.line.chord)
    tip = sections.line.chord * _ALONG
    total = at_ends[:6] + shift(tip).T @ at_ends[6:]
    (mass,) = sections.masses(sections.ends[[0, -1]], np.zeros((1, 3)))
    linear, turning = np.split(np.linalg.solve(mass, -total), 2)
    return InertiaLoad(sections, Motion(linear, turning, np.zeros(3)))


def inertia_load(properties: BeamProperties, length: float, motion: Motion) -> LineLoad:
    """Inertia forces and weight per length of a uniform leg that moves as a rigid body.

    `motion` is the motion of the leg in leg axes, with its origin at the root. The acceleration of
    gravity is subtracted from its linear acceleration.
    """
    rotary = np.diag([properties.rho_J, properties.rho_Iy, properties.rho_Iz])
    rotary[1, 2] = rotary[2, 1] = -properties.rho_Iyz
    spin = motion.angular_velocity
    couple = -rotary @ motion.angular_acceleration - np.cross(spin, rotary @ spin)
    centre = np.array([0.0, properties.mass_y, properties.mass_z])

    def per_length(arm: Array) -> Array:
        force = -properties.mu * motion.acceleration_at(arm + centre)
        moment = -properties.mu * np.cross(centre, motion.acceleration_at(arm))
        return np.append(force, couple + moment)

    return LineLoad(0.0, length, per_length(np.zeros(3)), per_length(length * _ALONG))


def linear_load(root: Array, tip: Array, length: float) -> LineLoad:
    """Load along a leg that varies linearly, from wrenches on its ends.

    `root` and `tip` (6 each, in N and N m, leg axes) are the wrenches. The load has the resultant
    force and moment of both together. Its axial force and torque are also divided between the two
    ends in the same way as those of the wrenches.
    """
    first, last = 2.0 * (2.0 * root - tip) / length, 2.0 * (2.0 * tip - root) / length
    total = root + tip
    # Moments define the position of transverse forces; that of a force along z about y is negative.
    for across, about, sign in ((1, 5, 1.0), (2, 4, -1.0)):
        lever = sign * total[about] + length * tip[across]
        last[across] = 6.0 * lever / length**2 - 2.0 * total[across] / length
        first[across] = 2.0 * total[across] / length - last[across]
        first[about] = last[about] = 0.0
    return LineLoad(0.0, length, first, last)
