"""What is asked of models: defaults, options of the command line, tables of robot files."""

import tomllib
from pathlib import Path

import pytest
from sound_biglide import SOUND

from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.robot_file.evidence import requirement_of, with_options
from lumped.robot_file.load import described_by


def test_five_per_cent_of_everything_is_asked_by_default() -> None:
    requirement = Requirement()
    assert requirement.quantities == (
        *("x", "y", "z", "phi_x", "phi_y", "phi_z", "any_force"),
        *("f1", "f2", "f3", "f4", "order"),
    )
    assert {requirement.limit(quantity) for quantity in requirement.quantities} == {0.05}


def test_options_change_the_files_requirement() -> None:
    asked = with_options(
        Requirement(rely=("beam",)),
        ("deflection=0.03", "frequency=0.1", "modes=2", "phi_x=0.5", "order=0.2"),
        ("vjm", "segments"),
    )
    assert [asked.limit(q) for q in ("x", "phi_x", "f2", "order")] == [0.03, 0.5, 0.1, 0.2]
    assert asked.modes == 2
    assert asked.rely == ("vjm", "segments")
    assert with_options(Requirement(rely=("beam",)), (), ()).rely == ("beam",)


@pytest.mark.parametrize(
    "given", ["deflction=0.1", "x", "x=", "x=five", "x=5", "x=0", "x=nan", "modes=0", "modes=2.5"]
)
def test_options_that_mean_nothing_are_refused(given: str) -> None:
    with pytest.raises(InputError) as refused:
        with_options(Requirement(), (given, "y=1e9"), ("vjmm",))
    assert len(refused.value.faults) == 3
    assert any(given in fault for fault in refused.value.faults)


def test_a_robot_file_says_what_is_accepted_and_how_ends_are_held() -> None:
    tables = tomllib.loads(SOUND)
    tables["accept"] = {"deflection": 0.02, "z": 0.2, "modes": 6, "rely": ["vjm", "segments"]}
    tables["leg1"]["ends"] = "rigid"
    mechanism, read = described_by(tables, Path())
    requirement = requirement_of(read["accept"], mechanism)
    assert [requirement.limit(q) for q in ("y", "z", "f6")] == [0.02, 0.2, 0.05]
    assert requirement.rely == ("vjm", "segments")
    leg1 = mechanism.bodies["leg1"].shape
    assert isinstance(leg1, ConstantLeg)
    assert leg1.ends == "rigid"
