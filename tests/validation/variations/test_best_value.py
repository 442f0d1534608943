"""A number of a robot whose best value is known in closed form, as every model chooses it.

A bar on a slide. Along the slide it swings as a rigid body on the drive's spring, the more slowly
the taller it is; across the slide it bends, the faster the taller it is.
"""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest
import scipy
from forgetting import forget
from scipy.optimize import brentq
from written_robot import robot_of

from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.robot_file.variation import variations_of
from lumped.sections import Rectangle
from validation.adequacy.mechanism.legs import UNKNOWNS
from validation.case import Absolute, Skip
from validation.context import Context
from validation.run.executor import on_cores
from validation.solids.size import LARGEST
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
def given(tmp_path_factory):
    """A light bar known by its 6×6, of which no solid is made."""
    known = f"mass = 0.1\ncompliance = {tip_compliance(PRISM.timoshenko, LENGTH).tolist()}"
    text = re.sub(r"section = .*\nmaterial = .*\nends = .*", known, BAR)
    return robot_of(text, tmp_path_factory.mktemp("given"))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    bar = robot_of(BAR, tmp_path_factory.mktemp("bar"))
    (variation,) = variations_of(bar, [VARY])
    with pytest.MonkeyPatch.context() as patch:
        # Section meshes of a hundred nodes are enough for closed forms.
        patch.setitem(UNKNOWNS, "quick", (150, 600))
        return variation_study(bar, variation, "quick")


def bending(height, width=WIDTH):
    """First frequency (Hz) of the clamped bar that bends by its height, the tool at its tip.

    1 + cos λ cosh λ + λ m/(ρAL) (cos λ sinh λ − sin λ cosh λ) = 0 (Euler–Bernoulli).
    """
    mass = RHO * width * height * LENGTH

    def condition(x):
        tip = np.cos(x) * np.sinh(x) - np.sin(x) * np.cosh(x)
        return 1.0 + np.cos(x) * np.cosh(x) + x * TOOL / mass * tip

    root = brentq(condition, 0.1, 1.8751041)
    return root**2 / (2.0 * np.pi * LENGTH**2) * np.sqrt(E * height**2 / 12.0 / RHO)


def swinging(height):
    """Frequency (Hz) of bar and tool on the drive, rigid or as they bend along it (Dunkerley)."""
    rigid = np.sqrt(DRIVE / (TOOL + RHO * WIDTH * height * LENGTH)) / (2.0 * np.pi)
    return 1.0 / np.hypot(1.0 / rigid, 1.0 / bending(WIDTH, height))


def test_the_best_height_is_where_both_modes_meet(found):
    expected = np.array([min(bending(height), swinging(height)) for height in HEIGHTS])
    best = int(expected.argmax())
    assert 0 < best < len(HEIGHTS) - 1
    decision = found["frequency"].decision
    # Shear and rotary inertia are left out of the closed form.
    assert decision.reference == pytest.approx(expected, rel=0.03)
    assert decision.best == best
    for model in ("segments", "beam", "beam-euler-bernoulli"):
        assert decision.choice(model).design == best
        assert decision.choice(model).loss == 0.0
        assert decision.correlation(model)[0] == pytest.approx(1.0)
    # The simplified model's bar has no mass: all heights are one to it.
    assert decision.models["simplified"] == pytest.approx(np.sqrt(DRIVE / TOOL) / (2.0 * np.pi))
    simplified = decision.choice("simplified")
    assert (len(simplified.equally_good), simplified.design, simplified.loss) == (3, best, 0.0)


