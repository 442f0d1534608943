"""Frequencies of an unsupported leg: exact solutions, solids, number of rigid-body motions."""

import json
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from lumped.arrays import dense
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import free_frequencies
from lumped.robot_file.written import toml_of
from lumped.sections import Rectangle
from validation import api, cli
from validation.models.leg_models import clamped_solid, leg_frequencies, leg_matrices
from validation.models.options import ModelOptions

E, NU, RHO = 2.1e11, 0.3, 7850.0
G = E / 2.0 / (1.0 + NU)
# Roots of cos x cosh x = 1 (Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1).
ROOTS = (4.730040744862704, 7.853204624095838, 10.995607838001671)


def bar(length, width, height):
    """Tables of a robot that is one bar from A to B."""
    section = {"shape": "rectangle", "width": width, "height": height}
    return {
        "schema": 2,
        "name": "bar",
        "points": {"A": [0.0, 0.0, 0.0], "B": [length, 0.0, 0.0]},
        "bodies": {
            "bar": {
                "from": "A",
                "to": "B",
                "section": section,
                "material": {"E": E, "nu": NU, "rho": RHO},
            }
        },
        "joints": {"root": {"type": "fixed", "between": ["ground", "bar"], "at": "A"}},
        "tool": {"body": "bar", "point": "B", "moves": []},
    }


def free(robot, model, modes, **options):
    arguments = {"modes": modes, "body": "bar", "ends": "free-free", **options}
    (answer,) = api.solve(robot, model, **arguments).answers
    assert answer.rigid == 6
    assert answer.compliance.size == 0
    return answer.frequencies


def test_free_slender_bar_is_euler_bernoulli():
    """Frequencies (x/L)² √(EI/ρA) / 2π in both planes, x the roots of cos x cosh x = 1."""
    frequencies = free(bar(1.0, 0.02, 0.01), "beam", 5, theory="euler-bernoulli", elements=80)
    along_z = [x**2 / (2.0 * pi) * 0.01 * sqrt(E / RHO / 12.0) for x in ROOTS]
    along_y = [2.0 * frequency for frequency in along_z[:2]]
    # Fourth order: 3e-7 of mode 3 at 80 elements.
    assert frequencies == pytest.approx(sorted([*along_z, *along_y]), rel=3e-6)


def timoshenko(length, second, area, kappa, near):
    """Frequency (Hz) of a free-free Timoshenko beam close to `near`, by its transfer matrix.

    `second` is the second moment of area I (m⁴). State (w, ψ, M, Q): Q = κGA (w′ − ψ), M = EI ψ′,
    M′ = −Q − ρIω²ψ, Q′ = −ρAω²w.
    """

    def determinant(frequency):
        squared = (2.0 * pi * frequency) ** 2
        rates = np.zeros((4, 4))
        rates[0, 1], rates[0, 3] = 1.0, 1.0 / (kappa * G * area)
        rates[1, 2] = 1.0 / (E * second)
        rates[2, 3], rates[2, 1] = -1.0, -RHO * second * squared
        rates[3, 0] = -RHO * area * squared
        # Ends without moment and force.
        return np.linalg.det(expm(length * rates)[2:, :2])

    return brentq(determinant, 0.98 * near, 1.02 * near, xtol=1e-12 * near)


KAPPA = 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU)
THICK = bar(0.2, 0.03, 0.02)


def test_free_thick_bar_is_timoshenko():
    """Bending in both planes, order 4 in 1/elements. Axial modes: √(E/ρ) / 2L."""
    frequencies = free(THICK, "beam", 8, elements=80)
    A, L = 6e-4, 0.2
    for number, second in ((0, 0.03 * 0.02**3 / 12), (1, 0.02 * 0.03**3 / 12)):
        exact = timoshenko(L, second, A, KAPPA, frequencies[number])
        assert frequencies[number] == pytest.approx(exact, rel=1e-6)
    # Linear shapes: second order, π²/24 of (1/80)² = 6e-5 of the first mode.
    stretch = sqrt(E / RHO) / (2.0 * L)
    assert np.abs(frequencies / stretch - 1.0).min() < 1e-4


