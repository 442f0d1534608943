"""Choice of the best value of a robot's dimension, which has a closed form.

The robot is a bar on a slide. Along the slide it vibrates as a rigid body on the drive's spring;
the frequency falls with its height. Perpendicular to the slide it bends; the frequency rises with
its height.
"""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest
import scipy
from scipy.optimize import brentq
from support.fakes.cleared_memory import forget
from support.robots.robot_from_text import robot_of

from fem.machine import one_blas_thread
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.robot_file.variation import variations_of
from lumped.sections import Rectangle
from validation.case import Absolute, Skip
from validation.context import Context
from validation.references.reference_legs import UNKNOWNS
from validation.run.executor import on_cores
from validation.solids.solid_size import LARGEST
from validation.variations.cases import cases_over
from validation.variations.curves import VariedModels, _extremes, decision_of, variation_study
from validation.variations.decision import Choice, Decision, choice, spearman

LENGTH, WIDTH, E, RHO, TOOL, DRIVE = 0.5, 0.24, 2.1e11, 7850.0, 2.0, 4.0e8
BAR = f"""
schema = 2
name = "bar on a slide"
points = {{ A = [0.0, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
tool = {{ body = "bar", point = "P", moves = ["y"], mass = {TOOL} }}
path = {{ poses = [[0.0]] }}
accept = {{ modes = 1 }}
[bodies.bar]
from = "A"
to = "P"
section = {{ shape = "rectangle", width = {WIDTH}, height = 0.03 }}
material = {{ E = {E}, nu = 0.0, rho = {RHO} }}
ends = "rigid"
[joints.slide]
type = "prismatic"
between = ["ground", "bar"]
at = "A"
axis = [0.0, 1.0, 0.0]
drive = {{ stiffness = {DRIVE} }}
"""
VARY = "bodies.bar.section.height=0.080:0.112:3"
HEIGHTS = np.linspace(0.080, 0.112, 3)


PRISM = ConstantLeg(LENGTH, Rectangle(WIDTH, 0.08), Material.isotropic(E, 0.0, RHO))


@pytest.fixture(scope="module")
def light_bar(tmp_path_factory):
    """Robot with a light bar known by its 6×6, which has no solid."""
    leg = f"mass = 0.1\ncompliance = {tip_compliance(PRISM.timoshenko, LENGTH).tolist()}"
    text = re.sub(r"section = .*\nmaterial = .*\nends = .*", leg, BAR)
    return robot_of(text, tmp_path_factory.mktemp("given"))


@pytest.fixture(scope="module")
def curves_by_objective(tmp_path_factory):
    bar = robot_of(BAR, tmp_path_factory.mktemp("bar"))
    (variation,) = variations_of(bar, [VARY])
    with pytest.MonkeyPatch.context() as patch:
        # Section meshes of a hundred nodes are accurate enough here.
        patch.setitem(UNKNOWNS, "quick", (150, 600))
        return variation_study(bar, variation, "quick")


def bending_frequency(height, width=WIDTH):
    """First frequency (Hz) of the clamped bar with the tool at its tip, bending over its height.

    1 + cos λ cosh λ + λ m/(ρAL) (cos λ sinh λ − sin λ cosh λ) = 0 (Euler–Bernoulli).
    """
    mass = RHO * width * height * LENGTH

    def condition(x):
        tip = np.cos(x) * np.sinh(x) - np.sin(x) * np.cosh(x)
        return 1.0 + np.cos(x) * np.cosh(x) + x * TOOL / mass * tip

    root = brentq(condition, 0.1, 1.8751041)
    return root**2 / (2.0 * np.pi * LENGTH**2) * np.sqrt(E * height**2 / 12.0 / RHO)


def drive_frequency(height):
    """Frequency (Hz) of bar and tool along the drive, with bending of the bar (Dunkerley)."""
    rigid = np.sqrt(DRIVE / (TOOL + RHO * WIDTH * height * LENGTH)) / (2.0 * np.pi)
    return 1.0 / np.hypot(1.0 / rigid, 1.0 / bending_frequency(WIDTH, height))


def test_best_height_has_equal_frequencies(curves_by_objective):
    """The first frequency is highest where those of bending and of the drive are nearly equal."""
    expected = np.array(
        [min(bending_frequency(height), drive_frequency(height)) for height in HEIGHTS]
    )
    best = int(expected.argmax())
    assert 0 < best < len(HEIGHTS) - 1
    decision = curves_by_objective["frequency"].decision
    # The closed form neglects shear and rotary inertia.
    assert decision.reference == pytest.approx(expected, rel=0.03)
    assert decision.best == best
    for model in ("segments", "beam", "beam-euler-bernoulli"):
        assert decision.choice(model).design == best
        assert decision.choice(model).loss == 0.0
        assert decision.correlation(model)[0] == pytest.approx(1.0)
    # The bar of the simplified model has no mass, so that it rates all heights as equal.
    assert decision.models["simplified"] == pytest.approx(np.sqrt(DRIVE / TOOL) / (2.0 * np.pi))
    simplified = decision.choice("simplified")
    assert (len(simplified.equally_good), simplified.design, simplified.loss) == (3, best, 0.0)


