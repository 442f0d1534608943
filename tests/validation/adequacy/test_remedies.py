"""Reasons and remedies for verdicts that cannot be decided."""

import re
from dataclasses import replace
from json import dumps
from types import SimpleNamespace

import numpy as np
import pytest
from support.fakes.toy_responses import meshes, reference
from support.fakes.toy_responses import model as toy_model
from support.robots.crane import write_crane
from support.robots.paper_robot_variants import file_of, variant_of_ifw
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from fem.sections.section_constants import section_constants
from lumped.acceptance.requirement import Requirement
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism import biglide
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.robot_file.rules.published import json_schema
from lumped.sections import HollowRectangle, Rectangle, Tube
from meshes.section.section_mesh import section_mesh
from validation import cli
from validation.adequacy.judgement import REST, verdict_matrix
from validation.adequacy.robot_verdicts import finer_context, leg_subject, robot_adequacy
from validation.context import Context
from validation.models.options import MODELS
from validation.references import model_ladder, modes_on_path
from validation.references.modal_reference import all_modal_steps
from validation.references.model_ladder import EQUIVALENT
from validation.references.reference import (
    NOT_FINER,
    USE_SOLID,
    Reference,
    Subject,
    finer_by,
)
from validation.references.reference_parts import FINER_PARTS
from validation.references.responses import Responses
from validation.references.robot_on_path import holding, robot_at
from validation.references.static_reference import all_static_steps
from validation.responses.statics_and_modes import Statics
from validation.solids.leg_meshes import COARSEST_WALLS
from validation.solids.solid_size import larger_preset
from validation.verdicts import Coordinate

