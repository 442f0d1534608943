"""Measured frequency responses against models, for a mass on three springs.

In closed form the mass moves along a spring k by 1/(k − mω² + 2iζω√km) per force, by 1/k at ω = 0
and by 1/2ζk at resonance. It is struck along (1, 1, 1): √⅓ of the force is along each spring.
"""

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of

from validation.context import Context
from validation.measured import tested
from validation.measured.matrix import measured_matrix
from validation.measured.modes import with_measured_file
from validation.report.figures.loads_and_responses import figures
from validation.verdicts import MEASURED_RESPONSE

pyuff = pytest.importorskip("pyuff")
STEPS = np.arange(0.0, 200.0, 0.25)
MASS, SPRINGS, RATIO = 10.0, np.array([4.0e5, 9.0e5, 1.6e6]), 0.01
FREQUENCIES = np.sqrt(SPRINGS / MASS) / (2.0 * np.pi)
COMPLIANCE = [*(1.0 / SPRINGS), 1e-9, 1e-9, 1e-9]
LOW = FREQUENCIES[0] / 3.0
ALL = ("hammer.f1", "hammer.f2", "hammer.f3", "hammer.low")


def robot_text(tables="", stiffer=1.0):
    return f"""
schema = 2
name = "mass on springs"
points = {{ A = [0.3, 0.1, 0.0] }}
tool = {{ body = "mass", point = "A", moves = [] }}
[bodies.mass]
points = ["A"]
mass = {MASS}
centre = "A"
inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]
[joints.root]
type = "fixed"
between = ["ground", "mass"]
at = "A"
compliance = {np.diag(np.array(COMPLIANCE) / stiffer).tolist()}
[hammer]
averages = 8
[hammer.nodes]
1 = {{ body = "mass", at = "A" }}
2 = {{ body = "mass", at = "A", x = [1, 1, 1], y = [-1, 1, 0] }}
{tables}"""


def exact(frequencies, struck=(1, 1, 1), ratio=RATIO):
    """Receptances (n×4, m/N): displacement along the three springs and along the force `struck`."""
    speeds, along = 2.0 * np.pi * np.asarray(frequencies)[:, None], struck / np.linalg.norm(struck)
    displacements = along / (
        SPRINGS - MASS * speeds**2 + 2j * ratio * speeds * np.sqrt(SPRINGS * MASS)
    )
    return np.column_stack([displacements, displacements @ along])


# Specific data types of displacement, velocity and acceleration, by derivatives.
KINDS = {0: 8, 1: 11, 2: 12}


def functions(derivatives=2, factor=1.0, noise=0.0, struck=(1, 1, 1), ratio=RATIO, **fields):
    """Data sets 58: responses of the mass along x, y, z and along the impact."""
    responses = exact(STEPS, struck, ratio)
    random = np.random.default_rng(11).standard_normal((2, *responses.shape))
    responses = factor * (2j * np.pi * STEPS[:, None]) ** derivatives * responses
    responses *= 1.0 + noise * (random[0] + 1j * random[1])
    form = {"type": 58, "func_type": 4, "binary": 0, "x": STEPS, "abscissa_spacing": 1}
    kinds = {"ordinate_spec_data_type": KINDS[derivatives], "orddenom_spec_data_type": 13}
    return [
        {**form, **kinds, "rsp_node": n, "rsp_dir": axis, "ref_node": 2, "ref_dir": 1, "data": data}
        | fields
        for (n, axis), data in zip([(1, 1), (1, 2), (1, 3), (2, 1)], responses.T, strict=True)
    ]


@pytest.fixture
def robot_with(tmp_path, monkeypatch):
    """Function that writes data sets to a file and returns the robot file `text` that names it."""
    monkeypatch.setattr(tested, "within_limits", lambda _, read, *arguments: read(*arguments))

    def hold(sets, text=""):
        path = tmp_path / "hammer.uff"
        path.unlink(missing_ok=True)
        pyuff.UFF(str(path)).write_sets(sets)
        return with_measured_file(robot_of(text or robot_text(), tmp_path), path)

    return hold


def entries_of(robot_file):
    matrix = measured_matrix(Context(robot_file, "quick"))
    return {name: matrix.entry("beam", f"response:{name}") for name in ALL}


@pytest.mark.parametrize("derivatives", [0, 1, 2])
def test_response_matches_theory(robot_with, derivatives):
    """1/k at zero frequency, and 1/(2 ζ k) at the natural frequencies."""
    ratios = RATIO * np.array([1.0, 1.5, 0.8])
    # In mm and kN, by data set 164.
    units = {"units_code": 9, "length": 1e3, "force": 1e-3, "temp": 1.0, "temp_offset": 0.0}
    sets = [{"type": 164, **units}, *functions(derivatives, 1e6, ratio=ratios)]
    entries = entries_of(robot_with(sets))
    share = np.sqrt(1 / 3)
    peaks = [entries[f"hammer.f{n}"] for n in (1, 2, 3)]
    sizes = share / (2 * ratios * SPRINGS)
    assert [entry.expected for entry in peaks] == pytest.approx(sizes, rel=2e-4)
    # A third of the first frequency is a ninth above rest.
    assert entries["hammer.low"].expected == pytest.approx(share / SPRINGS[0] * 9 / 8, rel=1e-4)
    for entry in entries.values():
        assert entry.error == pytest.approx(0.0, abs=1e-3)
        assert (entry.quantity.unit, entry.verdict, entry.mac or 1.0) == (
            "m/N",
            "adequate",
            pytest.approx(1.0),
        )


