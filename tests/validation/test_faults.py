"""Faults: each changes what its function says, goes without a trace, and is noticed."""

import os
from collections import deque
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache, partial
from pathlib import Path

import msgspec
import numpy as np
import pytest
from msgspec import structs
from scipy.sparse import issparse

from fem.beams import beam_theory
from fem.beams.frame import Frame, Member, PointMass, assemble
from fem.bodies import doubling, leg_modes, solid
from fem.bodies.part import meshed_part
from fem.calculix import deck as calculix_deck
from fem.calculix import leg as calculix
from fem.calculix import mechanism as mechanism_calculix
from fem.sections.section_constants import section_constants
from lumped import biglide
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material, equivalent_leg
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.part import ByPlane, PartInterface
from lumped.models import simplified
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from lumped.system.assembly import assembly
from lumped.system.solution import solved
from meshes.gmsh_session import gmsh_model
from meshes.part import volume
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.prism.hexahedra import hexahedra
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh
from validation.case import Absolute, Case, Measurement, Skip
from validation.cases import program
from validation.cases.program import guards, judgement
from validation.cases.program import parts as program_parts
from validation.cases.program.guards import pairing, reduction, sweep, waves
from validation.cases.program.parts import wedge
from validation.cases.robot import solid as robot_solid
from validation.context import Context
from validation.faults import detection, trial
from validation.faults.catalogue import FAULTS
from validation.faults.detection import fault_cases
from validation.faults.fault import Fault, around, fault, replaced, sound_function
from validation.faults.parts import meshed_elsewhere
from validation.faults.sound import SoundCases, sound_cases, verdict_of
from validation.faults.trial import catchers, tried
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.legs import leg_matrices
from validation.models.mechanism import answers, on_drives_alone
from validation.models.options import ModelOptions
from validation.parts.meshes import COARSE, part_mesh
from validation.report.detection import detection_power, names_faults
from validation.results.outcome import Outcome, Result, judge
from validation.run import summary as run_summary
from validation.run.gathered import Results
from validation.store.cache import nothing_kept

IFW = load_robot("ifw")
TOOL = np.diag([2e-9, 3e-9, 1e-9, 4e-7, 3e-7, 5e-7])
# The groups without a fault are computed once for all tests.
SHARED = Context(IFW, "quick")
BY_ID = {fault.id: fault for fault in FAULTS}
# Looked up while tests are collected: a fault in a function that is gone is named at once.
PLACES = {fault.where: sound_function(fault.where) for fault in FAULTS}


def workout() -> None:
    """Every function that has a fault is used at least once, on small models."""
    robot = replace(IFW.robot, tool_offset=np.array([0.05, -0.08, 0.155]), tool_compliance=TOOL)
    steel = Material.isotropic(2.1e11, 0.3, 7850.0)
    cubic = replace(steel, G=0.7 * steel.G)
    shapes = (
        Rectangle(0.08, 0.14),
        HollowRectangle(0.1, 0.16, 0.01),
        Circle(0.1),
        Tube(0.1, 0.01),
        ISection(0.12, 0.2, 0.01, 0.008),
    )
    for shape in shapes:
        leg = ConstantLeg(0.85, shape, steel)
        leg_matrices("beam", leg, ModelOptions(elements=3))
    equivalent_leg(robot.leg1)
    slender = ConstantLeg(0.85, shapes[4], cubic)
    beam_theory.cantilever_frequencies(slender.timoshenko, 0.85, 4)
    for options in (ModelOptions("equivalent", elements=4), ModelOptions(theory="euler-bernoulli")):
        for model in ("vjm", "segments", "beam"):
            robot_compliance(model, replace(robot, leg1=slender), 0.4, options)
    for model in ("segments", "beam"):
        robot_frequencies(
            model, replace(robot, tool_compliance=None), 0.4, 3, ModelOptions(elements=4)
        )
    robot_compliance("simplified", robot, 0.4)
    simplified.frequencies(robot, 0.4)
    member = biglide.scaled(robot, 1.5)
    robot_compliance("vjm", member, member.centre)
    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.85, 0.0]])
    beam = Member(0, 1, slender.timoshenko, (0.0, 0.0, 1.0), 2)
    assemble(Frame("beam", ends, (beam,), masses=(PointMass(1, 5.0),)))
    short = ConstantLeg(0.4, HollowRectangle(0.08, 0.14, 0.02), cubic)
    section = section_mesh(short.section, 1)
    section_constants(section, 0.3)
    for kind in ("rigid", "free"):
        doubling.tip_compliance(doubling.condensed_leg(short, section, 5), kind)
        mesh = hexahedra(short.section, short.length, 1, slices=4)
        clamped = solid.clamped_leg(solid.solid_leg(short, mesh), kind)
        solid.tip_compliance(clamped)
        leg_modes.modes(clamped, 2)