pytestmark = pytest.mark.usefixtures("coarse_legs")


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Robot file of one arm in one pose. Its end condition is specified: one reference, not two."""
    text_with_ends = ONE_ARM.replace("height = 0.04 }", 'height = 0.04 }\nends = "rigid"')
    short = text_with_ends.replace("nu = 0.0", "nu = 0.3").replace("P = [0.0, 0.5", "P = [0.0, 0.2")
    # So little is accepted that what held ends take from beams has to be explained.
    text = f"{short}deflection = 1e-3\n[path]\nposes = [[0.0]]\n"
    return robot_of(text, tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def sound(arm):
    return robot_adequacy(Context(arm, "quick"))


def refusing(monkeypatch, module, function, refused=lambda _: True):
    """Make `function` of the module raise ComputationError if `refused(first argument)`."""
    original = getattr(module, function)

    def refuse(*args, **kwargs):
        if refused(args[0]):
            raise ComputationError(f"{args[0]} refused: lost in rounding")
        return original(*args, **kwargs)

    monkeypatch.setattr(module, function, refuse)


def test_unsolved_model_keeps_other_verdicts(monkeypatch, arm, sound):
    """Segments without a solution are undecided, with the reason."""
    refusing(monkeypatch, model_ladder, "answers", lambda model: model == "segments")
    refusing(monkeypatch, modes_on_path, "with_dynamic_bodies", lambda model: model == "segments")
    matrix = robot_adequacy(Context(arm, "quick"))
    for entry, sound_entry in zip(matrix.entries, sound.entries, strict=True):
        if entry.model.startswith("segments"):
            assert entry.verdict == "undecided"
            assert entry.reason == f"{entry.model}: segments refused: lost in rounding"
        else:
            assert entry == sound_entry


def test_unsolved_step_leaves_remaining_error(monkeypatch, arm, sound):
    """If a model between model and reference is unsolved, the remaining error has no cause."""
    refusing(monkeypatch, model_ladder, "computed_spring")
    matrix = robot_adequacy(Context(arm, "quick"))
    for entry, sound_entry in zip(matrix.entries, sound.entries, strict=True):
        assert (entry.verdict, entry.error) == (sound_entry.verdict, sound_entry.error)
    causes = [entry.causes for entry in matrix.of_model("beam") if not entry.signed]
    rests = [
        cause.source for entry_causes in causes for cause in entry_causes if cause.cause == REST
    ]
    assert rests
    assert all("refused: lost in rounding" in source for source in rests)


STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
SOUND = ConstantLeg(0.8, Rectangle(0.1, 0.06), STEEL, ends="rigid")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"section": Tube(0.12, 5e-5)}, "leg2: the coarsest section mesh of its tube has"),
        (
            {"material": Material.isotropic(2.1e11, 0.4999999999999, 7850.0)},
            "lost in rounding of the stiffness of solid elements",
        ),
    ],
    ids=["walls too thin", "incompressible"],
)
def test_leg_without_solid_keeps_other_leg_verdicts(changed, message):
    """All verdicts on the robot are undecided. Those on the other leg alone are not affected."""
    legs = {"leg1": SOUND, "leg2": replace(SOUND, **changed)}
    robot = variant_of_ifw(a=0.9, platform_mass=30.0, foot_compliance=None, **legs)
    robot = replace(robot, poses=robot.poses[4:5])
    matrix = robot_adequacy(Context(file_of(robot), "quick"))
    statics = [entry for entry in matrix.entries if entry.quantity.name in ("x", "z", "phi_x")]
    assert {entry.model for entry in statics} >= {"simplified", "vjm", "segments", "beam"}
    assert {entry.verdict for entry in matrix.entries} == {"undecided"}
    assert all(message in entry.reason for entry in statics)
    sound, other = matrix.parts
    assert {entry.verdict for entry in sound.entries} >= {"adequate"}
    assert {entry.verdict for entry in other.entries} == {"undecided"}


def test_open_joints_raise_error(monkeypatch, tmp_path):
    """Wrong inverse kinematics (angles 0.1 % too large) would give wrong verdicts."""
    sound = biglide.rotation_z
    monkeypatch.setattr(biglide, "rotation_z", lambda angle: sound(1.001 * angle))
    with pytest.raises(ComputationError, match="leaves the joints open"):
        robot_adequacy(Context(robot_of(load_robot("ifw").text, tmp_path), "quick"))


@pytest.mark.exhaustive
def test_single_section_mesh_is_uncertain():
    """Both solids have the coarsest section mesh, whose torsion is uncertain by 0.5 %."""
    section = HollowRectangle(width=0.06, height=0.06, thickness=0.006)
    leg = ConstantLeg(0.9, section, STEEL, ends="free")
    subject = leg_subject(Context(load_robot("ifw"), "quick"), "leg1", leg)
    half_width = (
        verdict_matrix(subject, Requirement()).entry("beam", "phi_x").uncertainties["meshes"]
    )
    coarse, fine = (
        section_constants(section_mesh(section, number), 0.3).torsion_constant
        for number in (COARSEST_WALLS, 8)
    )
    # Roache's factor three for two meshes of the lowest order there can be, 4/3.
    due = 3.0 / ((8 / COARSEST_WALLS) ** (4 / 3) - 1.0) * abs(fine / coarse - 1.0)
    assert due <= half_width <= 1.1 * due


def judged_by(arm, preset, accuracy=None, limit=0.05, **limits):
    requirement = replace(arm.requirement, deflection=limit, accuracy=accuracy, limits=limits)
    return robot_adequacy(Context(replace(arm, requirement=requirement), preset))


def widest(matrix):
    """Entry with the largest half-width due to meshes."""
    return max(matrix.entries, key=lambda entry: entry.uncertainties.get("meshes", 0.0))


@pytest.mark.exhaustive
def test_requested_accuracy_is_reached(arm):
    """`--accuracy` of half the widest mesh half-width. Errors change within their half-widths."""
    # Also where no verdict hangs on meshes.
    rough = judged_by(arm, "quick", limit=10.0)
    rough_half_width = widest(rough).uncertainties["meshes"]
    better = judged_by(arm, "quick", 0.5 * rough_half_width, limit=10.0)
    assert widest(better).uncertainties["meshes"] <= 0.5 * rough_half_width
    assert better.notes[-1].startswith("accuracy ±")
    assert ";" not in better.notes[-1]
    # What finer meshes say lies within what coarser ones left open.
    for entry in rough.entries:
        other = better.entry(entry.model, entry.quantity.name)
        if entry.error is not None and other.error is not None:
            assert abs(entry.error - other.error) <= entry.uncertainty + 1e-9


@pytest.mark.soak
def test_finer_mesh_decides_verdict(arm):
    """A limit between the bounds on two meshes: the finer mesh is used and decides."""
    entry = widest(judged_by(arm, "standard"))
    finest = judged_by(arm, "fine", 1e-6)
    assert finest.notes[-1].endswith("; no preset has finer meshes of the bodies")
    best = finest.entry(entry.model, entry.quantity.name)
    # A limit that the meshes of this preset leave open, and those of the next one do not.
    size = abs(best.error) + best.uncertainty
    limit = 0.5 * (size + abs(entry.error) + entry.uncertainty)
    name = entry.quantity.name
    decided = judged_by(arm, "standard", **{name: limit}).entry(entry.model, name)
    assert decided.verdict == "adequate"
    assert decided.uncertainty == pytest.approx(best.uncertainty, rel=1e-6)


@pytest.mark.parametrize(
    ("preset", "length", "refused"),
    [
        ("quick", 0.2, "preset quick refines meshes only with --accuracy"),
        ("standard", 0.2, ""),
        # 800 slices of 4 × 6 quadratic elements, (2·800 + 1)(2·4 + 1)(2·6 + 1) nodes.
        (
            "standard",
            8.0,
            "finer solids have 5.6e+05 unknowns; preset standard allows at most 200000",
        ),
        ("fine", 0.2, "no preset has finer meshes of the bodies"),
    ],
)
def test_too_large_refined_reference_is_refused(tmp_path, preset, length, refused):
    """Finer meshes are limited by the preset and by a number of unknowns."""
    text = f"{ONE_ARM}[path]\nposes = [[0.0]]\n".replace("P = [0.0, 0.5", f"P = [0.0, {length}")
    context = Context(robot_of(text, tmp_path), preset)
    if refused:
        with pytest.raises(InputError, match=re.escape(refused)):
            finer_context(context, 2.0)
    else:
        assert finer_context(context, 2.0).meshes == "fine"


STEPS = (
    *(step for name in ("vjm", "links") for step in all_static_steps(name, EQUIVALENT).values()),
    *all_modal_steps(EQUIVALENT, EQUIVALENT).values(),
)
REMEDIES = {USE_SOLID, *(step.remedy for step in STEPS if step.remedy)}
FINER = larger_preset("quick", lambda preset: preset == "fine")


def options_taken(remedy_text, *words):
    """Options (name: value) in `remedy_text`, which the command `words` must accept as typed."""
    options = dict(re.findall(r"--(\w+) (\S+)", remedy_text))
    typed = [word for name, value in options.items() for word in (f"--{name}", value)]
    _, bound, _ = cli.app.parse_args([*words, *typed], exit_on_error=False, print_error=False)
    arguments = {**bound.arguments, **vars(bound.arguments.get("options", SimpleNamespace()))}
    assert {name: str(arguments[name]) for name in options} == options
    return options


@pytest.mark.parametrize("remedy", sorted(REMEDIES, key=str), ids=lambda remedy: remedy.text)
def test_remedy_is_valid_input_of_solve(remedy):
    """Each remedy names models and options that `flexproof solve` accepts."""
    options, used = (
        set(re.findall(r"--(\w+)", remedy.text)),
        re.findall(r"\buse (\w+)", remedy.text),
    )
    # Its fields, which decide, are those that its text states.
    assert options == {remedy.option.removeprefix("--")} - {""}
    assert used == [remedy.model] * bool(remedy.model)
    models = used or [
        model
        for model, properties in MODELS.items()
        if options and options <= set(properties.options)
    ]
    assert models
    for model in models:
        solve_options = options_taken(remedy.text, "solve", "ifw", "--model", model)
        assert solve_options.keys() <= set(MODELS[model].options)


@pytest.mark.parametrize("remedy_text", [FINER_PARTS, finer_by(FINER)])
def test_finer_reference_remedy_is_option_of_run(remedy_text):
    """The option that the remedy names is one of `flexproof run`."""
    assert len(options_taken(remedy_text, "run", "ifw")) == 1


@pytest.mark.parametrize(
    ("leg1", "leg2", "remedy_text"),
    [
        ((), ("inertia",), "inertia in [leg2]"),
        (("mass_centre", "inertia"), ("inertia",), "mass_centre and inertia in [leg1], inertia in"),
        # The built-in robot says both of both legs, and was told to do so.
        ((), (), "the section or the solid instead of the 6×6 compliance in [leg1], [leg2]"),
    ],
)
def test_mass_remedy_names_missing_keys(leg1, leg2, remedy_text):
    """Such as "mass_centre and inertia in [leg1]": keys that the file lacks and the schema has."""
    robot_file = load_robot("ifw")
    bodies = dict(robot_file.mechanism.bodies)
    for name, keys in (("leg1", leg1), ("leg2", leg2)):
        shape = replace(bodies[name].shape, **dict.fromkeys(keys))
        bodies[name] = replace(bodies[name], shape=shape)
    posture = reference_posture(replace(robot_file.mechanism, bodies=bodies))
    decides = robot_at(Context(robot_file), [posture]).masses_instruction
    assert remedy_text in decides
    assert ("mass_centre" in decides) == ("mass_centre" in leg1)
    schema = dumps(json_schema())
    assert all(f'"{key}":' in schema for key in ("mass_centre", "inertia", "section", "material"))


def test_proposed_end_condition_is_valid_key(tmp_path):
    """Keys and values in the remedy, written into the robot file, specify all end conditions."""
    arm = ONE_ARM + "[path]\nposes = [[0.0]]\n"
    decides = holding(robot_of(arm, tmp_path).mechanism).decides
    (table,) = re.findall(r"\[[\w.]+\]", decides)
    lines = re.findall(r'\w+ = "\w+"', decides)
    texts = [arm.replace(table, f"{table}\n{line}") for line in lines]
    file = write_crane(tmp_path)
    crane, decides = file.read_text("utf-8"), holding(load_robot(file).mechanism).decides
    assert "[bodies.arm]" in decides
    ((key, values),) = re.findall(r"(\w+) = (.*) in the interfaces", decides)
    values = re.findall(r'"\w+"', values)
    texts += [crane.replace(" } }", f" }}, {key} = {value} }}") for value in values]
    assert (len(lines), len(values)) == (2, 3)
    assert not any(holding(robot_of(text, tmp_path).mechanism).unspecified for text in texts)


@pytest.mark.parametrize("ends", [0.3, 0.8])
def test_second_uncertainty_has_remedy(ends):
    """Half-widths of a five-bar were 0.234 % by meshes (no remedy), 0.222 % by end conditions."""
    exact = Statics(np.eye(6)[None], np.zeros((1, 0, 6)))
    compliance_by_ends = {"rigid": exact, "free": (1.0 - 0.04 * ends) * exact}
    half_widths, beam = meshes(displacements=np.full((1, 7), 0.02)), toy_model("beam", 1.05 * exact)
    for finer, remedy in ((NOT_FINER, NOT_FINER if ends < 0.5 else "say ends"), ("mesh", "mesh")):
        fields = {"open": "ends", "decides": "say ends", "finer": finer}
        statics = reference("solids", compliance_by_ends, half_widths, **fields)
        pose = (Coordinate("x", "m"),), np.zeros((1, 1))
        robot = Subject("toy", *pose, Responses(None), [beam], statics, Reference("none"))
        entry = verdict_matrix(robot, Requirement()).entry("beam", "x")
        assert entry.uncertainties["meshes"] > entry.uncertainties["ends"]
        assert (entry.verdict, entry.reason) == ("undecided", remedy)
