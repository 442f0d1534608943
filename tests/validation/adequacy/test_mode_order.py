"""Order and partners of modes: known permutations, close modes of equal legs, stubby legs."""

from dataclasses import replace

import numpy as np
import pytest
from support.fakes.toy_responses import model as toy_model
from support.fakes.toy_responses import reference
from support.fakes.toy_subject import toy_subject
from support.robots.robot_from_text import robot_of

from lumped.acceptance.requirement import Requirement
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import robot_subject
from validation.context import Context
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes

SAMPLES, JUDGED, LIMIT = 24, 7, 0.05


def families(rng):
    """Multiplicities of a robot's frequencies, its frequencies (Hz), and those of a model (Hz).

    Neighbouring frequencies differ by 1 to 9 %. Those of the model differ by up to 40 % from the
    robot's.
    """
    sizes = rng.choice([1, 1, 2, 3], 6)
    frequencies = 100.0 * np.cumprod(rng.uniform(1.01, 1.09, len(sizes)))
    factors = np.where(rng.random(len(sizes)) < 0.4, rng.uniform(0.6, 1.4, len(sizes)), 1.001)
    return sizes, frequencies, frequencies * factors


def vibration(rng, sizes, frequencies, shapes):
    """Modes in ascending order, mixed at random if frequencies are equal, and their families."""
    places = np.split(np.arange(sizes.sum()), np.cumsum(sizes)[:-1])
    order = np.argsort(frequencies)
    turned = [
        shapes[:, places[k]] @ np.linalg.qr(rng.normal(size=(sizes[k],) * 2))[0] for k in order
    ]
    repeated = np.repeat(frequencies[order], sizes[order])
    visible = np.ones((1, sizes.sum()))
    modes = PathModes(repeated[None], np.hstack(turned)[None], np.ones(SAMPLES), visible)
    return modes, np.repeat(order, sizes[order])


@pytest.mark.parametrize("seed", range(40))
def test_mode_order_follows_families(seed):
    """Mode k of the model is in order if mode k of the robot has the same repeated frequency."""
    rng = np.random.default_rng([43, seed])
    sizes, true_frequencies, model_frequencies = families(rng)
    shapes = np.linalg.qr(rng.normal(size=(SAMPLES, sizes.sum())))[0]
    truth, of_truth = vibration(rng, sizes, true_frequencies, shapes)
    model, of_model = vibration(rng, sizes, model_frequencies, shapes)
    count = min(JUDGED, sizes.sum())
    subject = replace(
        toy_subject(SAMPLES),
        models=[toy_model("model", modes=model)],
        dynamics=reference("truth", {"": truth}),
    )
    matrix = verdict_matrix(subject, Requirement(frequency=LIMIT, modes=count))
    for mode in range(count):
        entry = matrix.entry("model", f"f{mode + 1}")
        family = of_truth[mode]
        assert entry.error == pytest.approx(
            model_frequencies[family] / true_frequencies[family] - 1.0, abs=1e-9
        )
    has_moved = of_truth[:count] != of_model[:count]
    misled = np.where(
        has_moved,
        model_frequencies[of_model[:count]] / true_frequencies[of_truth[:count]] - 1.0,
        0.0,
    )
    order = matrix.entry("model", "order")
    # Families of different sizes shift the members of those between them.
    places = [
        np.flatnonzero(of_model == family)[: (of_truth[:count] == family).sum()]
        for family in dict.fromkeys(of_truth[:count])
    ]
    shifted = np.concatenate(places) != np.arange(count)
    expected = np.where(shifted, model.frequencies[0, :count] / truth.frequencies[0, :count] - 1, 0)
    assert abs(order.error) == pytest.approx(np.abs(expected).max(), abs=1e-9)
    assert abs(order.error) >= np.abs(misled).max() - 1e-9
    assert order.verdict == ("inadequate" if abs(order.error) > LIMIT else "adequate")


@pytest.mark.parametrize("seed", range(20))
def test_frequency_error_needs_partner(seed):
    """A model lacks three of nine modes of close frequencies.

    Reference modes without a partner have no error, and no mode of the model is a partner twice.
    """
    rng = np.random.default_rng([44, seed])
    shapes = np.linalg.qr(rng.normal(size=(SAMPLES, 9)))[0]
    frequencies = 100.0 * np.cumprod(rng.uniform(1.0, 1.09, 9))
    partner_modes = np.sort(rng.permutation(9)[:6])
    order = rng.permutation(partner_modes)
    weights = np.ones(SAMPLES)
    model = PathModes(frequencies[None, :6], shapes[None][:, :, order], weights, np.ones((1, 6)))
    truth = PathModes(frequencies[None], shapes[None], weights, np.ones((1, 9)))
    pairs = partners(truth, model, 9)
    assert (np.isnan(pairs.frequency) == (pairs.partner_indices < 0)).all()
    expected = [int(np.flatnonzero(order == k)[0]) if k in partner_modes else -1 for k in range(9)]
    assert pairs.partner_indices[0].tolist() == expected
    has_partner = pairs.partner_indices[0] >= 0
    np.testing.assert_array_equal(
        pairs.frequency[0, has_partner], frequencies[pairs.partner_indices[0, has_partner]]
    )


