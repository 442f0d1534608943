"""Command `identify` on a conical shaft, oblique to the file's axes: integrals over sections.

The reference point of one end is beside the axis, so that any wrong transport of a twist or wrench
changes a result. The references are approximate: averaged ends introduce shear uniformly, unlike
Saint-Venant's solution, an error of (r/L)²/3 = 4e-4. Rod theory neglects the square of the slope,
1e-4.
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
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from support.fakes.cleared_memory import forget
from support.oracles.compliance_difference import scaled_difference
from support.robots.drawn_parts import meshed, written
from support.robots.paper_legs import STEEL

from fem.beams.beam import beam_leg
from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.rooted import RootedBody
from lumped.beam_properties import tip_compliance
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import GivenLeg
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.placing import leg_frame
from lumped.models.bodies import clamped_modes
from lumped.robot_file import load_robot
from lumped.screws import turn_matrix
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation import cli
from validation.models.options import ModelOptions
from validation.models.robot_models import answers
from validation.parts import identify as identifying
from validation.parts.meshes import LEVELS, part_mesh
from validation.parts.refinement import compliance_uncertainty, refinement_uncertainty
from validation.parts.request import interfaces_of

pytestmark = pytest.mark.usefixtures("coarse_parts")
DRAWINGS = Path(__file__).resolve().parents[3] / "examples" / "make_parts.py"
MATERIAL = "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }"
LENGTH, ROOT, TIP = 0.6, 0.020, 0.016
START, ALONG = np.array([0.05, -0.02, 0.03]), np.array([0.8, 0.48, 0.36])
# Point of the second end, beside the axis.
END = START + LENGTH * ALONG + np.array([0.0, 0.03, -0.04])
# Relative error of the references, from the two approximations above.
REFERENCE_ERROR = 5e-4
# Stiffness (N m/rad) of the crank's drive, its angle, and the mass (kg) at its tip.
DRIVE, ANGLE, TIP_MASS = 4e5, 0.7, 5000.0
PLANES = {
    name: f"plane = {{ normal = {(sign * ALONG).tolist()}, point = {point.tolist()} }}"
    for name, sign, point in (("A", -1.0, START), ("B", 1.0, START + LENGTH * ALONG))
}
ENDS = [
    f'{name} = {{ {PLANES[name]}, coupling = "average", point = {point.tolist()} }}'
    for name, point in (("A", START), ("B", END))
]


def cone(kernel):
    kernel.addCone(*(1e3 * START), *(1e3 * LENGTH * ALONG), 1e3 * ROOT, 1e3 * TIP)


def cross_matrix(r):
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def wrench_transport(r):
    """Matrix (6×6) that moves a wrench from a point at `r` to the origin."""
    return np.block([[np.eye(3), np.zeros((3, 3))], [cross_matrix(r), np.eye(3)]])


def sections():
    """Yield (centre (3, m), radius (m), length (m)) at twelve Gauss points along the shaft."""
    points, weights = np.polynomial.legendre.leggauss(12)
    for s, weight in zip((points + 1.0) / 2.0, weights / 2.0, strict=True):
        yield START + s * LENGTH * ALONG, ROOT + s * (TIP - ROOT), LENGTH * weight


def compliance_of_sections():
    """Compliance (6×6) of the second interface's point, in the file's axes, by rod theory.

    ∫Lᵀ diag(1/EA, 1/κGA, 1/κGA, 1/GJ, 1/EI, 1/EI) L ds with L the transport of wrenches.
    """
    E, G, nu = STEEL.E, STEEL.G, STEEL.nu
    kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)  # Cowper 1966
    axial = np.outer(ALONG, ALONG)
    lateral = np.eye(3) - axial
    compliance = np.zeros((6, 6))
    for centre, radius, length in sections():
        area, moment = np.pi * radius**2, np.pi / 4.0 * radius**4
        strains = np.zeros((6, 6))
        strains[:3, :3] = axial / (E * area) + lateral / (kappa * G * area)
        strains[3:, 3:] = axial / (2.0 * G * moment) + lateral / (E * moment)
        lever = wrench_transport(END - centre)
        compliance += length * lever.T @ strains @ lever
    return compliance


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with the CAD file, the mesh and the cache."""
    path = tmp_path_factory.mktemp("shaft")
    written(path / "shaft.step", cone)
    meshed(path / "shaft.msh", cone, 60.0, 8.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("FLEXPROOF_CACHE", raising=False)
        patch.setenv("XDG_CACHE_HOME", str(path))
        yield path


def arguments(part, *options, ends=ENDS, material=MATERIAL):
    interfaces = [word for end in ends for word in ("--interface", end)]
    return ["identify", str(part), *interfaces, "--material", material, *options]


SMALL = ("--unknowns", "4000", "--modes", "1")


@pytest.fixture(scope="module")
def shaft(folder):
    part = folder / "shaft.step"
    with redirect_stdout(io.StringIO()) as stdout:
        assert cli.main([*arguments(part, *SMALL, "--out", str(folder / "all.npz")), "--json"]) == 0
    document = json.loads(stdout.getvalue())
    arrays = {name: np.array(value) for name, value in document.items() if isinstance(value, list)}
    for name in ("uncertainty", "bracket"):
        arrays[name] = np.array(document[name]["compliance"])
        arrays[f"frequency_{name}"] = np.array(document[name]["frequencies"])
    return document | arrays


def test_shaft_compliance_matches_integrals(folder, shaft):
    """The difference is within the half-width plus the error of the reference."""
    exact = compliance_of_sections()
    error = np.diag(shaft["compliance"]) / np.diag(exact) - 1.0
    half_width = np.diag(shaft["uncertainty"]) / np.diag(exact)
    assert (np.abs(error) <= half_width + REFERENCE_ERROR).all()
    assert (half_width < 0.1).all()
    assert scaled_difference(shaft["compliance"], exact) < 2.0 * REFERENCE_ERROR
    stored = np.load(folder / "all.npz")["compliance"]
    np.testing.assert_allclose(stored, shaft["compliance"], rtol=1e-15)


def test_shaft_mass_is_sum_of_discs(shaft):
    """Mass, centre and inertia of thin discs, scaled by the volume of the mesh."""
    masses = [STEEL.rho * np.pi * radius**2 * length for _, radius, length in sections()]
    centres = np.array([disc_centre for disc_centre, _, _ in sections()])
    centre = masses @ centres / sum(masses)
    # A disc's inertia about a diameter is half of that about its axis.
    inertia = np.zeros((3, 3))
    for mass, (disc_centre, radius, _) in zip(masses, sections(), strict=True):
        inertia += mass * radius**2 / 4.0 * (np.eye(3) + np.outer(ALONG, ALONG))
        inertia -= mass * cross_matrix(disc_centre - centre) @ cross_matrix(disc_centre - centre)
    # Circles with few curved sides lack 2e-3 of the volume, which volume_deviation reports.
    meshed = 1.0 + shaft["volume_deviation"]
    assert shaft["mass"] == pytest.approx(meshed * sum(masses), rel=1e-5)
    assert shaft["centre"] == pytest.approx(centre, abs=1e-4 * LENGTH)
    assert shaft["inertia"] == pytest.approx(meshed * inertia, abs=1e-3 * np.abs(inertia).max())


def test_condensed_shaft_has_rigid_motions(shaft):
    """Condensed 12×12 matrices: rigid motions have the mass of the shaft and need no force."""
    motions = np.vstack([np.eye(6), wrench_transport(END - START).T])
    mass_at_centre = np.zeros((6, 6))
    mass_at_centre[:3, :3], mass_at_centre[3:, 3:] = shaft["mass"] * np.eye(3), shaft["inertia"]
    arm = wrench_transport(shaft["centre"] - START)
    # Rounding, multiplied by the condition of a slender part.
    mass = motions.T @ shaft["condensed_mass"] @ motions
    assert scaled_difference(mass, arm @ mass_at_centre @ arm.T) < 1e-9
    assert np.abs(shaft["stiffness"] @ motions).max() < 1e-9 * np.abs(shaft["stiffness"]).max()
    # Rigid ends are more constrained than averaged ones and therefore stiffer (Rayleigh).
    scale = 1.0 / np.sqrt(np.diag(shaft["compliance"]))
    assert np.linalg.eigvalsh(shaft["bracket"] * np.outer(scale, scale))[0] > -1e-9


def test_uncounted_frequencies_have_remark(command, folder, monkeypatch):
    """Without memory for a factor, modes are not counted: null in JSON, a remark in the text."""
    monkeypatch.setattr(RootedBody, "countable", False)
    words = arguments(folder / "shaft.msh", "--unit", "mm", "--modes", "2")
    document = json.loads(command.output(*words, "--json"))
    assert len(document["frequencies"]) == 2
    assert document["modes_counted"] == {"count": None, "below": None}
    text = command.output(*words)
    assert "not counted, because no factor fits the memory: some may be missing" in text
    assert "none missing" not in text


def test_cached_identification_has_all_values(command, folder, shaft, monkeypatch):
    """The text printed from the cache has the numbers computed before."""
    forget()
    monkeypatch.setattr(identifying, "_identification", lambda *_: pytest.fail("computed again"))
    text = command.output(*arguments(folder / "shaft.step", *SMALL))
    rows = {line[:6].strip(): line.split() for line in text.splitlines()}
    compliance, half_width, bracket = (
        shaft[name][5, 5] for name in ("compliance", "uncertainty", "bracket")
    )
    assert float(rows["B φz"][2]) == pytest.approx(compliance, rel=1e-5)
    shares = [f"{100.0 * part / compliance:.3f}" for part in (half_width, bracket)]
    assert rows["B φz"][3:] == ["±", shares[0], "%", shares[1], "%"]
    (frequency,) = shaft["frequencies"]
    assert rows["1"][:3] == ["1", f"{frequency:.2f}", "±"]
    below = shaft["modes_counted"]["below"]
    assert frequency < below < 2.0 * frequency
    assert f"1 counted below {below:.6g} Hz, none missing" in text
    leg = tomllib.loads(text[text.index("[bodies.shaft]") :])["bodies"]["shaft"]
    assert (leg["from"], leg["to"]) == ("A", "B")
    assert leg["mass"] == pytest.approx(shaft["mass"])
    # Leg axes of a robot file: x from point to point, z as near to "up" as possible.
    axes = leg_frame(START, END, np.array(leg["up"])).rotation
    in_file_axes = turn_matrix(np.array(leg["compliance"]), axes)
    assert in_file_axes == pytest.approx(shaft["compliance"], rel=1e-8, abs=1e-16)


def test_imported_mesh_has_no_half_width(command, folder):
    """A mesh from a file cannot be refined: "–" instead of a number."""
    text = command.output(*arguments(folder / "shaft.msh", "--unit", "mm", "--modes", "1"))
    assert "one mesh, from the file, of " in text
    assert re.search(r"^  1 +\d+\.\d\d  ± +–  ", text, re.MULTILINE)


def test_half_width_has_meshes_and_couplings(folder, shaft):
    """Half-widths follow from three meshes, brackets from averaged against rigid interfaces."""
    file = read_part(folder / "shaft.step")
    ends = find_interfaces(file, *interfaces_of(ENDS))
    meshes = [part_mesh(file, ends, int(SMALL[1]), level) for level in LEVELS]
    assert list(shaft["unknowns"]) == [mesh.unknowns for mesh in meshes]

    def results(mesh, coupling):
        body = held_part(meshed_part("shaft", mesh, STEEL), grips_of(mesh, ends, coupling))
        return body.compliance, body.uncounted_frequencies(1)

    compliances, frequencies = zip(*(results(mesh, "average") for mesh in meshes), strict=True)
    half_widths = shaft["uncertainty"], shaft["frequency_uncertainty"]
    assert half_widths[0] == pytest.approx(compliance_uncertainty(compliances), rel=1e-4)
    assert half_widths[1] == pytest.approx(refinement_uncertainty(frequencies), rel=1e-4)
    # Averaged less rigid: averaged faces are more compliant, with lower frequencies.
    compliance, frequency = results(meshes[-1], "rigid")
    bracket = compliances[-1] - compliance
    assert shaft["bracket"] == pytest.approx(bracket, abs=1e-6 * compliance.max())
    assert shaft["frequency_bracket"] == pytest.approx(frequencies[-1] - frequency, rel=1e-4)
    assert shaft["frequency_bracket"] < 0.0


WRONG = [
    ([], MATERIAL, "", "--interface: missing"),
    ([""], MATERIAL, "", "--interface '': no interface found"),
    (["A"], MATERIAL, "", "not TOML"),
    (["A = { face = [1] }"], MATERIAL, "", 'unknown key; did you mean "faces"?'),
    (["A = { faces = [99] }"], MATERIAL, "", "face 99 does not exist.*1 to 3"),
    ([ENDS[0], ENDS[0]], MATERIAL, "", "A: given twice"),
    (ENDS, MATERIAL, "--modes 1.7", 'Invalid value "1.7" for --modes. Must be a whole number'),
    (ENDS, MATERIAL, "--modes 101", "--modes = 101: must be from 0 to 100"),
    (ENDS, MATERIAL, "--unknowns 999", "--unknowns = 999: must be from 1000 to 10000000"),
    (ENDS, MATERIAL, "--unknowns 10000001", "--unknowns = 10000001: must be from 1000 to"),
    (ENDS, MATERIAL, "--out {part}/matrices.npz", "shaft.step is not a folder"),
    (ENDS, "{ E = 2.1e11, nu = 0.3 }", "", "rho: missing"),
    (ENDS, MATERIAL.replace("nu", "G = 1e10, nu"), "", "isotropic"),
    (ENDS, "steel", "", "not TOML"),
    (ENDS, f"{MATERIAL}\nloss = 0.1", "", "must be a table"),
]


@pytest.mark.parametrize(
    ("ends", "material", "options", "message"), WRONG, ids=lambda value: str(value)[-25:]
)
def test_wrong_request_is_refused_at_once(
    command, folder, monkeypatch, ends, material, options, message
):
    """Before any mesh is made: one line with option and reason."""
    monkeypatch.setattr(identifying, "identify", lambda *_: pytest.fail("computed"))
    part = folder / "shaft.step"
    words = options.format(part=part).split()
    line = command.error_line(*arguments(part, *words, ends=ends, material=material))
    assert re.search(message, line)


@pytest.fixture(scope="module")
def crank(folder):
    """Posture of the shaft on a drive about z, with a point mass beside the shaft's axis."""
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


def crank_compliance():
    """Compliance (6×6) at the tool point of shaft and drive, in base axes."""
    R = Rotation.from_euler("z", ANGLE).as_matrix()
    D = np.kron(np.eye(2), R)
    axis = np.array([0.0, 0.0, 1.0])
    twist = np.concatenate([np.cross(axis, R @ (END - START)), axis])
    return D @ compliance_of_sections() @ D.T + np.outer(twist, twist) / DRIVE


@pytest.mark.parametrize(
    ("model", "parts"),
    [("vjm", "equivalent"), *((model, "condensed") for model in ("links", "segments", "solid"))],
)
def test_crank_compliance_is_shaft_and_drive(crank, model, parts):
    """The shaft's integrals in series with the drive's spring."""
    answer = answers(model, [crank], 0, ModelOptions(parts=parts))
    assert scaled_difference(answer.compliances[0], crank_compliance()) < REFERENCE_ERROR


def test_crank_frequencies_equal_mass_on_spring(crank):
    """ω² are the eigenvalues of C⁻¹/m, with C the 3×3 compliance of the mass's displacements."""
    answer = answers("segments", [crank], 3, ModelOptions(parts="condensed"))
    compliances = np.linalg.eigvalsh(crank_compliance()[:3, :3])[::-1]
    expected = 1.0 / (2.0 * np.pi * np.sqrt(TIP_MASS * compliances))
    # The mass of the shaft, a thousandth, lowers them by at most half of that, besides the error of
    # rod theory.
    assert answer.frequencies[0] == pytest.approx(expected, rel=2e-3)


@pytest.mark.soak
def test_condensed_leg_beats_equivalent_leg(tmp_path):
    """The condensed solid of a tapered hollow leg is closer to known values than equivalent legs.

    The known values were computed with meshes of another program on the same drawing and compared
    there with CalculiX. Tolerance 0.3 %: both meshes have errors of 0.1 to 0.2 % at the edges of
    rigid bores.
    """
    drawing, path = runpy.run_path(str(DRAWINGS)), tmp_path / "leg.step"
    drawing["write"](path, lambda occ: drawing["leg"](occ, drawing["MEASURED"]))
    bores = (f"{n} = {{ cylinder = {{ radius = {r} }} }}" for n, r in (("A", 0.04), ("B", 0.028)))
    part = read_part(path)
    ends = find_interfaces(part, *interfaces_of(bores))
    leg = identifying.identify(part, ends, STEEL, 60_000, 2)
    assert leg.total == pytest.approx(82.84, rel=1e-4)
    assert np.diag(leg.compliance)[1:3] == pytest.approx([3.81e-8, 2.51e-8], rel=3e-3)
    assert leg.frequencies == pytest.approx([199.5, 245.1], rel=3e-3)
    # With a platform of 46 kg at the tip and the root clamped.
    loaded = leg.mass[6:, 6:] + 46.0 * np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    squared = eigh(leg.stiffness[6:, 6:], loaded, eigvals_only=True)[:2]
    assert np.sqrt(squared) / (2.0 * np.pi) == pytest.approx([103.2, 127.1], rel=3e-3)
    given_leg = GivenLeg(0.85, leg.total, leg.compliance)
    for rule, expected, error in (
        ("stiffness", [140.6, 176.7], -0.28),
        ("compliance", [171.4, 205.6], -0.15),
    ):
        prism = equivalent_leg(given_leg, rule)
        frequencies = clamped_modes(beam_leg(prism.timoshenko, 0.85, 20), 2).frequencies
        assert frequencies == pytest.approx(expected, rel=3e-3)
        assert frequencies / leg.frequencies - 1.0 == pytest.approx([error, error], abs=0.02)
    by_stiffness = equivalent_leg(given_leg, "stiffness")
    ratios = np.diag(tip_compliance(by_stiffness.timoshenko, 0.85)) / np.diag(leg.compliance)
    assert ratios[1:3] == pytest.approx([1.63, 1.54], abs=0.01)
