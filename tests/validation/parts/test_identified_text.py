"""What identification writes for people and robot files; numbers made up to be told apart."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lumped.mechanism.placing import leg_frame
from lumped.screws import turn_matrix
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.parts.identified_text import as_text, toml
from validation.parts.identify import Identified

# Leads along no axis of the file.
ENDS = (np.array([0.1, 0.2, -0.1]), np.array([0.4, 0.6, 0.3]))


@pytest.fixture
def found():
    part = PartFile(Path("arm.step"), "mm", [0.5, 0.6, 0.4], np.zeros((0, 3)), (), None, None)
    interfaces = tuple(
        Interface(name, (number,), point, "rigid", "as asked for", None, None, 1.0)
        for number, (name, point) in enumerate(zip("AB", ENDS, strict=True), start=1)
    )
    root = np.random.default_rng(5).normal(size=(6, 6))
    C = 1e-8 * (root @ root.T + np.eye(6))
    return Identified(
        part=part, interfaces=interfaces, density=7850.0, total=12.5, centre=np.zeros(3),
        inertia=np.eye(3), stiffness=np.zeros((12, 12)), mass=np.zeros((12, 12)), compliance=C,
        frequencies=np.array([200.0]), compliance_refinement=0.01 * C,
        frequency_refinement=np.array([0.5]), compliance_bracket=0.03 * C,
        frequency_bracket=np.array([-4.0]), counted=1, counted_below=205.0,
        unknowns=(10, 20, 30), elements=7, straightened=0,
        places=np.zeros((0, 3)), shares=np.zeros(0), shapes=np.zeros((0, 12)),
    )  # fmt: skip


def test_the_table_for_a_robot_file_is_the_part_in_the_axes_that_it_names(found):
    leg = tomllib.loads(toml(found))["bodies"]["arm"]
    assert (leg["from"], leg["to"], leg["mass"]) == ("A", "B", 12.5)
    # As a robot file is read: x from point to point, z as near to "up" as it can be.
    axes = leg_frame(*ENDS, np.array(leg["up"])).rotation
    read = turn_matrix(np.array(leg["compliance"]), axes)
    assert read == pytest.approx(found.compliance, rel=1e-8, abs=1e-16)
    # With another direction up it is another leg.
    other = turn_matrix(np.array(leg["compliance"]), leg_frame(*ENDS, np.ones(3)).rotation)
    assert other != pytest.approx(found.compliance, rel=1e-3, abs=1e-16)


def test_people_read_both_uncertainties_in_percent(found):
    lines = as_text(found).splitlines()
    (row,) = (line.split() for line in lines if line.startswith("  B φz"))
    assert float(row[2]) == pytest.approx(found.compliance[5, 5], rel=1e-5)
    assert row[3:] == ["±", "1.000", "%", "3.000", "%"]
    assert "  1          200.00  ±    0.250 %    -2.000 %" in lines
    said = "frequencies with A clamped (Hz); 1 counted below 205 Hz, none missing; columns as above"
    assert said in lines
    unknown = as_text(replace(found, frequency_refinement=np.array([np.nan])))
    (row,) = (line.split() for line in unknown.splitlines() if line.startswith("  1 "))
    assert row == ["1", "200.00", "±", "–", "-2.000", "%"]
