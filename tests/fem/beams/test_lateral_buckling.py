"""Lateral buckling of legs with shear against closed forms, equilibrium and solids."""

import re
import shutil
import subprocess
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.integrate import solve_bvp, solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq
from support.robots.paper_legs import STEEL

from fem.beams.prestressed import PrestressedLeg, prestressed_leg
from fem.calculix.run import PROGRAMS, calculix_program
from lumped.arrays import Array, dense
from lumped.beam_properties import BeamProperties
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle

ALL = 10_000
NOTHING = np.zeros(12)
# Free unknowns of root (0–5) and tip (6–11) with fork supports: rotations about y and z at both
# ends, and displacement along x at the tip.
FORKS = (4, 5, 6, 10, 11)
BENT = np.array([0, 0, 0, 0, -1.0, 0, 0, 0, 0, 0, 1.0, 0])


def factor(leg: PrestressedLeg, ends, forces, spread=NOTHING) -> float:
    """Return the buckling factor of the end forces on a leg with the free unknowns `ends`."""
    stiffness = dense(leg.matrices.stiffness)
    free = np.ix_(*2 * [[*ends, *range(12, len(stiffness))]])
    added = leg.geometric_stiffness(forces, spread)
    return float(-1.0 / eigh(added[free], stiffness[free], eigvals_only=True)[0])


def moment_of_solid(leg: ConstantLeg, degree: int) -> float:
    """Return the lateral buckling moment (N m) of a solid bar with ν = 0 between forks, by Ritz.

    The displacements are U cos kx, V sin kx, W sin kx with k = π/L and polynomials U, V, W of y and
    z up to `degree`, with Green's strains under the stress z/Iy: no beam theory, and every section
    may warp and distort.
    """
    section, k, material = leg.section, np.pi / leg.length, leg.material
    points, weights = legendre.leggauss(degree + 3)
    values = legendre.legvander(points, degree)
    slopes = legendre.legval(points, legendre.legder(np.eye(degree + 1))).T
    sides = 0.5 * np.array([section.width, section.height])
    weight = np.outer(weights, weights).ravel() * sides.prod()
    fields = np.zeros((3, 3, len(weight), 0))
    for component, (i, j) in product(range(3), product(range(degree + 1), repeat=2)):
        # Lateral bending and twist: V is even in y, U and W are odd.
        if i + j > degree + 1 or (component == 1) != (i % 2 == 0):
            continue
        column = np.zeros((3, 3, len(weight), 1))
        for order, (y, z, scale) in enumerate(
            ((values, values, 1.0), (slopes, values, sides[0]), (values, slopes, sides[1]))
        ):
            column[component, order, :, 0] = np.outer(y[:, i], z[:, j]).ravel() / scale
        fields = np.concatenate([fields, column], axis=3)
    (u, uy, uz), (v, vy, vz), (w, wy, wz) = fields

    def form(rows, weight):
        return rows.T @ (weight[:, None] * rows)

    stiffness = sum(form(rows, material.E * weight) for rows in (k * u, vy, wz))
    stiffness += sum(form(rows, material.G * weight) for rows in (uy + k * v, uz + k * w, vz + wy))
    stress = np.tile(points * sides[1], len(points)) * 12.0
    stress = stress / (section.width * section.height**3)
    geometric = k**2 * sum(form(rows, stress * weight) for rows in (u, v, w))
    return float(1.0 / eigh(geometric, stiffness, eigvals_only=True)[-1])


@pytest.mark.parametrize(("width", "solid_shift"), [(0.02, -0.0034), (0.04, -0.027)])
def test_shear_lowers_buckling_moment(width, solid_shift):
    """M² = GJ P/(1 + P/κGA), P = π²EI/L²: lateral bending with Engesser's shear (own derivation).

    The work −φ′ M γ with γ = Mφ′/κGA reduces the torsional stiffness to GJ − M²/κGA. The solid
    confirms the sign; its sections also warp and distort, which has an effect of the same order in
    width over L.
    """
    material = Material.isotropic(2.1e11, 0.0, 7850.0)
    leg = ConstantLeg(0.3, Rectangle(width, 0.06), material)
    p, moments = leg.timoshenko, {}
    for theory in ("euler-bernoulli", "timoshenko"):
        bar = prestressed_leg(leg.properties(theory), leg.length, 16, ALL)
        moments[theory] = factor(bar, FORKS, BENT)
    euler = np.pi**2 * p.EIz / leg.length**2
    # Discretisation error of 16 elements: 4e-6.
    assert moments["euler-bernoulli"] == pytest.approx(np.sqrt(p.GJ * euler), rel=4e-5)
    expected = np.sqrt(p.GJ * euler / (1.0 + euler / p.GAy))
    assert moments["timoshenko"] == pytest.approx(expected, rel=4e-5)
    slender = replace(leg, length=20.0 * leg.length)
    # The error of the polynomials' torsion constant cancels: a slender bar has the same.
    scale = moment_of_solid(slender, 7) * slender.length / (np.sqrt(p.GJ * p.EIz) * np.pi)
    shift = moment_of_solid(leg, 7) / (scale * np.sqrt(p.GJ * euler)) - 1.0
    assert shift == pytest.approx(solid_shift, abs=1.5e-3)
    beam = moments["timoshenko"] / moments["euler-bernoulli"] - 1.0
    assert 0.5 * shift > beam > 2.0 * shift


