"""Ten ordinary robots: a run fails only because of a finding about the robot."""

from pathlib import Path

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of

from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.robot_file import load_robot
from validation import api
from validation.case import Skip
from validation.cases import leg_theory, other_solvers
from validation.comparisons import robot_beam_vs_solid
from validation.context import Context

ROBOTS = Path(__file__).parents[2] / "support" / "robots" / "practice"
NAMES = sorted(path.stem for path in ROBOTS.glob("*.toml"))


def test_ten_practice_robots_are_valid():
    """Ten files with ten different names."""
    assert len(NAMES) == 10
    names = {load_robot(ROBOTS / f"{name}.toml").mechanism.name for name in NAMES}
    assert len(names) == 10


@pytest.mark.parametrize("name", NAMES)
def test_links_and_beams_have_equal_statics(name):
    """Both models are exact for prismatic and tapered legs that are loaded at their ends only."""
    links, beam = (
        api.solve(ROBOTS / f"{name}.toml", model).answers[0].compliance
        for model in ("links", "beam")
    )
    diagonal = np.diag(beam)
    # Round-off is 1e-11, of thin leaves and of soft legs on stiff joints.
    assert np.abs((links - beam) / np.sqrt(np.outer(diagonal, diagonal))).max() <= 1e-8


def test_thin_leaf_is_skipped_by_wave_cases(monkeypatch):
    """Waves in its section of 0.5 by 20 mm take minutes, and its solid is too large."""

    def unaffordable(*_):
        raise AssertionError("waves of a section without solids")

    monkeypatch.setattr(leg_theory, "prism_waves", unaffordable)
    context = Context(load_robot(ROBOTS / "leaf-stage.toml"), "quick")
    cases = {case.id: case for case in leg_theory.cases(legs=("leaf1",))}
    for mode in range(1, leg_theory.MODES + 1):
        with pytest.raises(
            Skip, match="two solid meshes of the section of leaf1 have more than 9000"
        ):
            cases[f"leaf1.frequency.solid[{mode}]"].measure(context)


def waves_and_solids(*_):
    raise Skip("waves are computed")


@pytest.mark.parametrize(
    ("width", "reason"),
    [
        (
            0.0005,
            r"leaf1: strip wider than a tenth of its length; .* bends as a plate near its ends",
        ),
        # A bar of 5 by 20 mm.
        (0.005, "waves are computed"),
    ],
)
def test_strips_have_no_wave_correction(monkeypatch, width, reason, tmp_path):
    """Leaves of 0.5 by 20 mm bend as plates near their ends.

    Leaves 5 mm thick have a correction.
    """
    monkeypatch.setattr(robot_beam_vs_solid, "robot_modes", waves_and_solids)
    text = (ROBOTS / "leaf-stage.toml").read_text(encoding="utf-8")
    robot = robot_of(text.replace("width = 0.0005", f"width = {width}"), tmp_path)
    corrections = [
        case
        for case in robot_beam_vs_solid.cases(limits=DEFAULT_LIMITS)
        if case.id.startswith("robot.agrees[") and "-solid-f" in case.id
    ]
    assert len(corrections) == 8
    for case in corrections:
        with pytest.raises(Skip, match=reason):
            case.measure(Context(robot, "quick"))


@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam"])
def test_leaf_stage_deflects_as_guided_leaves(model):
    """Along x: L³/24EI = 205.7 µm/N, with both leaf ends kept parallel (Euler–Bernoulli).

    Shear adds L/2κGA (κ by Cowper). The stage tilts, because its leaves, at a distance d, are
    pulled and pushed: this adds L³/2EAd².
    """
    length, spacing, width, height, nu = 0.06, 0.05, 0.0005, 0.02, 0.3
    area, kappa = width * height, 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
    bending = length**3 / (24.0 * 2.1e11 * height * width**3 / 12.0)
    shear = length / (2.0 * kappa * 2.1e11 / (2.0 * (1.0 + nu)) * area)
    tilt = length**3 / (2.0 * 2.1e11 * area * spacing**2)
    assert bending == pytest.approx(205.7e-6, rel=1e-4)
    (answer,) = api.solve(ROBOTS / "leaf-stage.toml", model).answers
    # Round-off is 1e-10.
    assert answer.compliance[0, 0] == pytest.approx(bending + shear + tilt, rel=1e-8)


@pytest.mark.parametrize(
    ("robot", "reason"),
    [
        ("leaf-stage", "9600 in the mesh; the comparison allows at most 2000"),
        ("packaging-delta", "laminates cannot be modelled in CalculiX"),
    ],
)
def test_unsuitable_robots_skip_calculix(robot, reason, monkeypatch):
    """Nothing is computed before the comparison is skipped.

    Bars of 0.5 by 20 mm have 430,000 unknowns, for which CalculiX needs more than its limit of ten
    minutes. Models in CalculiX have isotropic bars of one material.
    """
    for name in ("calculix_solids", "reduced_solids"):
        monkeypatch.setattr(other_solvers, name, lambda _: pytest.fail("is computed"))
    context = Context(load_robot(ROBOTS / f"{robot}.toml"), "standard")
    cases = [
        case
        for case in other_solvers.cases(mechanism=context.robot_file.mechanism)
        if case.group == "mechanism.calculix"
    ]
    assert len(cases) == 2
    for case in cases:
        with pytest.raises(Skip, match=reason):
            case.measure(context)


# The runs take a minute each.
@pytest.mark.soak
@pytest.mark.parametrize("preset", ["quick", "standard"])
@pytest.mark.parametrize("name", NAMES)
def test_practice_robot_run_has_no_failure(name, preset, tmp_path):
    """Exit code 0 and more than 20 agreements for each robot and preset."""
    results = api.run(ROBOTS / f"{name}.toml", out=tmp_path / "report", preset=preset)
    assert results.exit_code == 0
    assert not {"disagree", "failed"} & results.verdicts.keys()
    assert results.verdicts["agree"] > 20
