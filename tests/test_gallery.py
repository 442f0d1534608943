"""Examples of the gallery, run as scripts and compared with independent numbers.

Sources: docs/guide/known-values.md (computed by other code before this program), closed forms, and
values that other tests check against such sources; each source stands beside its number.
"""

import os
import runpy
from pathlib import Path

import numpy as np
import pytest

from lumped.legs import ConstantLeg, Material
from lumped.sections import HollowRectangle

GALLERY = Path(__file__).resolve().parents[1] / "examples" / "gallery"
SCRIPTS = {int(path.name.split("_")[1]): path for path in GALLERY.glob("plot_*.py")}


@pytest.fixture
def example(tmp_path, monkeypatch):
    """Function that runs an example by its number in an empty folder and returns its variables."""

    def run(number):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setenv("PYTHONPATH", str(GALLERY.parents[1]), prepend=os.pathsep)
        variables = runpy.run_path(str(SCRIPTS[number]))
        assert not list(tmp_path.iterdir()), "an example leaves files behind"
        return variables

    return run


def test_gallery_is_numbered_without_gaps():
    """File names of the examples begin with 1, 2, 3, …"""
    assert sorted(SCRIPTS) == list(range(1, len(SCRIPTS) + 1))
    assert len(SCRIPTS) >= 12


@pytest.mark.exhaustive
def test_paper_robot_has_known_values(example):
    """known-values.md: deflections by VJM at x = 0.4975 m; frequencies of equivalent legs."""
    variables = example(1)
    assert variables["planar"] == pytest.approx([8.81, 4.19], abs=0.005)
    assert variables["along_z"] == pytest.approx(27.2, abs=0.06)
    assert variables["frequencies"] == pytest.approx([113, 184, 213, 355], rel=0.01)


def test_convergence_example_has_formal_orders(example):
    """Timoshenko cantilever (Huang 1961): 181.806 Hz; literal layout, 20 segments: +5.06 %."""
    study = example(2)["study"]
    f2 = study.column("f2")
    for model, layout, order in (("segments", "half", 2), ("beam", "half", 4)):
        assert study.of(model, layout).orders[f2] == pytest.approx(order, abs=0.02)
    literal = study.of("segments", "literal")
    assert literal.errors[literal.counts.index(20), f2] == pytest.approx(0.0506, abs=1e-4)
    assert study.of("beam").limits[f2] == pytest.approx(181.806, abs=5e-4)


@pytest.mark.soak
def test_rigid_faces_change_only_torsion(example):
    """known-values.md: torsion differs by 1.45 % on converged meshes, 0.1 % more on this one."""
    rigid, free = (example(3)["differences"][ends] for ends in ("rigid", "free"))
    assert rigid[3] == pytest.approx(1.5, abs=0.1)
    assert np.abs(np.delete(rigid, 3)).max() < 0.01
    assert np.abs(free).max() < 0.1


def test_three_formulations_agree_on_five_bar(example):
    """Three formulations of the same statics: compliances of 1 µm/N differ by round-off alone."""
    stiffnesses = list(example(4)["stiffness"].values())
    assert stiffnesses == pytest.approx([stiffnesses[0]] * 3, rel=1e-8)


def test_delta_is_isotropic_on_its_axis(example):
    """Threefold symmetry gives equal compliances along x and y and pairs of equal frequencies.

    Each of the six rods spins freely about its axis, which are six idle motions.

    The points of the file have 12 digits.
    """
    variables = example(5)
    centre = variables["centre"]
    assert centre.idle == 6
    assert centre.compliance[0, 0] == pytest.approx(centre.compliance[1, 1], rel=1e-6)
    assert centre.frequencies[0] == pytest.approx(centre.frequencies[1], rel=1e-6)
    # Tubes twice as thick: rods are a small part of the compliance, which can only fall.
    assert 0.9 < variables["gain"][0, 0] < 1.0


@pytest.mark.soak
def test_identified_part_has_mass_of_volume(example):
    """Mass: the CAD kernel's volume times density; bores of a coarse mesh are polygons (0.5 %)."""
    leg = example(6)["leg"]
    assert leg.total == pytest.approx(leg.part.exact.volume * 7850.0, rel=0.005)
    # Averaged interfaces are a lower bound of the stiffness, rigid ones an upper one.
    assert (np.diag(leg.compliance_bracket) > 0.0).all()


def test_strut_buckles_at_euler_load(example):
    """Closed forms of Euler–Bernoulli columns; shear lowers them by less than 0.1 %."""
    variables = example(7)
    stable = variables["stable"]
    assert stable["press"].factor == pytest.approx(variables["euler"], rel=1e-3)
    assert stable["weight"].factor == pytest.approx(variables["greenhill"], rel=1e-3)
    curve = variables["euler"] / np.square(variables["lengths"])
    assert variables["factors"] == pytest.approx(curve, rel=3e-3)