def factor_by_equilibrium(p: BeamProperties, length: float, force: float, moment: float) -> float:
    """Return the buckling factor from the equilibrium of the bent axis, without energy or elements.

    The root is clamped; `force` (N, along z) and `moment` (N m, about y) act on the tip, which may
    move along y and rotate about x and z. To first order the tip moment is m (−θz/2, 1, φ/2): half
    of it rotates with the tip. In the frame of the axis, v′ = θ + γ, a section has the torque T
    with T′ = M v″, and about its rotated axis the moment EI θ′ = m φ(L)/2 − Mφ, whose slope is the
    shear force, κGA γ = (Mφ)′.
    """

    def bending(x: Array) -> Array:
        return moment - force * (length - x)

    def slopes(x: Array, y: Array, factors: Array) -> Array:
        twist, rate, _ = y
        m, across = factors[0] * bending(x), factors[0] * force
        turning = (0.5 * factors[0] * moment - m * twist) / p.EIz
        # M v″ contains M φ″ from γ′, hence the slope of the torque itself.
        bent = m / p.GJ * (turning + 2.0 * across * rate / p.GAy)
        return np.array([rate, bent / (1.0 - m**2 / (p.GJ * p.GAy)), turning])

    def ends(root: Array, tip: Array, factors: Array) -> Array:
        m, across = factors[0] * moment, factors[0] * force
        shear = (across * tip[0] + m * tip[1]) / p.GAy
        torque = m * (0.5 * tip[2] + shear)
        return np.array([root[0], root[2], tip[0] - 1.0, tip[1] - torque / p.GJ])

    x, k = np.linspace(0.0, length, 41), 0.5 * np.pi / length
    start = np.array([np.sin(k * x), k * np.cos(k * x), -k * x])
    estimate = np.pi * np.sqrt(p.EIz * p.GJ) / length / np.abs(bending(x)).max()
    solution = solve_bvp(slopes, ends, x, start, [estimate], tol=1e-8, max_nodes=20_000)
    assert solution.success, solution.message
    # The leg buckles under forces of either sign.
    return abs(float(solution.p[0]))


@pytest.mark.parametrize("width", [0.02, 0.04, 0.06])
def test_shear_lowers_lateral_buckling_load(width):
    """The load falls by 0.6, 2.4, 5.2 % for three widths; half of that without the work −φ′ M γ."""
    leg = ConstantLeg(0.3, Rectangle(width, 0.06), STEEL)
    at_tip = np.array([0, 0, -1.0, 0, 0.3, 0, 0, 0, 1.0, 0, 0, 0])
    p, loads = leg.timoshenko, {}
    for theory in ("euler-bernoulli", "timoshenko"):
        bar = prestressed_leg(leg.properties(theory), leg.length, 16, ALL)
        loads[theory] = factor(bar, range(6, 12), at_tip)
    assert loads["euler-bernoulli"] == pytest.approx(
        factor_by_equilibrium(replace(p, GAy=np.inf), leg.length, 1.0, 0.0), rel=4e-5
    )
    expected = factor_by_equilibrium(p, leg.length, 1.0, 0.0)
    # Discretisation error of 16 elements: 3.3e-6.
    assert loads["timoshenko"] == pytest.approx(expected, rel=4e-5)