def reduction_workout() -> None:
    """The same of reduced legs, of sweeps, of what models are compared by, and of decks."""
    context = Context(IFW, "quick")
    for guard in (
        reduction,
        sweep,
        waves,
        pairing,
        judgement,
    ):
        for case in guard.cases():
            case.compute(context)
    cubic = Material(2.1e11, 0.6e11, 0.2, 7850.0)
    leg = ConstantLeg(0.3, Rectangle(0.08, 0.14), cubic)
    mesh = tetrahedra(leg.section, leg.length, 1)
    calculix_deck.deck_text(calculix.leg_deck(mesh, cubic))
    calculix.mass_at_stiffness_points(mesh, cubic.rho)
    whole = solid.solid_leg(leg, mesh)
    (at,) = biglide.postures(IFW.robot, (IFW.robot.centre,))
    mechanism_calculix.mechanism_deck(at, {"leg1": whole, "leg2": whole}, 4)
    next(case for case in robot_solid.cases() if "rigid.along-z" in case.id).compute(context)


def mechanism_workout() -> None:
    """The same of mechanisms: loops of rigid bodies, joints that give, idle motions."""
    feet = biglide.mechanism(replace(IFW.robot, tool_offset=np.array([0.05, -0.08, 0.155])))
    bars = load_robot("hexapod").mechanism
    for of in (load_robot("3-rrr").mechanism, load_robot("delta").mechanism, bars, feet):
        at = posture(of, of.poses[0])
        for model in ("vjm", "links", "simplified"):
            if model != "vjm" or of in {bars, feet}:
                answers(model, [at], 0)
        answers("beam", [at], 2, ModelOptions(elements=2))
        solved(assembly(on_drives_alone(of), {}).at(replace(at, mechanism=on_drives_alone(of))))


def parts_workout() -> None:
    """The same of parts: drawn, read, meshed, held, identified."""
    for case in program_parts.cases():
        if ".crank." not in case.id and ".calculix." not in case.id:
            case.compute(SHARED)


@cache
def recorded() -> dict[str, list[tuple]]:
    """Arguments with which the workout calls each place that has a fault."""
    calls: dict[str, list[tuple]] = {}

    def listening(where):
        def listen(sound, *args, **kwargs):
            calls.setdefault(where, []).append((args, kwargs))
            return sound(*args, **kwargs)

        return around(listen)

    with replaced({fault.where: listening(fault.where) for fault in FAULTS}):
        workout()
        reduction_workout()
        mechanism_workout()
        parts_workout()
    return calls


def numbers(value: object) -> list[np.ndarray]:  # noqa: PLR0911  one line for each kind
    """All numbers in a result, in order."""
    if issparse(value):
        return [value.toarray().ravel()]
    if isinstance(value, np.ndarray | float | int | complex):
        return [np.atleast_1d(np.asarray(value, dtype=complex)).ravel()]
    if isinstance(value, str):
        return [np.array([ord(letter) for letter in value], dtype=complex)]
    if isinstance(value, dict):
        return [part for item in value.values() for part in numbers(item)]
    if isinstance(value, tuple | list):
        return [part for item in value for part in numbers(item)]
    if isinstance(value, Iterator):
        return numbers(list(value))
    if isinstance(value, msgspec.Struct):
        return [part for item in structs.astuple(value) for part in numbers(item)]
    if is_dataclass(value):
        return [part for f in fields(value) for part in numbers(getattr(value, f.name))]
    return []


