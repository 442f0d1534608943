"""Couplings of faces and ends of prisms against Lagrange multipliers, closed forms and solids.

With Lagrange multipliers the displacements of all nodes and the twists of the interfaces are
unknowns, and every coupling condition is an equation.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.sparse import block_array, block_diag, bmat, csc_array, csr_array
from scipy.sparse.linalg import splu, spsolve
from support.oracles.compliance_difference import scaled_difference
from support.oracles.prism_waves import bending_wave, prism_wave_frequency, wall_frequency
from support.robots import drawn_parts
from support.robots.drawn_parts import read_here
from support.robots.paper_legs import CUBIC, STEEL, meshed

from fem.bodies import doubling
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.solid import clamped_leg, solid_leg
from fem.couplings.coupled_solid import coupled_solid
from fem.couplings.end_effects import _decays, restrained_compliance
from fem.couplings.grips import area_weights, rigid_motions, saint_venant_loads
from fem.couplings.section_fields import section_fields
from fem.couplings.wave_stiffness import prism_waves
from fem.elasticity import on_three_components
from fem.sections.section_constants import section_constants
from lumped.arrays import dense
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import ByCylinder, ByPlane, PartInterface
from lumped.sections import HollowRectangle, ISection, Rectangle, Tube
from meshes.part.interfaces import find_interfaces
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh
from validation.solids.solid_legs import computed_beam

# Offset (m) of the second bore's reference point from its axis.
OFFSET = np.array([1e-3, 2e-3, 0.0])


@pytest.fixture(scope="module")
def lug(tmp_path_factory):
    """Return a coarse lug of 100 mm length: its file and its solid part."""
    path = tmp_path_factory.mktemp("lug") / "lug.msh"
    file = read_here(
        drawn_parts.meshed(path, partial(drawn_parts.lug, length=100.0), 40.0, 9.0), "mm"
    )
    return file, meshed_part("lug", file.mesh, STEEL)


def grips_on(file, *kinds):
    """Return grips on the lug, one for each kind of coupling: both bores, and the flat end."""
    choices = ByCylinder(0.008), ByCylinder(0.005), ByPlane((1.0, 0.0, 0.0), (0.1, 0.0, 0.0))
    numbered_choices = enumerate(zip(choices, kinds, strict=False))
    interfaces = {f"I{k}": PartInterface(choice, kind) for k, (choice, kind) in numbered_choices}
    first, second, *further_interfaces = find_interfaces(file, interfaces)
    second = replace(second, point=second.point + OFFSET)
    return grips_of(file.mesh, (first, second, *further_interfaces))


def ties(grip, nodes):
    """Return rows that express the coupling of a face's displacements (3 per node) to its twist.

    The rows act on displacements relative to the rigid motion of the twist; a pin's axis is z.
    """
    weights = area_weights(nodes, grip.facets).toarray()
    if grip.kind == "rigid":
        return np.eye(3 * len(weights))
    if grip.kind == "average":
        return rigid_motions(nodes[grip.nodes], grip.point).T @ np.kron(weights, np.eye(3))
    # The axis of the bore is z.
    radial = (nodes[grip.nodes] - (grip.point - OFFSET)) * [1.0, 1.0, 0.0]
    radial /= np.linalg.norm(radial, axis=1)[:, None]
    outward = np.eye(len(radial))[:, :, None] * radial
    turned, along = np.cross([0.0, 0.0, 1.0], radial), np.array([[0.0, 0.0, 1.0]])
    means = [weights.sum(axis=0)[:, None] * direction for direction in (turned, along)]
    return np.vstack([rows.reshape(-1, radial.size) for rows in (outward, *means)])


def test_lug_compliance_equals_lagrange(lug):
    """Lug with a rigid, a pinned and an averaged interface: eliminated and multiplier equations."""
    file, part = lug
    grips = grips_on(file, "rigid", "pin", "average")
    nodes, size, m = part.mesh.nodes, part.stiffness.shape[0], len(grips)
    rows = []
    for k, grip in enumerate(grips):
        conditions = ties(grip, nodes)
        rows.append(np.zeros((len(conditions), size + 6 * m)))
        rows[-1][:, np.add.outer(3 * grip.nodes, range(3)).ravel()] = conditions
        motion = rigid_motions(nodes[grip.nodes], grip.point)
        rows[-1][:, size + 6 * k : size + 6 * k + 6] = -conditions @ motion
    # Unknowns: displacements, twists, multipliers; the first twist is zero.
    tied = csr_array(np.delete(np.vstack(rows), range(size, size + 6), axis=1))
    energy = block_diag([part.stiffness, csr_array((6 * m - 6, 6 * m - 6))], format="csr")
    scale = float(np.abs(part.stiffness.diagonal()).mean())
    system = csc_array(block_array([[energy, scale * tied.T], [scale * tied, None]]))
    loads = np.zeros((system.shape[0], 6 * m - 6))
    loads[size : size + 6 * m - 6] = np.eye(6 * m - 6)
    expected = splu(system).solve(loads)[size : size + 6 * m - 6]
    body = held_part(part, grips)
    sizes = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # 1e-7: rounding error of the indefinite system.
    assert body.compliance / sizes == pytest.approx(expected / sizes, abs=1e-7)
    assert body.stiffness.shape == (6 * m, 6 * m)


@pytest.mark.parametrize("kind", ["rigid", "average", "pin"])
def test_rigid_motion_needs_no_force(lug, kind):
    """A coupled part moved as a rigid body: no force, interface twists and mass as expected."""
    file, part = lug
    grips = grips_on(file, kind, kind)
    M = on_three_components(part.scalar_mass)
    solid = coupled_solid(part.stiffness, M, part.mesh.nodes, grips)
    T = solid.transformation
    if kind != "pin":
        # Not for a pin, whose fixed directions have an added stiffness.
        expected = T.T @ part.stiffness @ T
        # Rounding error of sums in another order: 1e-15 with five kernels of OpenBLAS.
        assert abs(solid.stiffness - expected).max() < 1e-13 * abs(expected).max()
    assert abs(solid.mass - T.T @ M @ T).max() < 1e-13 * abs(solid.mass).max()
    forces = solid.stiffness @ solid.motions
    assert abs(forces).max() < 1e-12 * abs(solid.stiffness).max()
    twists = solid.twists.T @ solid.motions
    assert twists[:6] == pytest.approx(np.eye(6), abs=1e-12)
    expected = rigid_motions(part.mesh.nodes, grips[0].point)
    assert T @ solid.motions == pytest.approx(expected, abs=1e-12)
    body = held_part(part, grips)
    rigid = twists.T @ body.condensed_mass @ twists
    mass = part.properties().mass * np.eye(3)
    assert rigid[:3, :3] == pytest.approx(mass, rel=1e-9, abs=1e-9)
    assert abs(body.stiffness @ twists).max() < 1e-9 * abs(body.stiffness).max()


def test_average_coupling_gives_mean_motion(lug):
    """A bore surface displaced by u_z = x² moves the interface by ∫x²/A = r²/2.

    A displacement u_x = z³ rotates it about y by ∫z⁴/∫(x² + z²).
    """
    file, part = lug
    (grip, _) = grips_on(file, "average", "average")
    mass, nodes = on_three_components(part.scalar_mass), part.mesh.nodes
    twists = coupled_solid(part.stiffness, mass, nodes, [grip]).twists
    x, _, z = (nodes - grip.point).T
    zeros = np.zeros_like(x)
    raised = twists.T @ np.column_stack([zeros, zeros, x**2]).ravel()
    bent = twists.T @ np.column_stack([z**3, zeros, zeros]).ravel()
    radius, top = 0.008, 0.015
    turned = top**4 / 5.0 / (top**2 / 3.0 + radius**2 / 2.0)
    # Nine quadratic sides around the bore give errors of 2e-5 and 2e-4.
    assert raised[:3] / radius**2 == pytest.approx([0.0, 0.0, 0.5], abs=2e-4)
    assert bent[3:] / turned == pytest.approx([0.0, 1.0, 0.0], abs=2e-3)


BLOCK = ConstantLeg(0.5, Rectangle(0.10, 0.16), STEEL)


def block_of_tetrahedra():
    return tetrahedra(BLOCK.section, BLOCK.length, 1)


@pytest.mark.parametrize("section", [None, Tube(0.12, 0.01), ISection(0.10, 0.16, 0.012, 0.008)])
def test_saint_venant_loads_are_unit_wrenches(section):
    """BᵀR = I: the loads have unit resultants and unit moments about (L, 0, 0)."""
    mesh = block_of_tetrahedra()
    if section:
        mesh = meshed(replace(BLOCK, section=section), 3, 2).mesh
    points, reference = mesh.nodes[mesh.tip.nodes], np.array([BLOCK.length, 0.0, 0.0])
    loads = saint_venant_loads(mesh.tip, points, reference, CUBIC)
    np.testing.assert_allclose(loads.T @ rigid_motions(points, reference), np.eye(6), atol=1e-12)


@pytest.mark.parametrize("mesh", [lambda: meshed(BLOCK, 1, 3).mesh, block_of_tetrahedra])
def test_free_solution_equals_bordered_system(mesh):
    """K u + B_root λ = f with B_rootᵀu = 0, solved directly without springs."""
    solid = solid_leg(BLOCK, mesh())
    clamped = clamped_leg(solid, "free")
    K, root, tip = solid.stiffness, clamped.root, clamped.loads
    # Divided by E, so that stiffness and constraint rows have similar magnitudes.
    system = bmat([[K / STEEL.E, root], [root.T, None]], format="csc")
    u = spsolve(system, np.vstack([tip / STEEL.E, np.zeros((6, 6))]))[:-6]
    size = np.abs(u).max(axis=0)
    # Rounding error times the condition number of a small mesh, about 1e5.
    np.testing.assert_allclose(clamped.response / size, u / size, rtol=0, atol=1e-10)
    assert scaled_difference(clamped.compliance, tip.T @ u) < 1e-10


def test_strip_decay_rates_equal_papkovich_fadle():
    """First roots s of sin 2s ± 2s = 0 (tension, bending), decay rate s/half-width (Fadle 1940)."""
    half = 0.05
    mesh = section_mesh(Rectangle(0.001, 2.0 * half), (1, 16))
    rates = {fields.name: _decays(fields)[0] for fields in section_fields(mesh, STEEL)}
    for name, root in {"tension": 2.10620 + 1.12536j, "bending y": 3.74884 + 1.38434j}.items():
        slowest = min(rates[name], key=lambda rate: rate.real) * half
        assert slowest.real == pytest.approx(root.real, rel=2e-3)
        assert abs(slowest.imag) == pytest.approx(root.imag, rel=2e-3)


THIN = ISection(0.1, 0.16, 0.0012, 0.0012)


def test_end_effects_are_independent_of_leg_length():
    """Changes of tip compliance by rigid end faces: c11 and c66 are equal for any leg length L.

    The change of slope acts on the lever L: that of c26 grows with L, that of c22 with 1, L and L².
    """
    tube = section_mesh(Tube(0.01, 0.001), 4)
    short, double, *long_legs = (
        restrained_compliance(tube, STEEL, length) for length in (1.0, 2.0, 10.0, 1e5)
    )
    # Rounding error of a mesh of thin walls: 4e-11 with six kernels of OpenBLAS.
    near = partial(pytest.approx, rel=1e-9)
    # The last leg is ten million times as long as wide.
    for length, change in zip((10.0, 1e5), long_legs, strict=True):
        assert np.array_equal(change, change.T)
        assert change[0, 0] == near(short[0, 0])
        assert change[5, 5] == near(short[5, 5])
        assert change[1, 5] == near(length * short[1, 5])
        # Under a tip force the moment at the root has the lever L, shear has none: terms in L²
        # (bending), in L (bending with shear), and a constant (shear).
        square = 0.5 * short[5, 5]
        lever = double[1, 1] - short[1, 1] - 3.0 * square
        shear = short[1, 1] - lever - square
        assert change[1, 1] == near(square * length**2 + lever * length + shear)


def test_asymmetric_section_waves_are_refused():
    """Waves are separated by symmetry; a skewed section mesh has none."""
    mesh = section_mesh(BLOCK.section, (2, 3))
    skew = replace(mesh, nodes=mesh.nodes + 0.1 * np.square(mesh.nodes[:, ::-1]))
    with pytest.raises(InputError, match="not symmetric"):
        prism_waves(skew, STEEL)


def test_rounded_end_effects_are_refused(monkeypatch):
    """Decaying fields in single precision are detected in torsion, where no symmetry helps."""
    mesh = section_mesh(THIN, 2)
    # With t/b = 0.01 and G/E = 5e-5, γ² ranges from 1e-5 to 1e12.
    with pytest.raises(ComputationError, match="decay rates along the leg are lost in rounding"):
        restrained_compliance(mesh, Material(2.1e11, 1e7, 0.3, 1.0), 5.0)

    def rounded(fields):
        rates, shapes = _decays(fields)
        return rates, shapes.astype(np.complex64)

    restrained_compliance(mesh, STEEL, 4.0)
    monkeypatch.setattr("fem.couplings.end_effects._decays", rounded)
    # The error would be 7 % of the torsional compliance of a leg with rigid faces.
    with pytest.raises(ComputationError, match="rigid faces in torsion is lost in rounding"):
        restrained_compliance(mesh, STEEL, 4.0)


@pytest.mark.parametrize("length", [0.5, 4.0])
def test_thin_wall_effects_equal_solid(length):
    """Reference: torsional compliance of solid slices, rigid minus free ends."""
    material = replace(STEEL, nu=0.0)
    mesh, leg = section_mesh(THIN, 2), ConstantLeg(length, THIN, material)
    condensed = doubling.condensed_leg(leg, mesh, 512)
    rigid, free = (doubling.tip_compliance(condensed, ends)[3, 3] for ends in ("rigid", "free"))
    end_effect = restrained_compliance(mesh, material, length)[3, 3]
    # Rounding error of both: 4e-8 with six kernels of OpenBLAS. A former version lost 1 % here.
    assert end_effect == pytest.approx(rigid - free, rel=1e-6)


@pytest.mark.parametrize("length", [0.5, 4.0])
def test_restrained_warping_equals_vlasov(length):
    """θ/T = (L − 2d tanh(L/2d))/GJ, d² = EΓ/GJ, without warping at both ends (Vlasov 1961)."""
    mesh, material = section_mesh(THIN, 2), replace(STEEL, nu=0.0)
    constants = section_constants(mesh, 0.0, material.G / material.E)
    rigidity = material.G * constants.torsion_constant
    depth = np.sqrt(material.E * constants.warping_constant / rigidity)
    end_effect = restrained_compliance(mesh, material, length)[3, 3]
    expected = -2.0 * depth * np.tanh(length / (2.0 * depth)) / rigidity
    # Vlasov neglects the thickness of the walls: an error of 1.6e-4, proportional to (t/b)².
    assert end_effect == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize(
    ("section", "counts", "length"),
    [
        (BLOCK.section, (2, 3), 0.85),
        (HollowRectangle(0.1, 0.16, 0.01), 4, 0.16),
        (ISection(0.1, 0.16, 0.012, 0.008), 4, 0.85),
    ],
)
def test_solid_converges_to_end_effects(section, counts, length):
    """The change of a solid's compliance by rigid ends converges to that by end effects."""
    mesh = section_mesh(section, counts)
    end_effect = restrained_compliance(mesh, STEEL, length)
    errors = []
    for slices in (64, 256):
        condensed = doubling.condensed_leg(ConstantLeg(length, section, STEEL), mesh, slices)
        rigid, free = (doubling.tip_compliance(condensed, ends) for ends in ("rigid", "free"))
        errors.append(
            np.abs(rigid - free - end_effect) / np.sqrt(np.outer(np.diag(free), np.diag(free)))
        )
    # Only the slices have an error, because decays are exact along x: of order two at least.
    assert errors[1].max() < 0.1 * errors[0].max()
    assert errors[1].max() < (2e-4 if length > 0.5 else 2e-3)