def test_shear_lowers_propped_buckling_moment():
    """Root clamped, tip guided along y, a moment about y on the tip.

    With shear along z the prop takes more of the moment, which alone would raise the factor by 0.4
    %. With the work −φ′ M γ the factor falls by 1.0 %.
    """
    length, leg = 0.3, ConstantLeg(0.3, Rectangle(0.04, 0.06), STEEL)
    factors = {}
    for theory in ("euler-bernoulli", "timoshenko"):
        p = leg.properties(theory)
        # Deflection of the tip by the moment, over that by a force.
        force = length**2 / (2.0 * p.EIy) / (length**3 / (3.0 * p.EIy) + length / p.GAz)
        forces = np.zeros(12)
        # Root and tip.
        forces[[2, 4, 8, 10]] = -force, force * length - 1.0, force, 1.0
        bar = prestressed_leg(p, length, 16, ALL)
        factors[theory] = factor(bar, (7, 9, 10, 11), forces)
        assert factors[theory] == pytest.approx(
            factor_by_equilibrium(p, length, force, 1.0), rel=4e-5
        )
    assert factors["timoshenko"] / factors["euler-bernoulli"] - 1.0 == pytest.approx(
        -0.0103, abs=2e-4
    )


# Coordinates of the twenty nodes of a brick element (corners, mid-edges) in CalculiX's order.
_BRICK = "000 200 220 020 002 202 222 022 100 210 120 010 102 212 122 012 001 201 221 021"


def cantilever_deck(leg: ConstantLeg, along: int, across: int) -> str:
    """Return the deck of a clamped solid square bar with 1 kN along −z spread over its tip face."""
    counts, side = np.array([along, across, across]), leg.section.width
    numbers = np.zeros(2 * counts + 1, dtype=int)
    grid = np.indices(numbers.shape)
    is_node = (grid % 2).sum(axis=0) <= 1
    numbers[is_node] = np.arange(1, is_node.sum() + 1)
    positions = (grid[:, is_node].T / (2.0 * counts) - [0.0, 0.5, 0.5]) * [leg.length, side, side]
    corners = 2 * np.indices(counts).reshape(3, -1).T
    brick = np.array([[int(digit) for digit in node] for node in _BRICK.split()])
    cells = numbers[tuple(np.moveaxis(corners[:, None] + brick, -1, 0))]
    forces = np.zeros(numbers.shape[1:])
    # Consistent nodal forces of the eight-node face, as fractions of its force.
    of_face = np.array([[-1.0, 4.0, -1.0], [4.0, 0.0, 4.0], [-1.0, 4.0, -1.0]]) / 12.0
    for j, k in product(range(0, 2 * across, 2), repeat=2):
        forces[j : j + 3, k : k + 3] += of_face * 1e3 / across**2
    loaded = numbers[-1] > 0
    return "\n".join(
        [
            "*NODE, NSET=ALL",
            *(f"{n}, " + ", ".join(f"{x:.12g}" for x in xyz) for n, xyz in enumerate(positions, 1)),
            "*ELEMENT, TYPE=C3D20R, ELSET=BAR",
            # CalculiX reads at most sixteen numbers in a line.
            *(
                f"{n}, {', '.join(map(str, cell[:10]))},\n{', '.join(map(str, cell[10:]))}"
                for n, cell in enumerate(cells, 1)
            ),
            "*MATERIAL, NAME=STEEL",
            "*ELASTIC",
            f"{leg.material.E:g}, {leg.material.nu:g}",
            "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL",
            "*BOUNDARY",
            *(f"{n}, 1, 3" for n in numbers[0][numbers[0] > 0]),
            "*STEP",
            "*BUCKLE",
            "1, 1e-6",
            "*CLOAD",
            *(
                f"{n}, 3, {-force:.12g}"
                for n, force in zip(numbers[-1][loaded], forces[loaded], strict=True)
            ),
            "*END STEP",
            "",
        ]
    )


@pytest.mark.exhaustive
@pytest.mark.skipif(not any(map(shutil.which, PROGRAMS)), reason="CalculiX (ccx) is not installed")
def test_stout_bar_buckling_equals_calculix(tmp_path):
    """Shear lowers the load by 4.43 % in a solid with ν = 0, by 4.35 % in beams.

    Without the work −φ′ M γ beams give 2.2 %. The clamped root of a square bar, which hardly warps,
    adds 0.1 %. Linear buckling ignores that a square bar may bend to either side.
    """
    leg = ConstantLeg(0.3, Rectangle(0.06, 0.06), Material.isotropic(2.1e11, 0.0, 7850.0))
    (tmp_path / "bar.inp").write_text(cantilever_deck(leg, 16, 4), encoding="ascii")
    program = [calculix_program(), "-i", "bar"]
    subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    printed = (tmp_path / "bar.dat").read_text(encoding="ascii")
    (solid,) = re.findall(r"^ +\d+ +(\S+E\S+) *$", printed, re.MULTILINE)
    at_tip = np.array([0, 0, -1.0, 0, 0.3, 0, 0, 0, 1.0, 0, 0, 0])
    beam = factor(prestressed_leg(leg.timoshenko, leg.length, 16, ALL), range(6, 12), at_tip)
    assert 1e3 * float(solid) == pytest.approx(beam, rel=3e-3)