LEG = """
[bodies.slide{k}]
points = ["A{k}"]
[bodies.leg{k}]
from = "A{k}"
to = "C{k}"
section = {{ shape = "i-section", width = 0.0590, height = 0.0804, flange = 0.0062, web = 0.0065 }}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
ends = "rigid"
[joints.drive{k}]
type = "prismatic"
between = ["ground", "slide{k}"]
at = "A{k}"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = 7.6e6 }}
[joints.foot{k}]
type = "revolute"
between = ["slide{k}", "leg{k}"]
at = "A{k}"
axis = [{x:.12f}, {y:.12f}, 0.0]
[joints.ball{k}]
type = "spherical"
between = ["leg{k}", "platform"]
at = "C{k}"
"""
PLATFORM = """
[bodies.platform]
points = ["C1", "C2", "C3", "P"]
mass = 0.511
centre = "P"
inertia = [[0.0051777, 0.0, 0.0], [0.0, 0.0051777, 0.0], [0.0, 0.0, 0.0098377]]
[tool]
body = "platform"
point = "P"
moves = ["z", "phi_x", "phi_y"]
mass = 0.925
[accept]
frequency = 0.05
modes = 9
"""


def equal_legs():
    """Text of a 3-PRS robot file: 0.76 m high, joints on circles of radius 0.297 and 0.142 m."""
    points, legs = ["P = [0.0, 0.0, 0.760770915244]"], []
    for k in (1, 2, 3):
        angle = 2.0 * np.pi * (k - 1) / 3.0
        x, y = np.cos(angle), np.sin(angle)
        for name, radius, z in (("A", 0.296901632823, 0.0), ("C", 0.141731785598, 0.760770915244)):
            points.append(f"{name}{k} = [{radius * x:.12f}, {radius * y:.12f}, {z}]")
        legs.append(LEG.format(k=k, x=-y, y=x))
    head = 'schema = 2\nname = "equal legs"\n[points]\n'
    return head + "\n".join(points) + "".join(legs) + PLATFORM


# Local modes of the second leg's section lie among the first six.
STUBBY = """schema = 1
name = "stubby biglide"
type = "biglide"
[geometry]
a = 0.8752
[platform]
mass = 89.504
[actuators]
stiffness = 5.0e8
[leg1]
length = 0.5795
section = { shape = "rectangle", width = 0.2087, height = 0.2676 }
material = { E = 210000000000.0, nu = 0.3, rho = 7850.0 }
ends = "free"
[leg2]
length = 0.6512
section = { shape = "hollow-rectangle", width = 0.3240, height = 0.4637, thickness = 0.0770 }
material = { E = 110000000000.0, nu = 0.26, rho = 7200.0 }
ends = "free"
[accept]
frequency = 0.08
modes = 6
"""
MODELS = ("segments", "beam")


def matrix_of(text, folder):
    robot_file = robot_of(text, folder)
    return verdict_matrix(robot_subject(Context(robot_file, "quick")), robot_file.requirement)


@pytest.mark.exhaustive
@pytest.mark.parametrize("model", [*MODELS, "beam-euler-bernoulli"])
def test_leg_torsion_changes_mode_order(tmp_path, model):
    """Torsion of the legs gives the seventh to ninth mode: 111.2 Hz by Saint-Venant's theory.

    Solids give 164.3 Hz, Vlasov's torsion with both ends fixed 165.1 Hz: 32 % above.
    """
    matrix = matrix_of(equal_legs(), tmp_path)
    order = matrix.entry(model, "order")
    assert (order.verdict, order.error) == ("inadequate", pytest.approx(-0.315, abs=0.001))
    for number in (4, 5, 6):
        entry = matrix.entry(model, f"f{number}")
        assert (entry.verdict, entry.error) == ("adequate", pytest.approx(0.0, abs=5e-4))
    for number in (7, 8, 9):
        entry = matrix.entry(model, f"f{number}")
        assert (entry.verdict, entry.error) == ("inadequate", pytest.approx(-0.323, abs=0.005))


@pytest.mark.soak
def test_stubby_leg_modes_have_no_partner(tmp_path):
    """Sections deform in f3, f4 and f6.

    Rigid motions of sections have 36, 12 and 0.2 % of the kinetic energy.
    """
    matrix = matrix_of(STUBBY, tmp_path)
    for model in MODELS:
        # 995.4 against 979.0 Hz in the first pose, the third mode of beams.
        fifth = matrix.entry(model, "f5")
        assert fifth.verdict == "adequate"
        assert all(-0.022 < error < 0.001 for error in fifth.errors)
        assert fifth.values[0] == pytest.approx(979.0, abs=1.0)
        for quantity in ("f3", "f4", "f6"):
            local = matrix.entry(model, quantity)
            assert (local.verdict, local.error) == ("inadequate", None)
            assert "local to the section of a leg" in local.reason
        # The fifth mode of beams is 35 % above the robot's fifth.
        assert matrix.entry(model, "order").verdict == "inadequate"
