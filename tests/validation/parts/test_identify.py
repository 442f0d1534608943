"""`flexproof identify` on a conical shaft, oblique in its file, against integrals over its drawing.

One end's point lies beside the axis, so that every transport of a twist or a wrench has a number to
be wrong in. Ends take up shear evenly, as Saint-Venant's solution does not: a third of (r/L)²,
4e-4; rod theory leaves out the square of the slope, 1e-4.
"""

import io
import json
import re
import runpy
import tomllib
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np
import pytest
from compliances import scaled_difference
from drawn_parts import meshed, written
from forgetting import forget
from prismatic_legs import STEEL
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from fem.beams.beam import beam_leg
from fem.bodies.part import grips_of, held_part, meshed_part
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import GivenLeg, tip_compliance
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.placing import leg_frame
from lumped.models.bodies import clamped_modes
from lumped.robot_file import load_robot
from lumped.screws import turn_matrix
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation import cli
from validation.models.mechanism import answers
from validation.models.options import ModelOptions
from validation.parts import identify as identifying
from validation.parts.meshes import LEVELS, part_mesh
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty
from validation.parts.request import interfaces_of

pytestmark = pytest.mark.usefixtures("coarse_parts")
DRAWINGS = Path(__file__).resolve().parents[3] / "examples" / "make_parts.py"
MATERIAL = "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }"
LENGTH, ROOT, TIP = 0.6, 0.020, 0.016
START, ALONG = np.array([0.05, -0.02, 0.03]), np.array([0.8, 0.48, 0.36])
# The second point, beside the axis.
END = START + LENGTH * ALONG + np.array([0.0, 0.03, -0.04])
RODS = 5e-4
# Stiffness (N m/rad) of the crank's drive, its angle, and the mass (kg) at its tip.
DRIVE, ANGLE, TIP_MASS = 4e5, 0.7, 5000.0
PLANES = {
    name: f"plane = {{ normal = {(way * ALONG).tolist()}, point = {place.tolist()} }}"
    for name, way, place in (("A", -1.0, START), ("B", 1.0, START + LENGTH * ALONG))
}
ENDS = [
    f'{name} = {{ {PLANES[name]}, coupling = "average", point = {point.tolist()} }}'
    for name, point in (("A", START), ("B", END))
]


