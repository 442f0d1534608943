"""`identify --free` and `solve --ends free-free` of CAD parts."""

import json
from math import pi

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from support.robots.drawn_parts import written

import flexproof as fp
from lumped.errors import InputError
from validation import cli

E, NU, RHO = 2.1e11, 0.3, 7850.0
MATERIAL = {"E": E, "nu": NU, "rho": RHO}
LENGTH, WIDTH, HEIGHT = 0.4, 0.02, 0.03
KAPPA = 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU)


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    path = tmp_path_factory.mktemp("free") / "bar.step"
    sizes = [1000.0 * size for size in (LENGTH, WIDTH, HEIGHT)]
    return written(path, lambda occ: occ.addBox(0.0, 0.0, 0.0, *sizes))


def timoshenko(height, width, near):
    """Frequency (Hz) of a free-free Timoshenko beam close to `near` (Hz).

    Root of the transfer matrix of (w, ψ, M, Q).
    """
    area, second = width * height, width * height**3 / 12.0

    def determinant(frequency):
        squared = (2.0 * pi * frequency) ** 2
        rates = np.zeros((4, 4))
        rates[0, 1], rates[0, 3] = 1.0, 2.0 * (1.0 + NU) / (KAPPA * E * area)
        rates[1, 2] = 1.0 / (E * second)
        rates[2, 3], rates[2, 1] = -1.0, -RHO * second * squared
        rates[3, 0] = -RHO * area * squared
        return np.linalg.det(expm(LENGTH * rates)[2:, :2])

    return brentq(determinant, 0.95 * near, 1.05 * near, xtol=1e-12 * near)


def test_free_bar_equals_timoshenko(bar):
    """First bending frequency in each plane.

    The tolerance is the half-width of the meshes plus 1e-3, the error of Cowper's coefficient.
    """
    part = fp.identify_free(bar, material=MATERIAL, unknowns=12_000, modes=2)
    assert part.rigid == 6
    assert part.counted >= 2
    assert part.total == pytest.approx(RHO * LENGTH * WIDTH * HEIGHT, rel=1e-9)
    for value, half_width, sides in zip(
        part.frequencies,
        part.frequency_refinement,
        ((WIDTH, HEIGHT), (HEIGHT, WIDTH)),
        strict=True,
    ):
        exact = timoshenko(*sides, value)
        assert abs(value - exact) < half_width + 1e-3 * exact
        assert half_width < 0.02 * value
    assert [row[0] for row in part.table().rows] == ["f1", "f2"]


def test_free_part_command_prints_modes(bar, capsys):
    """Text and JSON: six rigid-body motions are counted, and one frequency."""
    options = ["--material", "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }", "--unknowns", "2000"]
    assert cli.main(["identify", str(bar), "--free", "--modes", "1", *options]) == 0
    assert "rigid-body motions, counted and omitted: 6" in capsys.readouterr().out
    assert cli.main(["identify", str(bar), "--free", "--modes", "1", "--json", *options]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["rigid"] == 6
    assert len(document["frequencies"]) == 1


def test_invalid_free_request_is_refused(bar, capsys):
    """Interfaces, zero modes or no material."""
    options = ["--interface", "A = { faces = [1] }", "--modes", "0"]
    assert cli.main(["identify", str(bar), "--free", *options]) == 2
    errors = capsys.readouterr().err
    assert "--interface: a part without supports has none; leave it out" in errors
    assert (
        "--modes 0: a part without supports has no results but frequencies; must be 1 or more"
        in errors
    )
    with pytest.raises(InputError) as raised:
        fp.identify_free(bar, modes=0)
    assert [fault.split(":")[0] for fault in raised.value.faults] == ["material", "modes = 0"]
    with pytest.raises(InputError, match="body: not with material or unit, which are in the robot"):
        fp.identify_free(bar, body="bar", unit="mm")


def test_part_of_robot_is_solved_free(bar):
    """A part of a robot has the same free frequencies as its CAD file. It has no beam model."""
    robot = {
        "schema": 2,
        "name": "bar",
        "points": {"A": [0.0, WIDTH / 2, HEIGHT / 2], "B": [LENGTH, WIDTH / 2, HEIGHT / 2]},
        "bodies": {
            "bar": {
                "step": str(bar),
                "material": MATERIAL,
                "interfaces": {
                    "A": {"plane": {"normal": [-1.0, 0.0, 0.0]}},
                    "B": {"plane": {"normal": [1.0, 0.0, 0.0]}},
                },
            }
        },
        "joints": {"root": {"type": "fixed", "between": ["ground", "bar"], "at": "A"}},
        "tool": {"body": "bar", "point": "B", "moves": []},
    }
    identification = fp.identify_free(robot, body="bar", unknowns=12_000, modes=1)
    alone = fp.identify_free(bar, material=MATERIAL, unknowns=12_000, modes=1)
    assert identification.frequencies == pytest.approx(alone.frequencies, rel=1e-9)
    with pytest.raises(InputError, match="is a part from a file, which is a solid"):
        fp.solve(robot, "beam", body="bar", modes=1, ends="free-free")