def test_tallest_bar_has_smallest_deflection(curves_by_objective):
    """Deflections by hand; the simplified model, rigid but for its drive, cannot choose."""
    decision = curves_by_objective["deflection"].decision
    area, inertia = WIDTH * HEIGHTS, WIDTH * HEIGHTS**3 / 12.0
    shear = LENGTH / (5.0 / 6.0 * area * E / 2.0)
    across = 1e9 * (LENGTH**3 / (3.0 * E * inertia) + shear)
    wide = HEIGHTS * WIDTH**3 / 12.0
    along = 1e9 * (1.0 / DRIVE + LENGTH**3 / (3.0 * E * wide) + shear)
    expected = np.maximum(across, along)
    # For ν = 0 rigid end faces do not stiffen bending. The remaining error is that of the mesh.
    for model in ("vjm", "links", "segments", "beam"):
        assert decision.models[model] == pytest.approx(expected, rel=1e-9)
    assert decision.reference == pytest.approx(expected, rel=1e-3)
    assert decision.best == len(HEIGHTS) - 1
    simplified = decision.choice("simplified")
    assert simplified.equally_good == tuple(range(len(HEIGHTS)))
    assert (simplified.design, simplified.loss) == (decision.best, 0.0)
    assert np.isnan(decision.correlation("simplified")[0])


def test_relied_models_have_decision_cases(light_bar):
    """Cases judge the loss by a model's choice of a value, and the model's order of the values."""
    variations = variations_of(light_bar, ["tool.mass=2:4:3"])
    ids = {case.id for case in cases_over(light_bar, variations)}
    assert "decision.frequency.loss.beam[tool.mass]" in ids
    assert not any("simplified" in name or "frequency.loss.vjm" in name for name in ids)
    requirement = replace(light_bar.requirement, rely=("simplified",))
    relying = replace(light_bar, requirement=requirement)
    cases = {case.id: case for case in cases_over(relying, variations)}
    assert sorted(cases) == [
        f"decision.{objective}.{criterion}.simplified[tool.mass]"
        for objective in ("deflection", "frequency")
        for criterion in ("loss", "order")
    ]
    # A tool of 4.0 kg has lower frequencies than one of 2.0 kg by the model and by the reference.
    context = Context(relying, "quick")
    loss = cases["decision.frequency.loss.simplified[tool.mass]"].measure(context)
    assert (loss.value, loss.reference_uncertainty) == (0.0, 0.0)
    # One and a half exchanges of neighbours among three, each 12/(3 (9 − 1)).
    assert cases["decision.frequency.order.simplified[tool.mass]"].tolerance == Absolute(0.75)
    # Deflections do not depend on the mass: all values rate as equal, so there is no order.
    deflection = cases["decision.deflection.loss.simplified[tool.mass]"].measure(context)
    assert "This model rates 2, 3, 4 as equal" in deflection.notes[1]
    with pytest.raises(Skip, match=r"simplified or its reference rates all values of .* as equal"):
        cases["decision.deflection.order.simplified[tool.mass]"].measure(context)
    of_two_values = cases_over(relying, variations_of(light_bar, ["tool.mass=2:4:2"]))
    assert [case.id.split(".")[2] for case in of_two_values] == ["loss", "loss"]
    assert not cases_over(relying, variations_of(light_bar, ["tool.mass=2:4:1"]))


@pytest.mark.exhaustive
def test_value_without_reference_is_skipped(tmp_path, monkeypatch):
    """The solid of the thinner bar has more unknowns than the preset allows."""
    monkeypatch.setitem(LARGEST, "quick", 6000)
    bar = robot_of(BAR, tmp_path)
    variations = variations_of(bar, ["bodies.bar.section.height=0.04:0.08:2"])
    case = next(c for c in cases_over(bar, variations) if "frequency.loss.beam" in c.id)
    message = r"--vary bodies.bar.section.height=0.04: bar as a solid of 2 divisions has about"
    with pytest.raises(Skip, match=message):
        case.measure(Context(bar, "quick"))


def test_stored_results_keep_all_digits(light_bar, tmp_path, monkeypatch):
    """Computed here with the BLAS threads of a command, in a worker, from the cache: equal bits."""
    (variation,) = variations_of(light_bar, ["tool.mass=2:4:2"])
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    with one_blas_thread():
        in_process = variation_study(light_bar, variation, "quick")
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path))
    forget()
    with on_cores(1) as cores:
        in_worker = variation_study(light_bar, variation, "quick", cores)
    forget()
    from_cache = variation_study(light_bar, variation, "quick", pytest.fail)
    for objective, curves in in_process.items():
        for study in (in_worker, from_cache):
            np.testing.assert_equal(asdict(study[objective].decision), asdict(curves.decision))