def cone(kernel):
    kernel.addCone(*(1e3 * START), *(1e3 * LENGTH * ALONG), 1e3 * ROOT, 1e3 * TIP)


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


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The drawing, and what keeps answers."""
    place = tmp_path_factory.mktemp("shaft")
    written(place / "shaft.step", cone)
    meshed(place / "shaft.msh", cone, 60.0, 8.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("FLEXPROOF_CACHE", raising=False)
        patch.setenv("XDG_CACHE_HOME", str(place))
        yield place


def asked(part, *more, ends=ENDS, material=MATERIAL):
    chosen = [word for end in ends for word in ("--interface", end)]
    return ["identify", str(part), *chosen, "--material", material, *more]


FEW = ("--unknowns", "4000", "--modes", "1")


@pytest.fixture(scope="module")
def shaft(folder):
    part = folder / "shaft.step"
    with redirect_stdout(io.StringIO()) as said:
        assert cli.main([*asked(part, *FEW, "--out", str(folder / "all.npz")), "--json"]) == 0
    found = json.loads(said.getvalue())
    arrays = {name: np.array(value) for name, value in found.items() if isinstance(value, list)}
    for name in ("uncertainty", "bracket"):
        arrays[name] = np.array(found[name]["compliance"])
        arrays[f"frequency_{name}"] = np.array(found[name]["frequencies"])
    return found | arrays


def test_its_compliance_is_that_of_its_sections_within_what_is_stated(folder, shaft):
    exact = compliance_of_sections()
    off = np.diag(shaft["compliance"]) / np.diag(exact) - 1.0
    stated = np.diag(shaft["uncertainty"]) / np.diag(exact)
    assert (np.abs(off) <= stated + RODS).all()
    assert (stated < 0.1).all()
    assert scaled_difference(shaft["compliance"], exact) < 2.0 * RODS
    told = np.load(folder / "all.npz")["compliance"]
    np.testing.assert_allclose(told, shaft["compliance"], rtol=1e-15)


def test_its_mass_centre_and_inertia_are_those_of_its_discs(shaft):
    masses = [STEEL.rho * np.pi * radius**2 * length for _, radius, length in sections()]
    places = np.array([place for place, _, _ in sections()])
    centre = masses @ places / sum(masses)
    # A disc's inertia about a diameter is half of that about its axis.
    inertia = np.zeros((3, 3))
    for mass, (place, radius, _) in zip(masses, sections(), strict=True):
        inertia += mass * radius**2 / 4.0 * (np.eye(3) + np.outer(ALONG, ALONG))
        inertia -= mass * across(place - centre) @ across(place - centre)
    # Circles of a few curved sides have lost 2e-3 of the volume, as is said.
    meshed = 1.0 + shaft["volume_deviation"]
    assert shaft["mass"] == pytest.approx(meshed * sum(masses), rel=1e-5)
    assert shaft["centre"] == pytest.approx(centre, abs=1e-4 * LENGTH)
    assert shaft["inertia"] == pytest.approx(meshed * inertia, abs=1e-3 * np.abs(inertia).max())


def test_condensed_it_moves_rigidly_with_its_own_mass_and_averaged_ends_give_more(shaft):
    motions = np.vstack([np.eye(6), carried(END - START).T])
    own = np.zeros((6, 6))
    own[:3, :3], own[3:, 3:] = shaft["mass"] * np.eye(3), shaft["inertia"]
    arm = carried(shaft["centre"] - START)
    # Rounding, grown by the condition of a slender part.
    mass = motions.T @ shaft["condensed_mass"] @ motions
    assert scaled_difference(mass, arm @ own @ arm.T) < 1e-9
    assert np.abs(shaft["stiffness"] @ motions).max() < 1e-9 * np.abs(shaft["stiffness"]).max()
    # Constraints take from what gives (Rayleigh).
    scale = 1.0 / np.sqrt(np.diag(shaft["compliance"]))
    assert np.linalg.eigvalsh(shaft["bracket"] * np.outer(scale, scale))[0] > -1e-9


def test_its_text_has_all_numbers_without_meshing_again(command, folder, shaft, monkeypatch):
    forget()
    monkeypatch.setattr(identifying, "_computed", lambda *_: pytest.fail("computed again"))
    said = command.told(*asked(folder / "shaft.step", *FEW))
    rows = {line[:6].strip(): line.split() for line in said.splitlines()}
    give, stated, bracket = (shaft[name][5, 5] for name in ("compliance", "uncertainty", "bracket"))
    assert float(rows["B φz"][2]) == pytest.approx(give, rel=1e-5)
    shares = [f"{100.0 * stated / give:.3f}", "%", f"{100.0 * bracket / give:.3f}", "%"]
    assert rows["B φz"][3:] == ["±", *shares]
    (hertz,) = shaft["frequencies"]
    assert rows["1"][:3] == ["1", f"{hertz:.2f}", "±"]
    below = shaft["modes_counted"]["below"]
    assert hertz < below < 2.0 * hertz
    assert f"1 counted below {below:.6g} Hz, none missing" in said
    leg = tomllib.loads(said[said.index("[bodies.shaft]") :])["bodies"]["shaft"]
    assert (leg["from"], leg["to"]) == ("A", "B")
    assert leg["mass"] == pytest.approx(shaft["mass"])
    # As a robot file is read: x from point to point, z as near to "up" as it can be.
    axes = leg_frame(START, END, np.array(leg["up"])).rotation
    read = turn_matrix(np.array(leg["compliance"]), axes)
    assert read == pytest.approx(shaft["compliance"], rel=1e-8, abs=1e-16)


def test_what_a_given_mesh_leaves_open_is_not_known(command, folder):
    said = command.told(*asked(folder / "shaft.msh", "--unit", "mm", "--modes", "1"))
    assert "one mesh, as given, of " in said
    assert re.search(r"^  1 +\d+\.\d\d  ± +–  ", said, re.MULTILINE)


def test_three_meshes_and_two_ways_of_holding_leave_open_what_is_stated(folder, shaft):
    file = read_part(folder / "shaft.step")
    ends = find_interfaces(file, *interfaces_of(ENDS))
    meshes = [part_mesh(file, ends, int(FEW[1]), level) for level in LEVELS]
    assert list(shaft["unknowns"]) == [mesh.unknowns for mesh in meshes]

    def held(mesh, coupling):
        body = held_part(meshed_part(mesh, STEEL), grips_of(mesh, ends, coupling), "shaft")
        return body.compliance, body.uncounted_frequencies(1)

    compliances, frequencies = zip(*(held(mesh, "average") for mesh in meshes), strict=True)
    stated = shaft["uncertainty"], shaft["frequency_uncertainty"]
    assert stated[0] == pytest.approx(compliance_uncertainty(*compliances), rel=1e-4)
    assert stated[1] == pytest.approx(refinement_uncertainty(*frequencies), rel=1e-4)
    # Averaged less rigid: averaged faces yield more and swing lower.
    compliance, frequency = held(meshes[-1], "rigid")
    apart = compliances[-1] - compliance
    assert shaft["bracket"] == pytest.approx(apart, abs=1e-6 * compliance.max())
    assert shaft["frequency_bracket"] == pytest.approx(frequencies[-1] - frequency, rel=1e-4)
    assert shaft["frequency_bracket"] < 0.0


WRONG = [
    ([], MATERIAL, "", "--interface: missing"),
    ([""], MATERIAL, "", "--interface '': names none"),
    (["A"], MATERIAL, "", "not TOML"),
    (["A = { face = [1] }"], MATERIAL, "", 'unknown key; did you mean "faces"?'),
    (["A = { faces = [99] }"], MATERIAL, "", "face 99 does not exist.*1 to 3"),
    ([ENDS[0], ENDS[0]], MATERIAL, "", "A: given twice"),
    (ENDS, MATERIAL, "--modes 1.7", 'Invalid value "1.7" for --modes. Must be a whole number'),
    (ENDS, MATERIAL, "--modes 101", "--modes = 101: must be from 0 to 100"),
    (ENDS, MATERIAL, "--unknowns 999", "--unknowns = 999: must be from 1000 to 10000000"),
    (ENDS, MATERIAL, "--unknowns 10000001", "--unknowns = 10000001: must be from 1000 to"),
    (ENDS, MATERIAL, "--out {part}/matrices.npz", "shaft.step is no folder"),
    (ENDS, "{ E = 2.1e11, nu = 0.3 }", "", "rho: missing"),
    (ENDS, MATERIAL.replace("nu", "G = 1e10, nu"), "", "isotropic"),
    (ENDS, "steel", "", "not TOML"),
    (ENDS, f"{MATERIAL}\nloss = 0.1", "", "must be a table"),
]


@pytest.mark.parametrize(("ends", "material", "more", "said"), WRONG, ids=lambda of: str(of)[-25:])
def test_a_wrong_request_is_one_line_before_anything_is_computed(
    command, folder, monkeypatch, ends, material, more, said
):
    monkeypatch.setattr(identifying, "identify", lambda *_: pytest.fail("computed"))
    part = folder / "shaft.step"
    words = more.format(part=part).split()
    assert re.search(said, command.refused(*asked(part, *words, ends=ends, material=material)))


@pytest.fixture(scope="module")
def crank(folder):
    """The shaft on a drive about z, turned, with a heavy mass at its point beside the axis."""
    ends = ", ".join(f'{name} = {{ {PLANES[name]}, coupling = "average" }}' for name in PLANES)
    file = folder / "crank.toml"
    file.write_text(
        f"""