def differ(first: object, second: object) -> bool:
    pairs = list(zip(numbers(first), numbers(second), strict=False))
    if len(numbers(first)) != len(numbers(second)) or any(a.shape != b.shape for a, b in pairs):
        return True
    # Each part against its own size: a robot holds stiffnesses beside compliances.
    return any(
        not np.allclose(a, b, rtol=1e-9, atol=1e-12 * np.abs(a[np.isfinite(a)]).max(initial=0.0))
        for a, b in pairs
        if np.isfinite(a).all() or not np.array_equal(a, b)
    )


def test_catalogue_has_faults_of_all_rooms_and_no_two_of_one_name():
    assert len(BY_ID) == len(FAULTS) >= 280
    rooms = {place.split(".")[0] for place in PLACES}
    assert rooms == {"lumped", "meshes", "fem", "validation"}
    with pytest.raises(ValueError, match=r"two faults are called leg\.three-for-twelve"):
        fault("leg.three-for-twelve", "again", "lumped.legs.tip_compliance")(len)


def test_a_fault_in_a_function_that_is_gone_is_named():
    with pytest.raises(LookupError, match=r"no function lumped\.legs\.of_another_day"):
        sound_function("lumped.legs.of_another_day")


# These take the place of objects of other libraries or of elements, which carry no numbers.
OPAQUE = {"beam.inner-unknowns-left-out", "beam.shear-length", "beam.quadrature"}
# Of one posture it says the same.
SWEPT = {"sweep.not-turned"}
HELD = {"free-superelement.tip-loose"}
# Matrices of a whole part, too large to be compared entry by entry.
WHOLE = {"part.straight-edges"}


@pytest.mark.parametrize("identifier", sorted(BY_ID.keys() - OPAQUE - SWEPT - HELD - WHOLE))
def test_faulty_function_says_something_else(identifier):
    fault = BY_ID[identifier]
    sound = sound_function(fault.where)
    faulty = fault.change(sound)
    for args, kwargs in recorded()[fault.where]:
        expected = sound(*args, **kwargs)
        try:
            found = faulty(*args, **kwargs)
        except Exception:  # noqa: BLE001  a fault that raises does say something else
            return
        if differ(expected, found):
            return
    pytest.fail(f"{identifier} changed nothing in {len(recorded()[fault.where])} calls")


@pytest.mark.parametrize("identifier", sorted(OPAQUE))
def test_faulty_class_or_numbering_changes_frequencies(identifier):
    options = ModelOptions(elements=4)
    sound = robot_frequencies("beam", IFW.robot, 0.4, 3, options)
    with BY_ID[identifier].inject():
        try:
            faulty = robot_frequencies("beam", IFW.robot, 0.4, 3, options)
        except ComputationError:
            faulty = np.full(3, np.nan)
    assert not np.allclose(sound, faulty, rtol=1e-12)
    assert np.array_equal(robot_frequencies("beam", IFW.robot, 0.4, 3, options), sound)


@pytest.mark.parametrize("identifier", sorted(SWEPT))
def test_fault_of_many_postures_changes_the_second(identifier):
    sound = sweep.swept(IFW.robot)
    with BY_ID[identifier].inject():
        faulty = sweep.swept(IFW.robot)
    assert not np.allclose(sound[1], faulty[1], rtol=1e-6)


@pytest.mark.parametrize("identifier", sorted(HELD))
def test_fault_in_what_a_held_leg_does_changes_its_frequencies(identifier):
    sound = reduction.reduced_solid_leg("free").frequencies
    with BY_ID[identifier].inject():
        faulty = reduction.reduced_solid_leg("free").frequencies
    assert not np.allclose(sound, faulty, rtol=1e-6)


@pytest.mark.parametrize("identifier", sorted(WHOLE))
def test_fault_in_a_whole_part_changes_its_mass(identifier):
    case = next(one for one in program_parts.cases() if one.id.endswith("fork.mass"))
    sound = case.compute(SHARED).value
    with BY_ID[identifier].inject():
        assert case.compute(SHARED).value > 10.0 * sound


