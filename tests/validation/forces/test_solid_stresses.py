"""Stress fields of solids: exact elastic fields, equilibrium, and beam theory within legs."""

import tomllib

import numpy as np
import pytest
from support.robots.crane import write_crane
from support.robots.plane_frames import BAR, CANTILEVER, RHO, B, H, L

import flexproof as fp
from fem.bodies.stresses import away_from, nodal_stresses, von_mises
from lumped.errors import InputError
from lumped.legs import Material
from lumped.sections import Rectangle
from meshes.prism import hexahedra, tetrahedra
from validation.forces.analysis import forces
from validation.forces.record import as_text
from validation.forces.solids import vtu_of
from validation.solve.question import Question

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
CUBIC = Material(E=2.1e11, G=1.3e11, nu=0.25, rho=7850.0)
LOADED = (
    CANTILEVER
    + """
[[loads]]
name = "push"
wrench = [2000.0, 0.0, -1000.0, 0.0, 0.0, 0.0]
gravity = [0.0, 0.0, -9.81]
"""
)


@pytest.mark.parametrize("material", [STEEL, CUBIC], ids=["isotropic", "cubic"])
@pytest.mark.parametrize("element", ["hex27", "tet10"])
def test_linear_field_obeys_hooke(element, material):
    """σxx = E εxx and σyy = σzz = 0 under ε = (1, −ν, −ν)ε; τ = Gγ under simple shear."""
    box = Rectangle(0.1, 0.2)
    mesh = hexahedra(box, 0.4, 1, 2) if element == "hex27" else tetrahedra(box, 0.4, 1)
    x, y, z = mesh.nodes.T
    stretched = 1e-4 * np.column_stack([x, -material.nu * y, -material.nu * z])
    stress = nodal_stresses(mesh, material, stretched)
    expected = [1e-4 * material.E, 0.0, 0.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(
        stress, np.tile(expected, (len(x), 1)), atol=1e-8 * material.E * 1e-4
    )
    np.testing.assert_allclose(von_mises(stress), 1e-4 * material.E, rtol=1e-8)
    sheared = 1e-4 * np.column_stack([z, 0.0 * y, 0.0 * z])
    stress = nodal_stresses(mesh, material, sheared)
    expected = [0.0, 0.0, 0.0, 0.0, 0.0, 1e-4 * material.G]
    np.testing.assert_allclose(
        stress, np.tile(expected, (len(x), 1)), atol=1e-8 * material.G * 1e-4
    )
    np.testing.assert_allclose(von_mises(stress), np.sqrt(3.0) * 1e-4 * material.G, rtol=1e-8)


def solid_field(text, divisions=2):
    """Forces of a robot with one solid leg under one load, and the stress field of the leg."""
    robot = fp.load(tomllib.loads(text))
    analysis = forces(Question(robot, "solid", {"divisions": divisions}), solids=True)
    ((field,),) = (load.solids.values() for load in analysis.poses[0].loads.values())
    return analysis, field


@pytest.fixture(scope="module")
def bar():
    return solid_field(LOADED)


def test_solid_cantilever_has_beam_stress(bar):
    """σxx = N/A + My z/Iy farther than the height from the ends (Saint-Venant)."""
    _, field = bar
    x, _, z = field.mesh.nodes.T
    inside = (x > H) & (x < L - H)
    weight = RHO * B * H * 9.81
    beyond = L - x
    moment = 1000.0 * beyond + weight * beyond**2 / 2.0
    due = 2000.0 / (B * H) + moment * z / (B * H**3 / 12.0)
    error = (field.stresses[:, 0] - due)[inside]
    # Quadratic elements of half the width: stresses to 1 % of the largest.
    assert np.abs(error).max() <= 0.01 * np.abs(due).max()
    # The tip moves as a Timoshenko cantilever's does, to the restraint of the clamp.
    tip = field.displacements[np.isclose(x, L)][:, 2].mean()
    iy = B * H**3 / 12.0
    bent = 1000.0 * L**3 / (3.0 * 2e11 * iy) + weight * L**4 / (8.0 * 2e11 * iy)
    assert -tip == pytest.approx(bent, rel=5e-3)


def test_peak_stress_covers_beam_at_clamp(bar):
    """N/A + M/W at the clamp: with ν = 0 the stress is not singular and that of beam theory."""
    analysis, field = bar
    weight = RHO * B * H * 9.81
    due = 2000.0 / (B * H) + (1000.0 * L + weight * L**2 / 2.0) * 6.0 / (B * H**2)
    # It counts from a tenth of the width on.
    assert field.distance == pytest.approx(0.1 * B)
    at_distance = due - (1000.0 + weight * L) * field.distance * 6.0 / (B * H**2)
    assert field.largest <= 1.02 * due
    assert abs(field.largest - at_distance) <= field.half_width
    assert abs(field.place[2]) == pytest.approx(H / 2.0)
    assert "bar as a solid" in as_text(analysis)


RADIUS, WIDTH, HEIGHT, MOMENT = 0.15, 0.1, 0.04, 300.0
# A quarter circle about (0, R, 0), which starts along x, bent by a couple at its tip.
HOOK = f"""
schema = 2
name = "hook"
points.A = [0.0, 0.0, 0.0]
points.M = [{RADIUS * np.sqrt(0.5)}, {RADIUS * (1.0 - np.sqrt(0.5))}, 0.0]
points.P = [{RADIUS}, {RADIUS}, 0.0]
joints.clamp = {{ type = "fixed", between = ["ground", "hook"], at = "A" }}
tool = {{ body = "hook", point = "P", moves = [] }}
loads = [{{ name = "couple", wrench = [0.0, 0.0, 0.0, 0.0, 0.0, {MOMENT}] }}]
[bodies.hook]
from = "A"
to = "P"
through = [{{ arc = "M" }}]
section = {{ shape = "rectangle", width = {WIDTH}, height = {HEIGHT} }}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
"""


@pytest.fixture(scope="module")
def hook():
    return solid_field(HOOK)[1]


def test_solid_arc_has_stress_of_curved_bar(hook):
    """σ = M (rₙ − r)/A e r with rₙ = h/ln(rₒ/rᵢ), e = R − rₙ (Timoshenko, Strength of Materials).

    In the middle of the arc, the line is parallel to the chord, the x axis of the leg.
    """
    x, y, _ = hook.mesh.nodes.T
    radii, angles = np.hypot(x, y - RADIUS), np.arctan2(x, RADIUS - y)
    middle = np.abs(angles - np.pi / 4.0) < 1e-6
    assert middle.any()
    inner, outer = RADIUS - WIDTH / 2.0, RADIUS + WIDTH / 2.0
    neutral = WIDTH / np.log(outer / inner)
    area, eccentricity = WIDTH * HEIGHT, RADIUS - neutral
    expected = -MOMENT * (neutral - radii) / (area * eccentricity * radii)
    error = (hook.stresses[:, 0] - expected)[middle]
    # Elements of 20 mm. A straight bar has 24 % less at the inside.
    assert np.abs(error).max() < 0.02 * np.abs(expected[middle]).max()
    # A tenth of the section's height, not of the body's.
    assert hook.distance == pytest.approx(HEIGHT / 10.0)


def test_vtu_has_the_fields_of_all_bodies(bar, hook, tmp_path):
    """PyVista reads nodes, displacements, von Mises stresses and numbers of bodies."""
    pyvista = pytest.importorskip("pyvista")
    fields = [bar[1], hook]
    path = tmp_path / "bodies.vtu"
    path.write_bytes(vtu_of(fields))
    grid = pyvista.read(path)
    for key, expected in (
        ("displacement", [field.displacements for field in fields]),
        ("von Mises stress", [von_mises(field.stresses) for field in fields]),
    ):
        np.testing.assert_allclose(np.asarray(grid.point_data[key]), np.concatenate(expected))
    np.testing.assert_allclose(grid.points, np.concatenate([field.mesh.nodes for field in fields]))
    bodies, cells = np.unique(np.asarray(grid.cell_data["body"]), return_counts=True)
    assert bodies.tolist() == [1, 2]
    assert cells.tolist() == [len(field.mesh.cells) for field in fields]


def test_reentrant_corner_nodes_are_excluded():
    """Nodes within a given distance of a corner; without corners none are excluded."""
    nodes = np.array([[0.0, 0.0, 0.0], [0.0, 0.02, 0.0], [1.0, 0.0, 0.0]])
    assert away_from(nodes, np.array([0]), 0.01).tolist() == [False, True, True]
    assert away_from(nodes, np.zeros(0, dtype=int), 0.01).all()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--model", "beam"), "--vtu: the beam model has no stress fields; add --model solid"),
        (("--model", "solid", "--path"), "--vtu: writes one load in one pose"),
    ],
)
def test_vtu_of_two_fields_is_refused(words, message, command, tmp_path):
    """--vtu is for one load in one pose by solids."""
    robot = tmp_path / "arm.toml"
    robot.write_text(LOADED + LOADED[LOADED.index("[[loads]]") :].replace("push", "pull"), "utf-8")
    line = command.error_line("forces", robot, *words, "--vtu", tmp_path / "x.vtu")
    assert message in line
    assert not (tmp_path / "x.vtu").exists()


