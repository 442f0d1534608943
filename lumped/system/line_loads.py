"""Loads along a leg, and the wrenches on its ends that represent them."""

import numpy as np

from lumped.arrays import Array, distinct
from lumped.beam_properties import BeamProperties
from lumped.line_sections import TOGETHER, LineSections, cumulative, gauss_points
from lumped.mechanism.kinematics.accelerations import Motion
from lumped.mechanism.load import LineLoad
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