def test_function_imported_by_name_is_replaced_where_it_is_used_and_put_back():
    before = robot_compliance("vjm", IFW.robot, 0.4, ModelOptions(legs="equivalent"))
    with BY_ID["leg.three-for-twelve"].inject():
        during = robot_compliance("vjm", IFW.robot, 0.4, ModelOptions(legs="equivalent"))
    after = robot_compliance("vjm", IFW.robot, 0.4, ModelOptions(legs="equivalent"))
    assert not np.allclose(before, during, rtol=1e-3)
    assert np.array_equal(before, after)


def test_cached_properties_do_not_outlive_a_fault():
    leg = ConstantLeg(1.0, Rectangle(0.1, 0.2), Material.isotropic(2e11, 0.3, 7800.0))
    sound = leg.timoshenko.EIy
    with BY_ID["section.moments-swapped"].inject():
        assert leg.timoshenko.EIy == pytest.approx(sound / 4.0)
    assert leg.timoshenko.EIy == sound


def length_case(identifier: str, tolerance: float) -> Case:
    def compute(context: Context) -> Measurement:
        return Measurement(equivalent_leg(context.robot.leg1).mass, 69.705, exact=True)

    return Case(
        id=identifier,
        title="Mass of leg 1",
        quantity="mass",
        unit="kg",
        reference_kind="published",
        citation="paper, appendix",
        tolerance=Absolute(tolerance),
        tolerance_reason="made up: one that notices and one that does not",
        compute=compute,
        group="mass",
    )


def sound(cases: list[Case]) -> SoundCases:
    return sound_cases(cases, IFW, "quick", PLACES)


def test_trial_names_the_cases_that_turn_and_asks_only_those_that_use_the_place():
    close, loose = length_case("close", 0.001), length_case("loose", 1000.0)
    apart = replace(close, id="apart", compute=lambda _: Measurement(1.0, 1.0, exact=True))
    found = tried(BY_ID["equivalent.mass-per-length"], sound([close, loose, apart]))
    assert found == {close: "disagree", loose: "agree"}
    assert catchers(found) == [close]
    assert tried(BY_ID["solid.angular-frequency"], sound([close, loose, apart])) == {}


def of_a_beam(_context: Context) -> float:
    return ConstantLeg(1.0, Rectangle(0.1, 0.2), STEEL).timoshenko.EIy


def of_a_mass(_context: Context) -> float:
    return STEEL.rho


def shared_case(identifier: str, reference: float) -> Case:
    """Of a kept result that a fault touches, and of one that it does not."""

    def compute(context: Context) -> Measurement:
        value = context.get(of_a_beam, None) * context.get(of_a_mass, None)
        return Measurement(value, reference, exact=True)

    return replace(length_case(identifier, 1e-3 * reference), compute=compute)


STEEL = Material.isotropic(2e11, 0.3, 7800.0)


def test_results_that_a_fault_touches_are_made_again_and_others_are_not():
    right = 2e11 * 0.1 * 0.2**3 / 12.0 * 7800.0
    cases = [shared_case("first", right), shared_case("second", right)]
    ready = sound(cases)
    place = "lumped.legs.ConstantLeg.timoshenko"
    # The second rests on what the first computed, and uses the place all the same.
    assert set(ready.using(place)) == set(cases)
    left = ready.context.untouched_by(place)
    assert [key.split()[0].split(".")[-1] for key in left._memo] == ["of_a_mass"]
    assert set(tried(BY_ID["section.moments-swapped"], ready).values()) == {"disagree"}


def test_cheap_cases_are_asked_first_and_dear_ones_are_spared():
    cases = [length_case(name, 0.001) for name in ("third", "first", "second")]
    ready = sound(cases)
    for cost, case in enumerate([cases[1], cases[2], cases[0]]):
        ready.done[case].seconds = float(cost)
    found = tried(BY_ID["equivalent.mass-per-length"], ready)
    assert [case.id for case in found] == ["first", "second"]