@pytest.mark.usefixtures("coarse_parts")
def test_cad_part_bends_as_its_sections(tmp_path):
    """σxx = −Mz y/Iz with the section's own Iz in the middle of a tapered arm."""
    robot = write_crane(tmp_path)
    pull = '\n[[loads]]\nname = "pull"\nwrench = [0.0, -500.0, 0.0, 0.0, 0.0, 0.0]\n'
    robot.write_text(robot.read_text("utf-8") + pull, "utf-8")
    question = Question(fp.load(robot), "solid", {})
    forces_of_load = forces(question, solids=True).poses[0].loads["pull"]
    field = forces_of_load.solids["arm"]
    x, y, _ = field.mesh.nodes.T
    inside = (x > 0.15) & (x < 0.3)
    half = 0.060 - 0.1 * (x + 0.045)
    inertia = 0.04 * (2.0 * half) ** 3 / 12.0
    due = 500.0 * (0.4 - x) * y / inertia
    error = (field.stresses[:, 0] - due)[inside]
    # The rms of a coarse mesh; of a taper of 6°, Navier's formula is 2 % off.
    assert np.sqrt(np.mean(error**2)) <= 0.05 * np.abs(due[inside]).max()
    assert field.largest > 0.9 * np.abs(due[inside]).max()
    clamp = next(candidate for candidate in forces_of_load.reactions if candidate.joint == "A")
    assert clamp.wrench[3] == pytest.approx(500.0 * 0.4, rel=1e-6)
    # The drive holds the arm at the axis.
    assert clamp.drive == pytest.approx(clamp.wrench[3], rel=1e-9)


METAL = "{ E = 7.0e10, nu = 0.3, rho = 2700.0 }"
HALF = '{ section = { shape = "rectangle", width = 0.05, height = 0.02 }, material = '
TWO_METALS = f'{HALF}"steel" }}, {HALF}"alloy", at = [0.0, 0.02] }}'
LINE = 'lines = [{ leg = "bar", wrench = [0.0, 0.0, -9.0, 0.0, 0.0, 0.0] }]'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (LOADED + LINE, "--vtu: load push acts along legs"),
        (
            LOADED.replace(BAR, f'section = {{ shape = "composite", parts = [{TWO_METALS}] }}')
            + f"[materials]\nsteel = {METAL}\nalloy = {METAL}\n",
            "--vtu: bar has no stress field, its section has several materials",
        ),
    ],
    ids=["load along leg", "composite"],
)
def test_unknown_stress_field_is_refused_first(text, message, monkeypatch):
    """Refused before anything is solved: the solid of a composite leg has one mean material."""
    monkeypatch.setattr("validation.forces.analysis.forces_in", None)
    with pytest.raises(InputError, match=message):
        solid_field(text)