def test_low_response_is_largest_of_directions(robot_with):
    """The force hardly excites the lowest mode, so that other directions respond most below it."""
    struck = (1, 10, 10)
    text = robot_text().replace("x = [1, 1, 1]", f"x = {list(struck)}")
    entry = entries_of(robot_with(functions(struck=struck), text))["hammer.low"]
    sizes = np.abs(exact([LOW], struck))[0]
    assert sizes.max() > 4.0 * sizes[0]
    assert entry.expected == pytest.approx(sizes.max(), rel=1e-3)
    assert entry.error == pytest.approx(0.0, abs=1e-3)


def test_stiff_model_has_known_error(robot_with):
    """Springs 20 % too stiff: 1/1.2 − 1 in each peak, and less below the first one."""
    entries = entries_of(robot_with(functions(), robot_text(stiffer=1.2)))
    for n in (1, 2, 3):
        assert entries[f"hammer.f{n}"].error == pytest.approx(1 / 1.2 - 1, abs=1e-3)
    # At a third of the measured frequency (k − k/9) / (1.2 k − k/9).
    assert entries["hammer.low"].error == pytest.approx((8 / 9) / (1.2 - 1 / 9) - 1, abs=1e-3)
    assert {entry.verdict for entry in entries.values()} == {"inadequate"}


def test_models_use_damping_of_robot_file(robot_with):
    """Twice the measured damping: peaks half as high."""
    entries = entries_of(robot_with(functions(), robot_text("[damping]\nratio = 0.02")))
    assert entries["hammer.f2"].error == pytest.approx(-0.5, abs=1e-3)
    assert entries["hammer.low"].error == pytest.approx(0.0, abs=1e-3)
    assert "damped as measured" not in entries["hammer.f2"].reference


@pytest.mark.parametrize(
    ("factor", "verdict", "message"),
    [
        (-1.0, "undecided", "the response has the opposite sign of the measurement"),
        (1e3, "inadequate", "0.001 times the measured value; check the unit"),
        (1 / 9.80665, "inadequate", "9.81 times the measured value; check the unit"),
    ],
)
def test_wrong_sign_or_unit_is_detected(robot_with, factor, verdict, message):
    """A response times −1 or 1000: the reason names the mistake."""
    for entry in entries_of(robot_with(functions(factor=factor))).values():
        assert entry.verdict == verdict
        assert message in entry.reason


def test_noise_is_within_uncertainty(robot_with):
    """Noise of 1 % in real and imaginary part, confirmed by the coherence of eight impacts."""
    clean = {measured.quantity: measured.value for measured in robot_with(functions()).measured}
    noisy = functions(noise=0.01)
    coherent = 1.0 / (1.0 + 8 * 2 * 0.01**2)
    data = {"func_type": 6, "data": np.full(len(STEPS), coherent)}
    for sets in (noisy, noisy + [{**data_set, **data} for data_set in noisy]):
        for measured in robot_with(sets).measured:
            if measured.quantity.harmonic:
                error = measured.value / clean[measured.quantity] - 1
                random = np.sqrt((measured.uncertainty / measured.value) ** 2 - 0.01**2)
                assert abs(error) < 3 * random
                assert 0.001 < random < 0.01
    # The last one, low: in the middle of nine lines on a parabola (Savitzky and Golay).
    assert random == pytest.approx(0.01 * np.sqrt(59 / 231), rel=0.02)


def test_tool_response_gives_its_peak(robot_with):
    """Peak, its frequency and the size at 40 Hz, against the closed form."""
    tables = """[damping]
ratio = 0.01
[[responses]]
name = "mill"
direction = [1, 1, 1]
from = 10.0
to = 150.0
at = 40.0
"""
    robot_file = robot_with(functions(), robot_text(tables))
    matrix = measured_matrix(Context(robot_file, "quick"))
    fine = np.arange(10.0, 150.0, 1e-3)
    sizes = np.abs(exact(fine)[:, 3])
    size_at_40_hz = np.abs(exact([40.0])[0, 3])
    expected = {"": sizes.max(), ".frequency": fine[sizes.argmax()], ".at": size_at_40_hz}
    for suffix, truth in expected.items():
        entry = matrix.entry("beam", f"response:mill{suffix}")
        assert entry.expected == pytest.approx(truth, rel=2e-3)
        assert entry.error == pytest.approx(0.0, abs=2e-3)
        assert "hammer.uff" in entry.reference
    # What the figure shows is the closed form, of the part from which the first mode is read.
    (figure,) = (figure for figure in figures(robot_file) if figure.id == MEASURED_RESPONSE)
    data = figure.draw(Context(robot_file, "quick")).data.splitlines()
    table = np.genfromtxt(data, delimiter=",", names=True)
    for name, close in (("measured_response", 1e-9), ("beam", 2e-3)):
        size = 1e6 * np.abs(exact(table["frequency_Hz"])[:, 0])
        assert table[f"{name}_magnitude_µmN"] == pytest.approx(size, rel=close)
