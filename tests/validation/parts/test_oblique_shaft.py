"""A conical shaft, oblique in its file: every way to a part against integrals over its drawing.

One end's point lies beside the axis, so that every transport of a twist or a wrench has a number to
be wrong in. Ends take up shear evenly, as Saint-Venant's solution does not: a third of (r/L)²,
1.5e-3; rod theory leaves out the square of the slope, 2e-4.
"""

import numpy as np
import pytest
from compliances import scaled_difference
from drawn_parts import meshed

from lumped.legs import Material
from lumped.mechanism.body import ByPlane, PartInterface
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.models.mechanism import answers
from validation.models.options import ModelOptions
from validation.parts.identify import identify

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LENGTH, ROOT, TIP = 0.4, 0.030, 0.024
START, ALONG = np.array([0.05, -0.02, 0.03]), np.array([0.8, 0.48, 0.36])
# The second point, beside the axis.
END = START + LENGTH * ALONG + np.array([0.0, 0.03, -0.04])
RODS = 1.5e-3
# Stiffness (N m/rad) of the crank's drive, its angle, and the mass (kg) at its tip.
DRIVE, ANGLE, TIP_MASS = 4e5, 0.7, 5000.0


def across(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def carried(r):
    """A wrench at a point, seen from another from which that point is at `r`."""
    return np.block([[np.eye(3), np.zeros((3, 3))], [across(r), np.eye(3)]])


def sections():
    """Place (3), radius and length (m) of each of twelve Gauss points of the smooth integrands."""
    points, weights = np.polynomial.legendre.leggauss(12)
    for s, weight in zip((points + 1.0) / 2.0, weights / 2.0, strict=True):
        yield START + s * LENGTH * ALONG, ROOT + s * (TIP - ROOT), LENGTH * weight


def compliance_of_sections():
    """∫Lᵀ diag(1/EA, 1/κGA, 1/κGA, 1/GJ, 1/EI, 1/EI) L ds at the second point, file axes."""
    E, G, nu = STEEL.E, STEEL.G, STEEL.nu
    kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)  # Cowper 1966
    axial = np.outer(ALONG, ALONG)
    lateral = np.eye(3) - axial
    compliance = np.zeros((6, 6))
    for place, radius, length in sections():
        area, moment = np.pi * radius**2, np.pi / 4.0 * radius**4
        strains = np.zeros((6, 6))
        strains[:3, :3] = axial / (E * area) + lateral / (kappa * G * area)
        strains[3:, 3:] = axial / (2.0 * G * moment) + lateral / (E * moment)
        lever = carried(END - place)
        compliance += length * lever.T @ strains @ lever
    return compliance


PLANES = (("A", -1.0, START), ("B", 1.0, START + LENGTH * ALONG))


@pytest.fixture(scope="module")
def mesh_file(tmp_path_factory):
    def cone(kernel):
        kernel.addCone(*(1e3 * START), *(1e3 * LENGTH * ALONG), 1e3 * ROOT, 1e3 * TIP)

    return meshed(tmp_path_factory.mktemp("shaft") / "shaft.msh", cone, 30.0, 12.0)


@pytest.fixture(scope="module")
def shaft(mesh_file):
    part = read_part(mesh_file, "mm")
    ends = {
        name: PartInterface(ByPlane(tuple(way * ALONG), tuple(place)), "average")
        for name, way, place in PLANES
    }
    return identify(part, find_interfaces(part, ends, {"A": START, "B": END}), STEEL, modes=0)


def test_its_compliance_is_that_of_its_sections(shaft):
    assert scaled_difference(shaft.compliance, compliance_of_sections()) < RODS


def test_its_mass_centre_and_inertia_are_those_of_its_discs(shaft):
    masses = [STEEL.rho * np.pi * radius**2 * length for _, radius, length in sections()]
    places = np.array([place for place, _, _ in sections()])
    centre = masses @ places / sum(masses)
    # A disc's inertia about a diameter is half of that about its axis.
    inertia = np.zeros((3, 3))
    for mass, (place, radius, _) in zip(masses, sections(), strict=True):
        inertia += mass * radius**2 / 4.0 * (np.eye(3) + np.outer(ALONG, ALONG))
        inertia -= mass * across(place - centre) @ across(place - centre)
    # Circles of twelve curved sides: 1e-4.
    assert shaft.total == pytest.approx(sum(masses), rel=1e-3)
    assert shaft.centre == pytest.approx(centre, abs=1e-3 * LENGTH)
    assert shaft.inertia == pytest.approx(inertia, abs=1e-3 * np.abs(inertia).max())