# For a distributed load Q: consistent forces (in Q) and moments (in QL) at root and tip, lever of
# the resultant (in L), and buckling value Q L²/√(EI GJ). Uniform load: Timoshenko & Gere 1961,
# §6.3. Load growing from zero at the root: shooting of φ″ + M(x)² φ/(EI GJ) = 0, φ(0) = φ′(L) = 0,
# M = Q (2/3 − x + x³/3).
SPREAD = {
    "uniform": ((0.5, 0.5), (1 / 12, -1 / 12), 1 / 2, 12.85),
    "growing": ((0.3, 0.7), (1 / 15, -1 / 10), 2 / 3, None),
}


def growing_load_factor() -> float:
    """Return Q L²/√(EI GJ) of a cantilever under a load that grows linearly from its root."""

    def slope_at_tip(load: float) -> float:
        def rates(x, state):
            moment = load * (2.0 / 3.0 - x + x**3 / 3.0)
            return state[1], -(moment**2) * state[0]

        return float(solve_ivp(rates, (0.0, 1.0), (0.0, 1.0), rtol=1e-9, atol=1e-12).y[1, -1])

    return float(brentq(slope_at_tip, 2.0, 12.0, xtol=1e-9))


@pytest.mark.parametrize("shape", SPREAD)
@pytest.mark.parametrize("across", ["y", "z"])
def test_blade_buckles_under_distributed_load(across, shape):
    """Distributed loads of several shapes along y and z, against known buckling loads."""
    thin, deep = 0.004, 0.1
    section = Rectangle(thin, deep) if across == "z" else Rectangle(deep, thin)
    p = ConstantLeg(1.0, section, STEEL).properties("euler-bernoulli")
    axis, about, sign = {"y": (1, 5, 1.0), "z": (2, 4, -1.0)}[across]
    forces, moments, lever, expected = SPREAD[shape]
    leg = prestressed_leg(p, 1.0, 16, ALL)
    for direction in (1.0, -1.0):
        spread, reaction = np.zeros(12), np.zeros(12)
        spread[[axis, 6 + axis]] = direction * np.array(forces)
        spread[[about, 6 + about]] = sign * direction * np.array(moments)
        reaction[[axis, about]] = -direction, -lever * sign * direction
        load = factor(leg, range(6, 12), spread + reaction, spread)
        scale = np.sqrt(min(p.EIy, p.EIz) * p.GJ)
        # The published value has four digits.
        assert load == pytest.approx((expected or growing_load_factor()) * scale, rel=1e-3)


def test_reversed_leg_has_same_buckling():
    """The leg is reversed (root and tip exchanged), and its section and load are rotated by 90°."""
    stout = ConstantLeg(0.2, Rectangle(0.02, 0.06), STEEL)
    lying = ConstantLeg(0.2, Rectangle(0.06, 0.02), STEEL)
    leg = prestressed_leg(stout.timoshenko, 0.2, 12, ALL)
    at_tip = np.array([0, 0, -1.0, 0, 0.2, 0, 0, 0, 1.0, 0, 0, 0])
    at_root = np.array([0, 0, 1.0, 0, 0, 0, 0, 0, -1.0, 0, -0.2, 0])
    along_y = np.array([0, -1.0, 0, 0, 0, -0.2, 0, 1.0, 0, 0, 0, 0])
    load = factor(leg, range(6, 12), at_tip)
    assert factor(leg, range(6), at_root) == pytest.approx(load, rel=1e-9)
    turned = prestressed_leg(lying.timoshenko, 0.2, 12, ALL)
    assert factor(turned, range(6, 12), along_y) == pytest.approx(load, rel=1e-9)


def test_lateral_buckling_order_is_four():
    """Reference: 32 elements, whose error is 1 % of that of ten elements."""
    p, counts = ConstantLeg(0.2, Rectangle(0.02, 0.06), STEEL).timoshenko, [4, 6, 8, 10]
    at_tip = np.array([0, 0, -1.0, 0, 0.2, 0, 0, 0, 1.0, 0, 0, 0])
    loads = [factor(prestressed_leg(p, 0.2, n, ALL), range(6, 12), at_tip) for n in (*counts, 32)]
    errors = np.abs(np.array(loads[:-1]) / loads[-1] - 1.0)
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.3)