def test_response_peak_is_compliance_over_loss(example):
    """A mode with loss factor η has the peak (static compliance)/η. Other modes add 2 %.

    The drive's mode along x has nearly all strain energy. The static compliance is that of the
    model `links`, an independent formulation.
    """
    import flexproof as fp  # noqa: PLC0415  after the environment of the test is set

    variables = example(8)
    static = fp.solve(variables["arm"], "links").answers[0].compliance[0, 0]
    peak = variables["solution"].answers[0].responses[0].judged[0]
    assert peak == pytest.approx(static / variables["losses"][0], rel=0.05)
    assert (variables["losses"] > 2 * 0.005).all()


@pytest.mark.soak
def test_worst_posture_is_worse_than_grid(example):
    """The worst postures found by the search are at least as bad as all grid points."""
    maps = example(9)["maps"]
    rows = {row[0]: row[3] for row in maps.table().rows}
    assert rows["lowest stiffness"] <= np.nanmin(maps.values("lowest stiffness"))
    assert rows["first frequency"] <= np.nanmin(maps.values("first frequency"))
    assert rows["error of beam-euler-bernoulli"] >= np.nanmax(
        maps.values("error of beam-euler-bernoulli")
    )


@pytest.mark.exhaustive
def test_hammer_test_finds_clamped_bar_modes(example):
    """The "measured" frequency responses were computed for Euler–Bernoulli beams.

    The identification has an error of 0.1 %.
    """
    pytest.importorskip("pyuff")
    compared = example(10)["compared"]
    for mode in ("f1", "f3", "f5"):
        assert compared.entry("beam-euler-bernoulli", mode).error == pytest.approx(0.0, abs=1e-3)
        assert compared.entry("beam", mode).verdict == "adequate"


@pytest.mark.soak
def test_best_design_is_inside_range(example):
    """Compliances of drive and arm, L²/k + L³/3EI by Euler–Bernoulli, for each width of the arm."""
    designs = example(11)["designs"]
    assert designs.best("deflection") == 0.05
    assert designs.best("frequency") == 0.04
    assert designs.loss("beam", "frequency") == 0.0
    statics = designs.decisions["deflection"].models["beam-euler-bernoulli"]
    width = np.array(designs.variation.values)
    # µm under 1000 N: the drive, L²/k, and the arm, L³/3EI, in its plane; z deflects less.
    in_plane = 0.3**2 / 2.0e4 + 0.3**3 / (3.0 * 7.0e10 * 0.04 * width**3 / 12.0)
    assert statics == pytest.approx(1e9 * in_plane, rel=1e-6)


@pytest.mark.soak
def test_pytest_example_fails_for_rigid_legs(example):
    """Only the item of the simplified model's deflection along z fails."""
    items = example(12)["items"]
    assert [name for name, outcome in items.items() if outcome != "PASSED"] == [
        "arm.toml::simplified::z"
    ]
    assert len(items) > 8


@pytest.mark.exhaustive
def test_exudyn_finds_exported_frequencies(example):
    """EXUDYN runs the exported script. Its frequencies are those in the script's heading."""
    pytest.importorskip("exudyn")
    variables = example(13)
    header = [line.split() for line in variables["text"].splitlines() if line.startswith("#     ")]
    assert variables["exudyn"] == pytest.approx([float(words[1]) for words in header], rel=1e-6)
    # Legs of prismatic tubes: beams are within the 2 % of held end faces.
    assert variables["beam"] == pytest.approx(variables["exudyn"], rel=0.025)