@pytest.mark.parametrize("end", ["dies", "never ends"])
def test_fault_that_ends_the_process_or_never_ends_has_been_noticed(end, monkeypatch):
    monkeypatch.setattr(trial, "_LEAST_PATIENCE", 0.5)
    case = length_case("close", 0.001)
    spin = partial(iter, int, 1)
    change = around(lambda *_: os.abort() if end == "dies" else deque(spin(), maxlen=0))
    fatal = Fault("fatal", "fatal", "lumped.legs.constant_leg", change)
    assert tried(fatal, sound([case])) == {case: "failed"}


def test_fault_that_no_case_of_quick_uses_is_skipped_and_no_survivor(monkeypatch):
    monkeypatch.setattr(detection, "catalogue", lambda _: pairing.cases())
    case = next(case for case in fault_cases() if case.id == "fault.vjm.tip-joint-forgotten")
    with pytest.raises(Skip, match="no comparison of preset quick uses lumped"):
        case.compute(Context(IFW, "quick"))
    skipped = Outcome(case, Result(case.id, "skipped", 0.0))
    assert detection_power([skipped]).detections == ()
    # In the standard preset there is nothing else to ask: it has survived.
    assert case.compute(Context(IFW, "standard")).value == 0.0


def test_run_of_faults_alone_sums_up_the_faults_and_no_comparisons():
    case = next(case for case in fault_cases() if case.id == "fault.leg.three-for-twelve")
    table = {"caught by": ("leg1", "leg2"), "group": ("legs", "legs"), "verdict": ("disagree",) * 2}
    outcome = judge(case, Measurement(2.0, 1.0, exact=True, table=table), 0.0)
    gathered = Results({}, [case], done={case.id: outcome.result})
    expected = "1 faults injected, all caught, 0 by a single comparison."
    assert run_summary.verdicts(gathered) == [expected]
    assert names_faults("fault.*")
    assert not names_faults("leg1.*")


def test_case_that_disagrees_without_a_fault_catches_none():
    wrong = replace(
        length_case("wrong", 0.001), compute=lambda _: Measurement(1.0, 2.0, exact=True)
    )
    assert sound([wrong]).done == {}


def test_what_is_kept_on_the_disk_does_not_outlive_a_fault(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path))
    case = next(one for one in wedge.cases() if one.id == "program.parts.wedge.stepped")
    assert judge(case, case.compute(Context(IFW, "quick")), 0.0).verdict == "agree"
    before = sorted(tmp_path.rglob("*.npz"))
    assert before
    assert tried(BY_ID["part.unit"], sound([case])) == {case: "failed"}
    assert sorted(tmp_path.rglob("*.npz")) == before


def drawn_block(folder: Path) -> Path:
    """A block of 60 × 40 × 20 mm, as a BREP file."""
    file = folder / "block.brep"
    with gmsh_model("block") as gmsh:
        gmsh.model.occ.addBox(0.0, 0.0, 0.0, 60.0, 40.0, 20.0)
        gmsh.model.occ.synchronize()
        gmsh.write(str(file))
    return file