schema = 2
name = "crank"
points = {{ A = {START.tolist()}, B = {END.tolist()} }}
tool = {{ body = "shaft", point = "B", moves = ["phi_z"], mass = {TIP_MASS} }}
path = {{ poses = [[{ANGLE}]] }}
[joints.A]
type = "revolute"
between = ["ground", "shaft"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = {DRIVE} }}
[bodies.shaft]
mesh = "shaft.msh"
unit = "mm"
material = {MATERIAL}
interfaces = {{ {ends} }}
""",
        "utf-8",
    )
    mechanism = load_robot(file).mechanism
    return posture(mechanism, mechanism.poses[0])


def turned_compliance():
    """Of the tool's point, base axes: the shaft turned, and its drive."""
    R = Rotation.from_euler("z", ANGLE).as_matrix()
    D = np.kron(np.eye(2), R)
    upright = np.array([0.0, 0.0, 1.0])
    swing = np.concatenate([np.cross(upright, R @ (END - START)), upright])
    return D @ compliance_of_sections() @ D.T + np.outer(swing, swing) / DRIVE


@pytest.mark.parametrize(
    ("model", "parts"),
    [("vjm", "equivalent"), *((model, "condensed") for model in ("links", "segments", "solid"))],
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


@pytest.mark.exhaustive
def test_a_condensed_leg_is_right_and_the_equivalent_one_is_not(tmp_path):
    """A tapered hollow leg with lugs: what its solid says, and what its idealisations make of it.

    Known values: measured beforehand with another program's meshes on the same drawing, compared
    there with CalculiX. 0.3 %: both meshes leave 0.1 to 0.2 % at the edges of rigid bores.
    """
    drawing, path = runpy.run_path(str(DRAWINGS)), tmp_path / "leg.step"
    drawing["write"](path, lambda occ: drawing["leg"](occ, drawing["MEASURED"]))
    bores = (f"{n} = {{ cylinder = {{ radius = {r} }} }}" for n, r in (("A", 0.04), ("B", 0.028)))
    part = read_part(path)
    ends = find_interfaces(part, *interfaces_of(bores))
    found = identifying.identify(part, ends, STEEL, 60_000, 2)
    assert found.total == pytest.approx(82.84, rel=1e-4)
    assert np.diag(found.compliance)[1:3] == pytest.approx([3.81e-8, 2.51e-8], rel=3e-3)
    assert found.frequencies == pytest.approx([199.5, 245.1], rel=3e-3)
    # With a platform at the tip, the root clamped.
    loaded = found.mass[6:, 6:] + 46.0 * np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    squared = eigh(found.stiffness[6:, 6:], loaded, eigvals_only=True)[:2]
    assert np.sqrt(squared) / (2.0 * np.pi) == pytest.approx([103.2, 127.1], rel=3e-3)
    given = GivenLeg(0.85, found.total, found.compliance)
    for by, expected, error in (
        ("stiffness", [140.6, 176.7], -0.28),
        ("compliance", [171.4, 205.6], -0.15),
    ):
        prism = equivalent_leg(given, by)
        frequencies = clamped_modes(beam_leg(prism.timoshenko, 0.85, 20), 2).frequencies
        assert frequencies == pytest.approx(expected, rel=3e-3)
        assert frequencies / found.frequencies - 1.0 == pytest.approx([error, error], abs=0.02)
    stiff = equivalent_leg(given, "stiffness")
    softer = np.diag(tip_compliance(stiff.timoshenko, 0.85)) / np.diag(found.compliance)
    assert softer[1:3] == pytest.approx([1.63, 1.54], abs=0.01)