def test_arm_of_two_materials_sums_stiffness(example):
    """Cantilever deflection L³/(3 EI) + L/(κGA), with EI summed over the parts of the section.

    Shear contributes up to 3 %. The box is filled: EI of steel and of concrete about the common
    centroid. The tube has Q̄ of Tsai and Hahn's table 1.7, half of the layers at 0° (E1) and half
    at ±45° (25.05 GPa).
    """
    variables = example(14)
    length = 0.6
    second = (0.06 * 0.08**3 - 0.052 * 0.072**3) / 12.0
    core, rail = 0.052 * 0.072**3 / 12.0, 0.02 * 0.015**3 / 12.0
    stiffnesses = {"box": 2.1e11, "core": 3.5e10}
    areas = {"box": 0.06 * 0.08 - 0.052 * 0.072, "core": 0.052 * 0.072, "rail": 0.02 * 0.015}
    EA = 2.1e11 * (areas["box"] + areas["rail"]) + 3.5e10 * areas["core"]
    centre = 2.1e11 * areas["rail"] * 0.0475 / EA
    filled = (
        stiffnesses["box"] * (second + areas["box"] * centre**2)
        + stiffnesses["core"] * (core + areas["core"] * centre**2)
        + 2.1e11 * (rail + areas["rail"] * (0.0475 - centre) ** 2)
    )
    radius, wall = 0.029, 0.002
    # Strains around the tube are common to all layers: between the sum of both and 5 % above it.
    carbon = np.pi * radius**3 * wall * (181e9 + 25.05e9) / 2.0
    for name, EI, slack in (
        ("steel box", 2.1e11 * second, 0.05),
        ("filled box", filled, 0.05),
        ("carbon tube", carbon, 0.12),
    ):
        bending = length**3 / (3.0 * EI)
        assert variables["compliances"][name] == pytest.approx(bending, rel=slack)
    assert variables["frequencies"]["carbon tube"] > 1.5 * variables["frequencies"]["filled box"]


@pytest.mark.exhaustive
def test_free_rocker_counts_six_rigid_motions(example):
    """Mass: the CAD kernel's volume times density; bores of a coarse mesh are polygons (0.5 %)."""
    rocker = example(15)["rocker"]
    assert rocker.rigid == 6
    assert rocker.total == pytest.approx(rocker.part.exact.volume * 7850.0, rel=0.005)
    assert rocker.counted >= 4


def test_press_forces_equal_slider_crank(example):
    """Hand result: rod F/cos β, motor F r sin(φ + β)/cos β, guide F tan β; stress N/A + T/W."""
    variables = example(16)
    by_hand, members, reactions = variables["by_hand"], variables["members"], variables["reactions"]
    assert members["rod"].forces[:, 0] == pytest.approx(by_hand["rod"], rel=1e-9)
    assert abs(reactions["motor"].drive) == pytest.approx(by_hand["motor"], rel=1e-9)
    guide = np.linalg.norm(reactions["guide"].wrench[:3])
    assert guide == pytest.approx(by_hand["guide"], rel=1e-9)
    stresses = variables["found"].stresses
    area = np.pi / 4.0 * (0.03**2 - 0.02**2)
    # Parabolas instead of arcs: 1e-4 of the area.
    assert stresses["rod"].largest == pytest.approx(-by_hand["rod"] / area, rel=1e-3)
    axial = abs(members["crank"].forces[0, 0])
    bending = 6.0 * by_hand["motor"] / (0.02 * 0.04**2) + axial / (0.02 * 0.04)
    # The shear stress of the crank vanishes where it bends most.
    assert stresses["crank"].largest == pytest.approx(bending, rel=1e-3)


def test_catalogue_joints_are_springs_in_series(example):
    """Along x: screw L/EA + nut + bearing, carriage tilt l²/k_pitch, column l³/3EI + l/κGA."""
    variables = example(17)
    height, side, E = 0.25, 0.08, 2.1e11
    shear = 10.0 * 1.3 / (12.0 + 11.0 * 0.3) * E / 2.6 * side**2
    column = height**3 / (3.0 * E * side**4 / 12.0) + height / shear
    shaft = (variables["poses"] - 0.1) / (2.06e11 * np.pi * 0.02113**2 / 4.0)
    nut = 0.8 * 490e6 * (1200.0 / 1643.0) ** (1.0 / 3.0)
    pitch = 539e6 * 0.058**2 / 12.0
    expected = shaft + 1.0 / nut + 1.0 / 450e6 + height**2 / pitch + column
    assert variables["along_x"] == pytest.approx(expected, rel=1e-8)
    tool, slide = variables["middle"].answers[0].responses
    assert 0.0 < slide.judged[0] < 0.5 * tool.judged[0]


def test_tapered_arm_converges_to_its_solid(example):
    """Segments have order 2, the solid free ends. A beam on a curve has an error of (h/2R)²."""
    variables = example(18)
    f1 = variables["study"].column("f1")
    assert variables["study"].of("segments").orders[f1] == pytest.approx(2, abs=0.05)
    beams = variables["study"].of("beam")
    assert beams.values[-1, f1] == pytest.approx(beams.limits[f1], rel=1e-7)
    beam, solid = variables["deflections"].values()
    assert beam == pytest.approx(solid, rel=0.0136)
    (pose,) = variables["forces"].poses
    (member,) = pose.loads["push"].members
    # At the root A, from the force (0, −500, −200) N on P = (0.6, 0.3, 0) m.
    assert member.forces[0] == pytest.approx([0.0, -500.0, -200.0, -60.0, 120.0, -300.0], abs=1e-6)