LENGTH = 0.9
BOX = HollowRectangle(0.14, 0.2, 0.01)
OPEN = ISection(0.1, 0.16, 0.012, 0.008)
SECTIONS = [BOX, Tube(0.12, 0.01), OPEN]


def waves_of(section, divisions):
    mesh = section_mesh(section, divisions)
    return {kind.fields.name: kind for kind in prism_waves(mesh, STEEL)}


@pytest.mark.parametrize(("along", "kind"), [("y", "bending z"), ("z", "bending y")])
@pytest.mark.parametrize("section", SECTIONS)
def test_bending_half_wave_has_no_end_moment(section, along, kind):
    """Dynamic stiffness of a leg pinned at both ends is singular at its first bending frequency.

    The ends are at nodes of a standing wave of length 2L, which transmits no moment there.
    """
    # The I-section is so long that its flanges do not vibrate by themselves.
    length = 2.0 if section is OPEN else LENGTH
    mesh = section_mesh(section, 2)
    omega = bending_wave(mesh, STEEL, np.pi / length, along)
    pinned = waves_of(section, 2)[kind].stiffness(length, omega)[1::2, 1::2]
    values = np.abs(np.linalg.eigvalsh(pinned))
    assert values.min() < 1e-6 * values.max()


def test_bending_wave_equals_ritz():
    """Ritz's method with polynomials over the whole section; Timoshenko's wave is 0.4 % slower."""
    section = Rectangle(0.06, 0.1)
    k = 2.0 * np.pi / (6.0 * section.height)
    wave = bending_wave(section_mesh(section, 4), STEEL, k, "z") / (2.0 * np.pi)
    # Both solve the same elasticity problem, with nine-node elements and with polynomials.
    assert wave == pytest.approx(prism_wave_frequency(section, STEEL, "bending", k), rel=2e-4)


