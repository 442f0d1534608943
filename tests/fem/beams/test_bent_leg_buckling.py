"""Buckling of bent, curved, stepped and tapered legs, against closed forms and straight legs."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from support.robots.paper_legs import STEEL

from fem.beams.prestressed import prestressed_leg, prestressed_line_leg
from lumped.arrays import dense
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg
from lumped.screws import shift, turn
from lumped.sections import Circle, Rectangle

ALL, UP = 10_000, (0.0, 0.0, 1.0)


def prestressed(line, *stations, elements=8, theory="euler-bernoulli"):
    """Return a prestressed leg with sections at shares of a line."""
    placed = tuple((share * line.length, section) for share, section in stations)
    leg = LineLeg(line, placed, STEEL)
    return prestressed_line_leg(leg.sections(theory), elements, ALL)


def factors(leg, motions, forces):
    """Return the buckling factors of both signs of end forces on a leg.

    The columns of `motions` (12×k) are the free motions of its ends.
    """
    stiffness, inner = dense(leg.matrices.stiffness), len(dense(leg.matrices.stiffness)) - 12
    basis = np.zeros((12 + inner, motions.shape[1] + inner))
    basis[:12, : motions.shape[1]] = motions
    basis[12:, motions.shape[1] :] = np.eye(inner)
    added = leg.geometric_stiffness(forces, np.zeros(12))
    values = eigh(basis.T @ added @ basis, basis.T @ stiffness @ basis, eigvals_only=True)
    return -1.0 / values[0], -1.0 / values[-1]


def arc(radius, angle):
    """Return an arc with the x axis as its chord, which bulges along y."""
    half = angle / 2.0
    chord, rise = 2.0 * radius * np.sin(half), radius * (1.0 - np.cos(half))
    piece = LinePiece((0.0, 0.0, 0.0), (chord, 0.0, 0.0), (chord / 2.0, rise, 0.0))
    return CentreLine((piece,), UP)


@pytest.mark.parametrize("degrees", [20.0, 90.0, 150.0])
def test_arc_in_bending_buckles_laterally(degrees):
    """M = √(((B − C)/2R)² + BC π²/R²α²) ± (B + C)/2R, B = EIy, C = GJ (Timoshenko & Gere).

    The ends cannot twist about the tangents. Moments that straighten the arc and those that bend it
    further have different factors. Winkler's bar has B (1 + b²/12R²) for the width b.
    """
    radius, angle, section = 1.0, np.radians(degrees), Rectangle(0.05, 0.002)
    leg = prestressed(arc(radius, angle), (0.0, section), (1.0, section))
    line = leg.sections.line
    at_root, at_tip = line.frames(np.array([0.0, line.length]))[1]
    # About the radial axes and z at both ends, and along the chord at the tip.
    motions = np.zeros((12, 5))
    motions[3:6, :2], motions[9:, 2:4], motions[6, 4] = at_root[:, 1:], at_tip[:, 1:], 1.0
    moments = np.zeros(12)
    moments[[5, 11]] = -1.0, 1.0
    p = ConstantLeg(1.0, section, STEEL).properties("euler-bernoulli")
    b, c = p.EIy * (1.0 + section.width**2 / 12.0 / radius**2), p.GJ
    root = np.sqrt(((b - c) / 2.0) ** 2 + b * c * (np.pi / angle) ** 2) / radius
    mean = (b + c) / (2.0 * radius)
    # Discretisation error of 8 elements: 4e-5 at most.
    sizes = sorted(map(abs, factors(leg, motions, moments)))
    assert sizes == pytest.approx([root - mean, root + mean], rel=5e-5)


def test_column_with_arm_has_euler_load():
    """A clamped column of length H carries an arm, with the load P along the column on its end.

    The arm rotates with the top and does not lower P by the square of this angle, whatever its
    length: P = π²EI/4H².
    """
    height, section = 1.0, Rectangle(0.01, 0.1)
    for arm in (0.2, 0.6):
        chord = np.hypot(height, arm)
        corner = (height**2 / chord, height * arm / chord, 0.0)
        pieces = LinePiece((0.0, 0.0, 0.0), corner), LinePiece(corner, (chord, 0.0, 0.0))
        line = CentreLine(pieces, UP)
        leg = prestressed(line, (0.0, section), (1.0, section))
        force = np.append(-np.array(corner) / height, np.zeros(3))
        root = -shift(np.array([chord, 0.0, 0.0])).T @ force
        load, _ = factors(leg, np.eye(12)[:, 6:], np.append(root, force))
        euler = np.pi**2 * STEEL.E * section.second_moment_z / (4.0 * height**2)
        assert load == pytest.approx(euler, rel=1e-4)


def test_arc_buckles_as_polygon_of_prisms():
    """An arc under a force along its chord, out of plane and in it, against straight legs.

    Prisms on chords of the arc, joined at their ends, approach it with the square of their length.
    """
    radius, angle, section = 0.8, np.radians(120.0), Rectangle(0.05, 0.03)
    line = arc(radius, angle)
    forces = np.zeros(12)
    forces[[0, 6]] = 1.0, -1.0
    pinned = np.eye(12)[:, [4, 5, 6, 10, 11]]
    leg = prestressed(line, (0.0, section), (1.0, section), theory="timoshenko")
    expected, _ = factors(leg, pinned, forces)
    first, second = [polygon_factor(line, section, count, pinned) for count in (6, 12)]
    assert second == pytest.approx(expected, rel=0.01)
    assert second + (second - first) / 3.0 == pytest.approx(expected, rel=5e-4)


def polygon_factor(line, section, count, motions):
    """Return the buckling factor under a unit force along the chord, by prisms on a polygon."""
    nodes, _ = line.frames(np.linspace(0.0, line.length, count + 1))
    length = float(np.linalg.norm(nodes[1] - nodes[0]))
    p = ConstantLeg(length, section, STEEL).timoshenko
    prism = prestressed_leg(p, length, 1, ALL)
    inner = len(dense(prism.matrices.stiffness)) - 12
    size = 6 * (count + 1) + inner * count
    stiffness, added = np.zeros((size, size)), np.zeros((size, size))
    for number, (start, end) in enumerate(pairwise(nodes)):
        along = (end - start) / length
        axes = np.column_stack([along, np.cross(UP, along), UP])
        to_leg = np.zeros((12 + inner, size))
        for side in (0, 1):
            rows = slice(6 * side, 6 * side + 6)
            to_leg[rows, 6 * (number + side) : 6 * (number + side) + 6] = turn(axes).T
        inside = 6 * (count + 1) + inner * number
        to_leg[12:, inside : inside + inner] = np.eye(inner)
        # The force on the tip, seen at both ends.
        force = np.array([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        at_end, at_start = (shift(nodes[-1] - point).T @ force for point in (end, start))
        ends = np.concatenate([turn(axes).T @ -at_start, turn(axes).T @ at_end])
        stiffness += to_leg.T @ dense(prism.matrices.stiffness) @ to_leg
        added += to_leg.T @ prism.geometric_stiffness(ends, np.zeros(12)) @ to_leg
    order = np.r_[:6, 6 * count : 6 * count + 6, 6 : 6 * count, 6 * (count + 1) : size]
    basis = np.zeros((size, motions.shape[1] + size - 12))
    basis[order[:12], : motions.shape[1]] = motions
    basis[order[12:], motions.shape[1] :] = np.eye(size - 12)
    values = eigh(basis.T @ added @ basis, basis.T @ stiffness @ basis, eigvals_only=True)
    return float(-1.0 / values[0])


def test_rotated_bent_leg_only_turns_its_forces():
    """The geometric stiffness maps a rigid rotation θ to the change of the end forces, θ × f.

    Moments that do work on rotation vectors change by ½ θ × m.
    """
    line = arc(0.8, np.radians(120.0))
    leg = prestressed(line, (0.0, Rectangle(0.05, 0.03)), (1.0, Rectangle(0.03, 0.02)))
    force = np.array([2.0, -3.0, 1.5, 0.4, 0.3, -0.2])
    tip = np.array([line.chord, 0.0, 0.0])
    ends = np.append(-shift(tip).T @ force, force)
    stiffness = leg.geometric_stiffness(ends, np.zeros(12))
    for theta in np.eye(3):
        rigid = np.concatenate([np.zeros(3), theta, np.cross(theta, tip), theta])
        turned = stiffness[:, :12] @ rigid
        expected = np.cross(theta, ends.reshape(4, 3)).ravel()
        expected[3:6] *= 0.5
        expected[9:] *= 0.5
        assert turned[:12] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("ratio", [0.25, 0.5])
def test_stepped_column_load_is_closed_form(ratio):
    """tan k₁l₁ tan k₂l₂ = k₂/k₁, k = √(P/EI), l₁ at the root (Timoshenko & Gere)."""
    thick, thin, lower = Rectangle(0.04, 0.02), Rectangle(0.04, 0.02 * ratio ** (1 / 3)), 0.4
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), UP)
    leg = prestressed(line, (0.0, thick), (lower, thick), (lower, thin), (1.0, thin))

    def condition(load):
        k1, k2 = (np.sqrt(load / (STEEL.E * s.second_moment_y)) for s in (thick, thin))
        first, second = k1 * lower, k2 * (1.0 - lower)
        return k1 * np.sin(first) * np.sin(second) - k2 * np.cos(first) * np.cos(second)

    euler = np.pi**2 * STEEL.E * thin.second_moment_y / 4.0
    expected = brentq(condition, 0.5 * euler, euler / ratio)
    forces = np.zeros(12)
    forces[[0, 6]] = 1.0, -1.0
    assert factors(leg, np.eye(12)[:, 6:], forces)[0] == pytest.approx(expected, rel=1e-5)


def test_conical_column_load_is_closed_form():
    """EI (x/b)⁴ v″ + P v = 0 from the apex x = 0 of the cone (Timoshenko & Gere, tapered bars).

    The deflection v = x sin(β/a − β/x) from the line of the load, β² = Pb⁴/EI, is zero at the top,
    x = a. At the root, x = b, v′ = 0: tan φ = −β/b = −φ a/(b − a) for φ = β/a − β/b.
    """
    diameter, length, share = 0.02, 1.0, 0.5
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), UP)
    leg = prestressed(line, (0.0, Circle(diameter)), (1.0, Circle(share * diameter)))
    root = length / (1.0 - share)
    top = share * root
    lever = top / length
    phase = brentq(lambda p: np.sin(p) + p * lever * np.cos(p), np.pi / 2.0, np.pi)
    beta = phase * top * root / length
    expected = STEEL.E * Circle(diameter).second_moment_y * beta**2 / root**4
    forces = np.zeros(12)
    forces[[0, 6]] = 1.0, -1.0
    # Discretisation error of 8 elements: 2e-5.
    assert factors(leg, np.eye(12)[:, 6:], forces)[0] == pytest.approx(expected, rel=4e-5)
