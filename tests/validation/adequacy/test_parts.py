"""Runs of robots with CAD parts: what each idealisation of a part costs against its solid."""

from dataclasses import replace
from pathlib import Path

import pytest
from crane import write_crane

from lumped.mechanism.body import Body, ByCylinder, PartInterface
from lumped.robot_file import load_robot
from validation.adequacy.mechanism.parts import reduction_note, solid_parts
from validation.adequacy.mechanism.path import holding, path_postures
from validation.adequacy.models import JUDGED, judged_models, why_unable
from validation.adequacy.robot import robot_adequacy
from validation.cases import solids
from validation.context import Context
from validation.models import parts
from validation.results.outcome import judge


@pytest.fixture(scope="module", autouse=True)
def coarsest(coarse_parts):
    """Meshes so coarse that they are next to nothing beside reading the part."""
    coarse_parts.setattr(parts, "UNKNOWNS", 1500)


@pytest.fixture(scope="module")
def robot_file(tmp_path_factory):
    return load_robot(write_crane(tmp_path_factory.mktemp("crane")))


@pytest.fixture(scope="module")
def matrix(robot_file):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parts, "UNKNOWNS", 12_000)
        return robot_adequacy(Context(robot_file, "quick"))


@pytest.mark.exhaustive
def test_the_equivalent_leg_of_a_tapered_arm_is_far_too_soft(robot_file, matrix):
    assert [note.model for note in matrix.models] == list(judged_models(robot_file.mechanism))
    entry = matrix.entry("segments", "z")
    assert entry.verdict == "inadequate"
    assert entry.error > 0.1
    assert entry.causes[0].cause == "one constant section instead of the part"
    assert "--parts" in entry.remedy
    assert abs(entry.error_with_remedy) < abs(entry.error)
    # Its own sections, ten times along it, are nearer, on the other side: rigid up to the bores'
    # edges, where the part begins to yield.
    assert -entry.error < matrix.entry("segments-stepped", "z").along < 0.0
    assert matrix.entry("beam", "f1").error < -0.05


@pytest.mark.exhaustive
def test_what_is_condensed_is_the_solid_within_what_is_open(matrix):
    for model in ("vjm", "links", "segments-condensed"):
        for quantity in ("x", "y", "z"):
            entry = matrix.entry(model, quantity)
            # Held rigidly the part is stiffer than averaged: half of what lies between is the
            # error, the other half its uncertainty; the meshes' part comes on top.
            assert -entry.uncertainty <= entry.along <= 0.0, (model, quantity)
            assert set(entry.uncertainties) == {"meshes", "how the parts' interfaces are held"}
    first = matrix.entry("segments-condensed", "f1")
    # Guyan's mass adds its own, little where most of the mass sits on the tool.
    assert abs(first.error) <= first.uncertainty + 5e-3


def test_what_the_file_says_of_the_faces_is_not_open(robot_file):
    mechanism = robot_file.mechanism
    assert list(holding(mechanism).alternatives) == ["interfaces rigid", "interfaces averaged"]
    arm = mechanism.bodies["arm"]
    radii = {"A": 0.016, "B": 0.010}
    said = {name: PartInterface(ByCylinder(radius), "rigid") for name, radius in radii.items()}
    body = Body("arm", replace(arm.shape, interfaces=said), arm.interfaces)
    settled = holding(replace(mechanism, bodies=dict(mechanism.bodies) | {"arm": body}))
    assert (settled.unsaid, settled.decides) == ("", "")
    assert list(settled.alternatives) == ["interfaces as given"]


def test_the_page_says_what_the_reduction_kept_and_what_that_leaves(robot_file):
    postures = path_postures(Context(robot_file, "quick"))
    (note,) = reduction_note(postures, 8, {"arm": "rigid"}, 4)
    (arm,) = solid_parts(postures, 8, {"arm": "rigid"}).values()
    assert f"arm {arm.counted} below {arm.cutoff:.4g} Hz; higher ones lower" in note
    # Reduced for eight frequencies, of the first four next to nothing is lost.
    assert note.endswith("frequencies by <\u00a01\u00a0×\u00a010⁻⁶\u00a0% at most")


def test_held_and_free_modes_of_parts_are_compared_in_a_run(robot_file):
    """Within both bounds, which are worth something."""
    listed = {case.id: case for case in solids.cases(mechanism=robot_file.mechanism)}
    case = listed["mechanism.parts.frequency[2]"]
    found = case.compute(Context(robot_file, "quick"))
    assert judge(case, found, 0.0).verdict == "agree"
    assert 0.0 < found.value_uncertainty + found.reference_uncertainty < 1e-3 * found.value


def test_a_part_of_three_interfaces_is_no_leg_to_be_stepped():
    robot_file = load_robot(str(Path(__file__).parents[3] / "examples" / "rocker" / "robot.toml"))
    said = why_unable(path_postures(Context(robot_file, "quick")), JUDGED["segments-stepped"])
    assert said.startswith("no part has exactly two interfaces")