def test_tube_ovalling_equals_hoppe():
    """ω² = n²(n² − 1)²/(n² + 1) EI/(μR⁴) of a ring, n = 2 (Love, §293), with E/(1 − ν²) for E."""
    radius, wall = 0.05, 0.003
    mesh = section_mesh(Tube(2.0 * radius + wall, wall), 6)
    plate = STEEL.E / (1.0 - STEEL.nu**2) * wall**2 / (12.0 * STEEL.rho)
    expected = np.sqrt(36.0 / 5.0 * plate) / radius**2
    # The curved elements are too stiff by 3 %; using E instead of E/(1 − ν²) would be off by 9 %.
    assert wall_frequency(mesh, STEEL) == pytest.approx(expected, rel=4e-2)


@pytest.mark.parametrize("section", SECTIONS)
def test_slow_waves_equal_timoshenko(section):
    """Waves and beam contain Saint-Venant's solutions as ω → 0; they differ by terms in ω²."""
    omega = 2.0 * np.pi * 2.0
    beam = computed_beam(ConstantLeg(LENGTH, section, STEEL), 4)
    dynamic = dense(beam.stiffness) - omega**2 * dense(beam.mass)
    inside = np.linalg.solve(dynamic[12:, 12:], dynamic[12:, :12])
    expected = dynamic[:12, :12] - dynamic[:12, 12:] @ inside
    for name, kind in waves_of(section, 4).items():
        by_beam = expected[np.ix_(kind.ends, kind.ends)]
        unit = 1.0 / np.sqrt(np.diag(by_beam))
        difference = (kind.stiffness(LENGTH, omega) - by_beam) * np.outer(unit, unit)
        # Larger in torsion, because an open section warps along the wave; the mesh of a round
        # section has an error of 1e-4.
        assert np.abs(difference).max() < (5e-4 if name == "torsion" else 2e-4), name


def test_singular_wave_equation_is_refused(monkeypatch):
    """At 1500 Hz the walls of a box vibrate locally; infinite solutions are refused, too."""
    with pytest.raises(ComputationError, match="walls of the section vibrate locally"):
        waves_of(BOX, 2)["bending z"].stiffness(LENGTH, 2.0 * np.pi * 1500.0)
    # A zero pivot gives infinite numbers, as with legs of very different stiffness.
    monkeypatch.setattr(
        "fem.couplings.wave_stiffness.lu_solve", lambda _, right: np.full_like(right, np.inf)
    )
    with pytest.raises(ComputationError, match=r"bending z at .* Hz is lost in rounding"):
        waves_of(Rectangle(0.05, 0.08), 2)["bending z"].stiffness(LENGTH, 100.0)