def part_case(file: Path) -> Case:
    """Its mass, from a mesh that is graded to one of its faces."""
    wanted = {"A": PartInterface(ByPlane((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), "rigid")}

    def compute(_context: Context) -> Measurement:
        part = read_part(file, "mm")
        mesh = part_mesh(part, find_interfaces(part, wanted), 2000, COARSE)
        mass = meshed_part(mesh, STEEL).properties().mass
        return Measurement(mass, STEEL.rho * 0.06 * 0.04 * 0.02, exact=True)

    return replace(length_case(file.name, 1e-9), compute=compute)


def test_part_is_meshed_under_a_fault_though_it_was_meshed_before(tmp_path):
    case = part_case(drawn_block(tmp_path))
    # OpenCASCADE's threads, which a copy of this process does not have, are started here.
    ready = sound([case])
    assert list(ready.done) == [case]
    left = ready.context.untouched_by(BY_ID["element.half-density"].where)
    assert sum(key.startswith("kept") for key in left._memo) == 2
    assert tried(BY_ID["element.half-density"], ready) == {case: "disagree"}
    # Meshed anew, in centimetres.
    assert not ready.context.untouched_by(BY_ID["part.unit"].where)._memo
    assert tried(BY_ID["part.unit"], ready) == {case: "disagree"}
    # Nothing of it is used.
    assert tried(BY_ID["part.pin-about-point"], ready) == {}


def test_mesh_under_a_fault_comes_from_a_fresh_process_with_that_fault(tmp_path):
    part = read_part(drawn_block(tmp_path), "mm")
    grading = volume.Grading(0.03)
    meant = volume.volume_mesh(part, (), grading)
    with replaced(meshed_elsewhere(BY_ID["part.unit"])):
        found = volume.volume_mesh(part, (), grading)
    assert np.ptp(found.nodes, axis=0) == pytest.approx(10.0 * np.ptp(meant.nodes, axis=0))


FEW_FAULTS = [
    "section.moments-swapped",
    "leg.three-for-twelve",
    "vjm.tip-joint-forgotten",
    "robot.printed-release",
    "element.lame-slip",
    "ends.node-left-out",
    "reduction.coupling-mass",
    "sweep.not-turned",
    "pairing.unweighted",
    "waveguide.mass",
]


@pytest.mark.parametrize("identifier", FEW_FAULTS)
def test_fault_case_of_the_run_counts_its_catchers(identifier, monkeypatch):
    # The guards alone: whatever they catch is caught by the whole catalogue too.
    monkeypatch.setattr(
        detection,
        "catalogue",
        lambda _: guards.cases(),
    )
    case = next(case for case in fault_cases() if case.id == f"fault.{identifier}")
    outcome = judge(case, case.compute(SHARED), 0.0)
    assert outcome.verdict == "agree"
    power = detection_power([outcome])
    assert not power.survivors
    assert len(power.records()[0]["caught_by"]) == outcome.measurement.value
    assert sum(power.detections[0].asked.values()) == outcome.measurement.value


# One comparison more, by other means than the first, for what a single one used to notice.
SECOND = {
    "beam.quadrature": "guard.leg1.consistent-mass",
    "energies.kinds-swapped": "guard.modes.energies",
    "idle.mass-kept": "program.mechanism.cone",
    "pairing.angle-unweighted": "guard.pairing.span",
    "part.all-rigid": "program.parts.bar.patch",
    "part.equal-weights": "program.parts.bar.patch",
    "part.inertia-at-origin": "program.parts.shaft.swing",
    "part.pin-about-point": "program.parts.fork.arm.pin",
    "part.transport-sign": "program.parts.shaft.rest",
    "reduction.bound": "guard.modes.bounds",
    "robot-calculix.no-platform": "program.mechanism.calculix.heavy",
    "simplified.angular-frequency": "guard.simplified.mirrored",
    "vjm.tool-spring-forgotten": "guard.robot.tool-spring[vjm]",
}


@pytest.mark.parametrize("identifier", SECOND)
def test_fault_that_one_comparison_noticed_is_noticed_by_another(identifier):
    case = next(one for one in program.cases() if one.id == SECOND[identifier])
    without = verdict_of(case, Context(IFW, "quick"))
    if without == "skipped":
        pytest.skip("CalculiX (ccx) is not installed")
    assert without == "agree"
    with BY_ID[identifier].inject(), nothing_kept():
        assert verdict_of(case, Context(IFW, "quick")) in {"disagree", "failed"}


def test_in_the_example_of_a_robot_that_gives_everywhere_everything_gives():
    path = Path(__file__).parents[2] / "examples" / "elastic-biglide" / "robot.toml"
    robot = load_robot(path).robot
    assert robot.foot_compliance is not None
    assert robot.tool_compliance is not None
    assert np.all(robot.tool_offset != 0.0)
    for leg in (robot.leg1, robot.leg2):
        assert isinstance(leg.section, Rectangle)
        assert leg.material == Material.isotropic(2.1e11, 0.3, 7850.0)