def test_free_segments_converge_to_beam():
    """Thick bar, 20 and 40 segments against 80 beam elements: order two."""
    coarse, fine = (free(THICK, "segments", 2, elements=n) for n in (20, 40))
    beam = free(THICK, "beam", 2, elements=80)
    order = np.log2((coarse - beam) / (fine - beam))
    # Half springs at the ends: second order.
    assert order == pytest.approx([2.0, 2.0], abs=0.1)


def test_free_solid_bar_has_all_modes():
    """Six rigid-body modes lie below the first bending mode of a solid with L/h = 10.

    That mode is within 1e-3 of Timoshenko's theory with Cowper's coefficient.
    """
    frequencies = free(THICK, "solid", 3, divisions=2)
    exact = timoshenko(0.2, 0.03 * 0.02**3 / 12, 6e-4, KAPPA, frequencies[0])
    assert frequencies[0] == pytest.approx(exact, rel=1e-3)
    leg = ConstantLeg(0.2, Rectangle(0.03, 0.02), Material.isotropic(E, NU, RHO), None, "bar")
    rooted = clamped_solid(leg, 2, "free")
    places = (0.5 * frequencies[0], 1.001 * frequencies[0])
    below = [rooted.free_inertia((2.0 * pi * frequency) ** 2).negative for frequency in places]
    assert below == [6, 7]


def test_supported_body_is_not_free():
    """A spring as stiff as the bar between one end and ground leaves five rigid-body motions."""
    leg = ConstantLeg(0.2, Rectangle(0.03, 0.02), Material.isotropic(E, NU, RHO), None, "bar")
    matrices = leg_matrices("beam", leg)
    assert len(free_frequencies(matrices, 3)) == 3
    stiffness = dense(matrices.stiffness).copy()
    stiffness[1, 1] += 1e7
    with pytest.raises(ComputationError, match="5 rigid-body modes found"):
        free_frequencies(replace(matrices, stiffness=stiffness), 3)


def test_free_free_ends_need_a_body(tmp_path, capsys):
    """Free ends also need a model with mass. JSON then has frequencies and no compliance."""
    with pytest.raises(InputError) as refused:
        api.solve(THICK, "vjm", ends="free-free")
    assert refused.value.faults == (
        "ends free-free: only for a single body; name it with body",
        "ends free-free: model vjm of a body has no frequencies; choose another model",
    )

    path = tmp_path / "bar.toml"
    path.write_text(toml_of(THICK))
    options = ["--model", "beam", "--body", "bar", "--ends", "free-free", "--modes", "1", "--json"]
    assert cli.main(["solve", str(path), *options]) == 0
    (result,) = json.loads(capsys.readouterr().out)["results"]
    assert set(result) >= {"body", "frequencies", "rigid"}
    assert result["rigid"] == 6
    assert "compliance" not in result


def test_rounding_of_6x6_affects_free_modes():
    """The 6×6 of the paper's leg is rounded to three digits: frequencies are uncertain.

    A free body has no compliance."""
    (answer,) = api.solve("ifw", "segments", leg=1, modes=3, ends="free-free").answers
    assert answer.rigid == 6
    assert answer.of_digits.compliance.size == 0
    assert np.all(answer.of_digits.frequencies > 0.0)


def test_free_plate_equals_nafems_fv12():
    """NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), Test FV12, free square plate.

    10 × 10 × 0.05 m, E = 200 GPa, ν = 0.3, 8000 kg/m³: 1.622, 2.360, 2.922 Hz after the six
    rigid-body motions, with one quadratic element across the thickness (1e-3). A. W. Leissa (J.
    Sound Vib. 31 (1973) 257) has upper bounds λ = ωa²√(ρh/D) of the first five, within 1 %.
    """
    plate = ConstantLeg(10.0, Rectangle(10.0, 0.05), Material.isotropic(200e9, 0.3, 8000.0))
    frequencies = leg_frequencies("solid", plate, 5, ModelOptions(divisions=1), free=True)
    assert frequencies[:3] == pytest.approx([1.622, 2.360, 2.922], rel=1.2e-3)
    assert frequencies[4] == pytest.approx(frequencies[3], rel=1e-6)
    unit = sqrt(200e9 * 0.05**2 / (12.0 * (1.0 - 0.3**2) * 8000.0)) / (2.0 * pi * 10.0**2)
    bounds = unit * np.array([13.489, 19.789, 24.432, 35.024, 35.024])
    assert (frequencies < bounds).all()
    assert frequencies == pytest.approx(bounds, rel=0.01)
