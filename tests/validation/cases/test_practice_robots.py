"""Ten ordinary robots of practice: none fails a run without a finding about the robot."""

from pathlib import Path

import pytest

from lumped.robot_file import load_robot
from validation import api
from validation.case import Skip
from validation.cases import legs, other_programs
from validation.context import Context

ROBOTS = Path(__file__).parents[2] / "helpers" / "robots" / "practice"
NAMES = sorted(path.stem for path in ROBOTS.glob("*.toml"))


def test_ten_robots_are_read():
    assert len(NAMES) == 10
    names = {load_robot(ROBOTS / f"{name}.toml").mechanism.name for name in NAMES}
    assert len(names) == 10


def test_thin_leaf_is_skipped_without_its_waves(monkeypatch):
    """Waves on its section of 0.5 by 20 mm take minutes, and no solid of it is affordable."""

    def unaffordable(*_):
        raise AssertionError("waves of a section without solids")

    monkeypatch.setattr(legs, "prism_waves", unaffordable)
    context = Context(load_robot(ROBOTS / "leaf-stage.toml"), "quick")
    cases = {case.id: case for case in legs.cases(legs=("leaf1",))}
    for mode in range(1, legs.MODES + 1):
        with pytest.raises(Skip, match="two solid meshes of this section have more than 9000"):
            cases[f"leaf1.frequency.solid[{mode}]"].measure(context)


def test_strips_are_too_many_tetrahedra_for_calculix(monkeypatch):
    """Bars of 0.5 by 20 mm have 430,000 unknowns, which take it more than its ten minutes."""
    for name in ("by_calculix", "by_reduced"):
        monkeypatch.setattr(other_programs, name, lambda _: pytest.fail("is computed"))
    context = Context(load_robot(ROBOTS / "leaf-stage.toml"), "standard")
    cases = [
        case
        for case in other_programs.cases(mechanism=context.robot_file.mechanism)
        if case.group == "mechanism.calculix"
    ]
    assert len(cases) == 2
    for case in cases:
        with pytest.raises(Skip, match="fill 9600 cubes; CalculiX solves at most 2000"):
            case.measure(context)


@pytest.mark.parametrize(
    "preset",
    [
        pytest.param("quick", marks=pytest.mark.exhaustive),
        pytest.param("standard", marks=pytest.mark.soak),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_run_of_practice_robot_finds_no_fault(name, preset, tmp_path):
    results = api.run(ROBOTS / f"{name}.toml", out=tmp_path / "report", preset=preset)
    assert results.exit_code == 0
    assert not {"disagree", "failed"} & results.verdicts.keys()
    assert results.verdicts["agree"] > 20
