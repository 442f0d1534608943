"""`flexproof identify`: numbers, uncertainties, the table to paste, the cache, wrong requests."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from forgetting import forget

from validation import cli
from validation.parts import identify as identifying
from validation.run.cache import kept

ROCKER = Path(__file__).resolve().parents[3] / "examples" / "rocker" / "rocker.step"
BORES = [
    "A = { cylinder = { radius = 0.022 } }",
    "B = { cylinder = { radius = 0.016, point = [0.26, 0.0, 0.0] } }",
    "C = { cylinder = { radius = 0.016, point = [0.09, 0.18, 0.0] }, coupling = 'average' }",
]
STEEL = "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }"


def asked(bores, *more, material=STEEL) -> list[str]:
    chosen = [word for bore in bores for word in ("--interface", bore)]
    return ["identify", str(ROCKER), *chosen, "--material", material, *more]


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "flexproof"


@pytest.mark.exhaustive
def test_three_interfaces_in_numbers_and_from_the_cache(capsys, cache, monkeypatch, tmp_path):
    few = ["--unknowns", "9000", "--modes", "2", "--json"]
    assert cli.main(asked(BORES, *few, "--out", str(tmp_path / "rocker.npz"))) == 0
    found = json.loads(capsys.readouterr().out)
    K = np.array(found["stiffness"])
    assert K.shape == (18, 18)
    assert np.array_equal(K, K.T)
    assert [i["coupling"] for i in found["interfaces"]] == ["rigid", "rigid", "average"]
    # The mesh misses the drawing's volume by its circles of twelve sides and more alone.
    assert abs(found["volume_deviation"]) < 1e-4
    assert np.load(tmp_path / "rocker.npz")["stiffness"] == pytest.approx(K, rel=1e-15)
    compliance, bracket = np.array(found["compliance"]), np.array(found["bracket"]["compliance"])
    assert np.all(np.diag(bracket) > 0.0)
    assert np.all(np.diag(np.array(found["uncertainty"]["compliance"])) < 0.2 * np.diag(compliance))

    # A second time nothing is meshed; a damaged file is as good as none.
    (file,) = (one for one in cache.glob("*.npz") if b"compliance_bracket" in one.read_bytes())
    forget()
    monkeypatch.setattr(identifying, "_computed", lambda *_: pytest.fail("computed again"))
    assert cli.main(asked(BORES, *few)) == 0
    assert json.loads(capsys.readouterr().out) == found
    damaged = bytearray(file.read_bytes())
    damaged[-40] ^= 1
    file.write_bytes(damaged)
    forget()
    assert kept(file.stem, lambda: {"anew": np.ones(1)}, dict)["anew"] == 1.0


@pytest.mark.usefixtures("cache")
def test_two_interfaces_give_a_table_to_paste(capsys):
    assert cli.main(asked(BORES[:2], "--unknowns", "1000", "--modes", "1")) == 0
    said = capsys.readouterr().out
    assert "rigid by default: the pin" in said
    leg = tomllib.loads(said[said.index("[bodies.rocker]") :])["bodies"]["rocker"]
    assert (leg["from"], leg["to"]) == ("A", "B")
    compliance = np.array(leg["compliance"])
    assert np.linalg.eigvalsh(compliance)[0] > 0.0
    # In the plane of the plate it is the web that bends: across it, it is softer.
    assert compliance[2, 2] > compliance[1, 1]


# Interfaces, material, further words, and what is said.
WRONG = [
    ([], STEEL, "", "--interface: missing"),
    ([""], STEEL, "", "--interface '': names none"),
    (["A"], STEEL, "", "not TOML"),
    (["A = { face = [1] }"], STEEL, "", 'unknown key; did you mean "faces"?'),
    (["A = { faces = [99] }"], STEEL, "", "face 99 does not exist.*1 to 12"),
    ([BORES[0], BORES[0]], STEEL, "", "A: given twice"),
    (BORES, STEEL, "--modes 1.7", 'Invalid value "1.7" for --modes. Must be a whole number'),
    (BORES, STEEL, "--modes 100000", "--modes = 100000: must be from 0 to 100"),
    (BORES, STEEL, "--unknowns 999", "--unknowns = 999: must be from 1000 to 10000000"),
    (BORES, STEEL, "--unknowns 1000000000", "--unknowns = 1000000000: must be from 1000 to"),
    (BORES, STEEL, f"--out {ROCKER}/matrices.npz", "rocker.step is no folder"),
    (BORES, "{ E = 2.1e11, nu = 0.3 }", "", "rho: missing"),
    (BORES, STEEL.replace("nu", "G = 1e10, nu"), "", "isotropic"),
    (BORES, "steel", "", "not TOML"),
    (BORES, f"{STEEL}\nloss = 0.1", "", "must be a table"),
]


@pytest.mark.parametrize(("bores", "material", "more", "said"), WRONG, ids=lambda of: str(of)[-25:])
def test_a_wrong_request_is_one_line_before_anything_is_computed(
    capsys, monkeypatch, bores, material, more, said
):
    monkeypatch.setattr(identifying, "identify", lambda *_: pytest.fail("computed"))
    assert cli.main(asked(bores, *more.split(), material=material)) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search(said, line)