def test_the_stiffest_is_the_tallest_and_rigid_bars_are_all_alike(found):
    decision = found["deflection"].decision
    area, inertia = WIDTH * HEIGHTS, WIDTH * HEIGHTS**3 / 12.0
    shear = LENGTH / (5.0 / 6.0 * area * E / 2.0)
    across = 1e9 * (LENGTH**3 / (3.0 * E * inertia) + shear)
    wide = HEIGHTS * WIDTH**3 / 12.0
    along = 1e9 * (1.0 / DRIVE + LENGTH**3 / (3.0 * E * wide) + shear)
    expected = np.maximum(across, along)
    # For ν = 0 held ends take nothing of bending: the rest is the mesh.
    for model in ("vjm", "links", "segments", "beam"):
        assert decision.models[model] == pytest.approx(expected, rel=1e-9)
    assert decision.reference == pytest.approx(expected, rel=1e-3)
    assert decision.best == len(HEIGHTS) - 1
    simplified = decision.choice("simplified")
    assert simplified.equally_good == tuple(range(len(HEIGHTS)))
    assert (simplified.design, simplified.loss) == (decision.best, 0.0)
    assert np.isnan(decision.correlation("simplified")[0])


def test_what_the_file_relies_on_is_judged(given):
    variations = variations_of(given, ["tool.mass=2:4:3"])
    ids = {case.id for case in cases_over(given, variations)}
    assert "decision.frequency.loss.beam[tool.mass]" in ids
    assert not any("simplified" in name or "frequency.loss.vjm" in name for name in ids)
    relied = replace(given, requirement=replace(given.requirement, rely=("simplified",)))
    cases = {case.id: case for case in cases_over(relied, variations)}
    assert sorted(cases) == [
        f"decision.{objective}.{what}.simplified[tool.mass]"
        for objective in ("deflection", "frequency")
        for what in ("loss", "order")
    ]
    # 4.0 kg are slower than 2.0 kg, which both know.
    context = Context(relied, "quick")
    loss = cases["decision.frequency.loss.simplified[tool.mass]"].measure(context)
    assert (loss.value, loss.reference_uncertainty) == (0.0, 0.0)
    # One and a half exchanges of neighbours among three, each 12/(3 (9 − 1)).
    assert cases["decision.frequency.order.simplified[tool.mass]"].tolerance == Absolute(0.75)
    # No mass changes a deflection: nothing is to choose, and there is no order.
    stiff = cases["decision.deflection.loss.simplified[tool.mass]"].measure(context)
    assert "2, 3, 4 are equally good by this model" in stiff.notes[1]
    with pytest.raises(Skip, match="equally good by simplified or its reference"):
        cases["decision.deflection.order.simplified[tool.mass]"].measure(context)
    two = cases_over(relied, variations_of(given, ["tool.mass=2:4:2"]))
    assert [case.id.split(".")[2] for case in two] == ["loss", "loss"]
    assert not cases_over(relied, variations_of(given, ["tool.mass=2:4:1"]))


@pytest.mark.exhaustive
def test_a_value_without_a_reference_is_told(tmp_path, monkeypatch):
    """The thinner bar has more unknowns as a solid than the preset takes."""
    monkeypatch.setitem(LARGEST, "quick", 6000)
    bar = robot_of(BAR, tmp_path)
    variations = variations_of(bar, ["bodies.bar.section.height=0.04:0.08:2"])
    case = next(c for c in cases_over(bar, variations) if "frequency.loss.beam" in c.id)
    said = r"--vary bodies.bar.section.height=0.04: bar as a solid of 2 divisions has about"
    with pytest.raises(Skip, match=said):
        case.measure(Context(bar, "quick"))


def test_units_are_sent_kept_and_taken_up_with_all_their_digits(given, tmp_path, monkeypatch):
    (variation,) = variations_of(given, ["tool.mass=2:4:2"])
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    here = variation_study(given, variation, "quick")
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path))
    forget()
    with on_cores(1) as cores:
        there = variation_study(given, variation, "quick", cores)
    forget()
    again = variation_study(given, variation, "quick", pytest.fail)
    for objective, curves in here.items():
        for other in (there, again):
            np.testing.assert_equal(asdict(other[objective].decision), asdict(curves.decision))