def test_load_along_leg_equals_closed_form(example):
    """Load w from a to L on a cantilever: w (3L⁴ − 4a³L + a⁴)/24EI + w (L² − a²)/2κGA."""
    variables = example(19)
    L, a = variables["length"], variables["start"]
    leg = HollowRectangle(0.08, 0.06, 0.004)
    steel = ConstantLeg(L, leg, Material.isotropic(7.0e10, 0.33, 2700.0)).timoshenko
    for name, w, start in (("chain", 60.0, a), ("weight", 9.81 * 2700.0 * leg.area, 0.0)):
        bending = w * (3.0 * L**4 - 4.0 * start**3 * L + start**4) / (24.0 * steel.EIy)
        shear = w * (L**2 - start**2) / (2.0 * steel.GAz)
        assert list(variables["sag"][name].values()) == pytest.approx(
            [-bending - shear] * 2, rel=1e-9
        )
    wrench = np.abs(variables["clamp"].wrench)
    assert wrench[[2, 4]] == pytest.approx([60.0 * (L - a), 30.0 * (L**2 - a**2)], rel=1e-9)


def test_lever_about_shear_centre_is_thin_walled(example):
    """Channel: the lever is 3b²/(6b + h) beyond the middle of the web, plus that to the centroid.

    That of an angle lies where the middle lines of its flange and web meet. A tee and a Z profile
    have it in the plane of the force. The arm is equal by its section constants but for shear.
    """
    variables = example(20)
    levers, wall = variables["levers"], 0.006
    b, h = 0.05 - 0.5 * wall, 0.1 - wall
    channel = 3.0 * b**2 / (6.0 * b + h) + variables["centre"] - 0.5 * wall
    assert levers["channel"] == pytest.approx(channel, rel=0.01)
    flange, web = 0.05 * wall, (0.1 - wall) * wall
    angle = flange * (0.025 - 0.5 * wall) / (flange + web)
    assert levers["angle"] == pytest.approx(angle, rel=0.03)
    assert np.abs([levers["tee"], levers["Z profile"]]).max() < 1e-9
    by_constants = variables["by_constants"]
    outline = variables["matrices"]["channel"]
    assert by_constants[3, 2] == pytest.approx(outline[3, 2], rel=1e-6)
    # Without shear areas the leg has no shear deformation.
    assert 0.95 < by_constants[2, 2] / outline[2, 2] < 1.0


@pytest.mark.exhaustive
def test_copies_of_leg_are_springs_in_series(example):
    """Along z 1/3k + L/(6 EA cos²θ); equal along x and y by threefold symmetry."""
    variables = example(21)
    assert variables["z"] == pytest.approx(variables["by_hand"], rel=1e-8)
    assert variables["x"] == pytest.approx(variables["y"], rel=1e-8)


@pytest.mark.exhaustive
def test_pressure_has_resultant_of_its_face(example):
    """Force p L b and moment p L² b/2 at the hinge; deflection of a beam less 2 %."""
    variables = example(22)
    wrench = np.abs(variables["hinge"].wrench)
    assert wrench[[2, 4]] == pytest.approx(
        [2.0e5 * 0.3 * 0.03, 2.0e5 * 0.3**2 * 0.03 / 2], rel=1e-6
    )
    assert 0.975 < variables["sag"] / variables["beam"] < 1.0


@pytest.mark.exhaustive
def test_lightest_stiff_arm_is_chosen(example):
    """L²/k + L³/3EI and L³/3EI of each arm, by Euler–Bernoulli: shear adds less than 2 %."""
    choice = example(23)["choice"]
    width, height = np.meshgrid(*[np.arange(20.0, 51.0, 10.0) * 1e-3] * 2, indexing="ij")
    bending = 1e3 * 0.3**3 / (3.0 * 7.0e10 * width * height / 12.0)
    stiff = (1e3 * 0.3**2 / 2.0e4 + bending / width**2 <= 7e-3) & (bending / height**2 <= 1e-3)
    assert choice[0].startswith(f"{np.count_nonzero(stiff)} of 16 robots meet ")
    mass = 2700.0 * 0.3 * np.where(stiff, width * height, np.inf) + 1.0
    lightest = np.unravel_index(np.argmin(mass), mass.shape)
    sizes = f"width={1e3 * width[lightest]:g}, bodies.arm.section.height={1e3 * height[lightest]:g}"
    assert choice[1].startswith(f"least mass: bodies.arm.section.{sizes} (mass {mass.min():.4g} kg")