def test_condensed_it_moves_rigidly_with_its_own_mass_and_averaged_ends_give_more(shaft):
    motions = np.vstack([np.eye(6), carried(END - START).T])
    own = np.zeros((6, 6))
    own[:3, :3], own[3:, 3:] = shaft.total * np.eye(3), shaft.inertia
    arm = carried(shaft.centre - START)
    # Rounding, grown by the condition of a slender part.
    assert scaled_difference(motions.T @ shaft.mass @ motions, arm @ own @ arm.T) < 1e-9
    assert np.abs(shaft.stiffness @ motions).max() < 1e-9 * np.abs(shaft.stiffness).max()
    # Constraints take from what gives (Rayleigh).
    scale = 1.0 / np.sqrt(np.diag(shaft.compliance))
    assert np.linalg.eigvalsh(shaft.compliance_bracket * np.outer(scale, scale))[0] > -1e-9


@pytest.fixture(scope="module")
def crank(mesh_file):
    """The shaft on a drive about z, turned, with a heavy mass at its point beside the axis."""
    ends = ", ".join(
        f"{name} = {{ plane = {{ normal = {(way * ALONG).tolist()}, "
        f'point = {place.tolist()} }}, coupling = "average" }}'
        for name, way, place in PLANES
    )
    file = mesh_file.with_name("crank.toml")
    file.write_text(
        f"""
schema = 2
name = "crank"
points = {{ A = {START.tolist()}, B = {END.tolist()} }}
joints.A.type = "revolute"
joints.A.between = ["ground", "shaft"]
joints.A.at = "A"
joints.A.axis = [0.0, 0.0, 1.0]
joints.A.drive = {{ stiffness = {DRIVE} }}
tool = {{ body = "shaft", point = "B", moves = ["phi_z"], mass = {TIP_MASS} }}
path = {{ poses = [[{ANGLE}]] }}
[bodies.shaft]
mesh = "shaft.msh"
unit = "mm"
material = {{ E = {STEEL.E}, nu = {STEEL.nu}, rho = {STEEL.rho} }}
interfaces = {{ {ends} }}
""",
        "utf-8",
    )
    mechanism = load_robot(file).mechanism
    return posture(mechanism, mechanism.poses[0])


def turned_compliance():
    """Of the tool's point, base axes: the shaft turned, and its drive."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    D = np.kron(np.eye(2), R)
    upright = np.array([0.0, 0.0, 1.0])
    swing = np.concatenate([np.cross(upright, R @ (END - START)), upright])
    return D @ compliance_of_sections() @ D.T + np.outer(swing, swing) / DRIVE


@pytest.mark.parametrize(
    ("model", "parts"),
    [
        ("links", "condensed"),
        ("vjm", "equivalent"),
        ("segments", "condensed"),
        ("solid", "condensed"),
    ],
)
def test_as_the_crank_of_a_robot_it_gives_as_its_sections_and_its_drive(crank, model, parts):
    (found,) = answers(model, [crank], 0, ModelOptions(parts=parts))
    assert scaled_difference(found.compliance, turned_compliance()) < RODS


def test_a_heavy_mass_on_the_crank_swings_on_its_springs(crank):
    """ω² = eigenvalues of C⁻¹/m, C the translations' compliance."""
    (found,) = answers("segments", [crank], 3, ModelOptions(parts="condensed"))
    springs = np.linalg.eigvalsh(turned_compliance()[:3, :3])[::-1]
    expected = 1.0 / (2.0 * np.pi * np.sqrt(TIP_MASS * springs))
    # The shaft's own mass, a thousandth, lowers them by half of it at most; and rod theory.
    assert found.frequencies == pytest.approx(expected, rel=2e-3)