def test_single_reading_serves_all_values():
    """The first value's robot has one reading of its file, the second value's robot has two."""
    names = (
        np.array(["beam", "specified 6×6 of the legs"]),
        np.array(["vjm", "beam", "solid, a", "solid, b"]),
    )
    extremes = np.array([2.0, 3.0]), np.array([7.0, 4.0, 5.0, 6.0])
    robots = [
        VariedModels(
            np.zeros(1), curve_names, np.ones((n, 1)), np.ones((n, 1)), n // 2, values, 0.1 * values
        )
        for curve_names, values, n in zip(names, extremes, (2, 4), strict=True)
    ]
    decision = decision_of("deflection", robots)
    models = {name: values.tolist() for name, values in decision.models.items()}
    assert models == {"beam": [2.0, 4.0]}
    references = [values.tolist() for values in decision.references.values()]
    assert references == [[3.0, 5.0], [3.0, 6.0]]
    half_widths = np.array(list(decision.uncertainties.values()))
    np.testing.assert_allclose(half_widths, [[0.3, 0.5], [0.3, 0.6]])


def test_uncertain_reference_widens_losses(light_bar, monkeypatch):
    """Interval of the loss over two references, of which one is uncertain by 0.2 %."""
    values = {"first": np.array([1.0, 1.001, 2.0]), "second": np.array([1.02, 1.0, 2.0])}
    uncertainties = {"first": np.full(3, 0.002), "second": np.zeros(3)}
    decision = Decision("deflection", {"model": values["second"]}, values, uncertainties)
    assert decision.choice("model").loss == pytest.approx(0.001)
    # 0.2 % up and 0.2 % down. Under the second reading it is the best design.
    assert decision.loss_uncertainty(1) == pytest.approx(0.004, rel=0.01)
    assert decision.loss_uncertainty(0) == pytest.approx(0.02, rel=0.01)
    # One exchange among three gives ρ = 0.5. The correlation is 1 within the half-widths, and under
    # the second reading.
    assert decision.correlation("model") == pytest.approx((0.5, 0.5))
    monkeypatch.setattr("validation.variations.cases._decision", lambda *_: decision)
    monkeypatch.setitem(decision.models, "beam", values["second"])
    cases = cases_over(light_bar, variations_of(light_bar, ["tool.mass=2:4:3"]))
    case = next(case for case in cases if "deflection.loss.beam" in case.id)
    percent = case.measure(Context(light_bar, "quick"))
    assert [percent.value, percent.reference_uncertainty] == pytest.approx([0.1, 0.4], rel=0.01)


def test_extreme_value_interval_is_two_sided():
    """The smaller of 1.0 (± 10 %) and 1.01 is between 0.9 and 1.01: −10 %, +1 %."""
    values, uncertainties = np.array([[1.0], [1.01]]), np.array([[0.1], [0.0]])
    extremes = _extremes({"beam": values, "solid": values}, {"solid": uncertainties}, np.min)
    np.testing.assert_allclose(extremes, [[1.0, 1.0], [0.0, 0.1]])


def test_chosen_value_and_loss_are_exact():
    # The model chooses its 1.0. The reference has 2.0 there, and 1.6 at its best.
    """Loss: relative difference of the reference's value at the chosen design from its best one."""
    values, reference = np.array([1.0, 2.0, 4.0, 3.0]), np.array([2.0, 1.6, 3.0, 5.0])
    assert choice(values, reference, "deflection") == Choice(0, (0,), pytest.approx(0.25))
    # The largest frequency is best: 4.0, at which the reference has 3.0, with 5.0 at its best.
    assert choice(values, reference, "frequency") == Choice(2, (2,), pytest.approx(0.4))
    # By a model of rigid legs three designs have 1 µm except for rounding. The best of them by the
    # reference counts.
    values, reference = 1.0 + np.array([3e-9, 0.5, 0.0, -2e-9]), np.array([4.0, 1.0, 3.0, 2.0])
    assert choice(values, reference, "deflection") == Choice(3, (0, 2, 3), pytest.approx(1.0))
    assert choice(np.zeros(4), reference, "deflection").design == 1


@pytest.mark.parametrize("levels", [4, 1000])
def test_spearman_matches_scipy(levels):
    """Designs of equal value, which are frequent with few `levels`, share their mean rank."""
    pairs = np.random.default_rng(levels).integers(1, levels, (5, 2, 9)).astype(float)
    for first, second in pairs:
        expected = scipy.stats.spearmanr(first, second).statistic
        assert spearman(first, second) == pytest.approx(expected, abs=1e-12)
        assert np.isnan(spearman(1.0 + 1e-9 * first, second))