def test_references_of_several_kinds_are_one_robot_each():
    """A leg of its own 6×6 leaves nothing open, where others leave two readings."""
    legs = np.array(["beam", "legs' own 6×6"]), np.array(["vjm", "beam", "solid, a", "solid, b"])
    extremes = np.array([2.0, 3.0]), np.array([7.0, 4.0, 5.0, 6.0])
    robots = [
        VariedModels(np.zeros(1), name, np.ones((n, 1)), np.ones((n, 1)), n // 2, one, 0.1 * one)
        for name, one, n in zip(legs, extremes, (2, 4), strict=True)
    ]
    decision = decision_of("deflection", robots)
    assert {name: one.tolist() for name, one in decision.models.items()} == {"beam": [2.0, 4.0]}
    assert [one.tolist() for one in decision.references.values()] == [[3.0, 5.0], [3.0, 6.0]]
    left_open = np.array(list(decision.uncertainties.values()))
    np.testing.assert_allclose(left_open, [[0.3, 0.5], [0.3, 0.6]])


def test_uncertain_references_leave_losses_open(given, monkeypatch):
    values = {"first": np.array([1.0, 1.001, 2.0]), "second": np.array([1.02, 1.0, 2.0])}
    uncertain = {"first": np.full(3, 0.002), "second": np.zeros(3)}
    decision = Decision("deflection", {"model": values["second"]}, values, uncertain)
    assert decision.choice("model").loss == pytest.approx(0.001)
    # 0.2 % up and 0.2 % down; the second reading finds it the best.
    assert decision.loss_uncertainty(1) == pytest.approx(0.004, rel=0.01)
    assert decision.loss_uncertainty(0) == pytest.approx(0.02, rel=0.01)
    # One exchange of three: ρ = 0.5; within its uncertainty, and by the second, the order is 1.
    assert decision.correlation("model") == pytest.approx((0.5, 0.5))
    monkeypatch.setattr("validation.variations.cases._decision", lambda *_: decision)
    monkeypatch.setitem(decision.models, "beam", values["second"])
    cases = cases_over(given, variations_of(given, ["tool.mass=2:4:3"]))
    case = next(one for one in cases if "deflection.loss.beam" in one.id)
    percent = case.measure(Context(given, "quick"))
    assert [percent.value, percent.reference_uncertainty] == pytest.approx([0.1, 0.4], rel=0.01)


def test_what_is_open_moves_extremes_up_or_down():
    """Of 1.0 (1 ± 10 %) and 1.01 the smaller is as much as 10 % smaller, and 1 % larger."""
    values, unsure = np.array([[1.0], [1.01]]), np.array([[0.1], [0.0]])
    found = _extremes({"beam": values, "solid": values}, {"solid": unsure}, np.min)
    np.testing.assert_allclose(found, [[1.0, 1.0], [0.0, 0.1]])


def test_losses_of_a_known_table():
    # The first chooses its 1.0, where the reference has 2.0 instead of its best 1.6.
    own, reference = np.array([1.0, 2.0, 4.0, 3.0]), np.array([2.0, 1.6, 3.0, 5.0])
    assert choice(own, reference, "deflection") == Choice(0, (0,), pytest.approx(0.25))
    # Of frequencies the largest is best: 4.0, where the reference has 3.0 of its 5.0.
    assert choice(own, reference, "frequency") == Choice(2, (2,), pytest.approx(0.4))
    # A model of rigid legs finds 1 µm throughout, but for rounding and one design: in its favour.
    own, reference = 1.0 + np.array([3e-9, 0.5, 0.0, -2e-9]), np.array([4.0, 1.0, 3.0, 2.0])
    assert choice(own, reference, "deflection") == Choice(3, (0, 2, 3), pytest.approx(1.0))
    assert choice(np.zeros(4), reference, "deflection").design == 1


@pytest.mark.parametrize("levels", [4, 1000])
def test_spearman_is_scipys_and_rounding_makes_no_order(levels):
    """With few levels there are ties, which share their mean rank."""
    for one, other in np.random.default_rng(levels).integers(1, levels, (5, 2, 9)).astype(float):
        due = scipy.stats.spearmanr(one, other).statistic
        assert spearman(one, other) == pytest.approx(due, abs=1e-12)
        assert np.isnan(spearman(1.0 + 1e-9 * one, other))
