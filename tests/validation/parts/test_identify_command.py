"""`flexproof identify`: numbers, uncertainties, the table to paste, the cache, wrong requests."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from forgetting import forget

from lumped.mechanism.placing import leg_frame
from lumped.screws import turn_matrix
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.parts import identify as identifying
from validation.parts.identified_text import as_text, toml
from validation.parts.identify import Identified
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
def test_three_interfaces_in_numbers_and_from_the_cache(command, cache, monkeypatch, tmp_path):
    few = ["--unknowns", "9000", "--modes", "2"]
    found = command.json(*asked(BORES, *few, "--out", tmp_path / "rocker.npz"))
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
    assert command.json(*asked(BORES, *few)) == found
    damaged = bytearray(file.read_bytes())
    damaged[-40] ^= 1
    file.write_bytes(damaged)
    forget()
    assert kept(file.stem, lambda: {"anew": np.ones(1)}, dict)["anew"] == 1.0


@pytest.mark.usefixtures("cache")
def test_two_interfaces_give_a_table_to_paste(command):
    said = command.told(*asked(BORES[:2], "--unknowns", "1000", "--modes", "1"))
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
    command, monkeypatch, bores, material, more, said
):
    monkeypatch.setattr(identifying, "identify", lambda *_: pytest.fail("computed"))
    assert re.search(said, command.refused(*asked(bores, *more.split(), material=material)))


# Leads along no axis of the file.
ENDS = (np.array([0.1, 0.2, -0.1]), np.array([0.4, 0.6, 0.3]))


@pytest.fixture
def found():
    part = PartFile(Path("arm.step"), "mm", [0.5, 0.6, 0.4], np.zeros((0, 3)), (), None, None)
    interfaces = tuple(
        Interface(name, (number,), point, "rigid", "as asked for", None, None, 1.0)
        for number, (name, point) in enumerate(zip("AB", ENDS, strict=True), start=1)
    )
    root = np.random.default_rng(5).normal(size=(6, 6))
    C = 1e-8 * (root @ root.T + np.eye(6))
    return Identified(
        part=part, interfaces=interfaces, density=7850.0, total=12.5, centre=np.zeros(3),
        inertia=np.eye(3), stiffness=np.zeros((12, 12)), mass=np.zeros((12, 12)), compliance=C,
        frequencies=np.array([200.0]), compliance_refinement=0.01 * C,
        frequency_refinement=np.array([0.5]), compliance_bracket=0.03 * C,
        frequency_bracket=np.array([-4.0]), counted=1, counted_below=205.0,
        unknowns=(10, 20, 30), elements=7, straightened=0,
        places=np.zeros((0, 3)), shares=np.zeros(0), shapes=np.zeros((0, 12)),
    )  # fmt: skip


def test_the_table_for_a_robot_file_is_the_part_in_the_axes_that_it_names(found):
    leg = tomllib.loads(toml(found))["bodies"]["arm"]
    assert (leg["from"], leg["to"], leg["mass"]) == ("A", "B", 12.5)
    # As a robot file is read: x from point to point, z as near to "up" as it can be.
    axes = leg_frame(*ENDS, np.array(leg["up"])).rotation
    read = turn_matrix(np.array(leg["compliance"]), axes)
    assert read == pytest.approx(found.compliance, rel=1e-8, abs=1e-16)
    # With another direction up it is another leg.
    other = turn_matrix(np.array(leg["compliance"]), leg_frame(*ENDS, np.ones(3)).rotation)
    assert other != pytest.approx(found.compliance, rel=1e-3, abs=1e-16)


def test_people_read_both_uncertainties_in_percent(found):
    lines = as_text(found).splitlines()
    (row,) = (line.split() for line in lines if line.startswith("  B φz"))
    assert float(row[2]) == pytest.approx(found.compliance[5, 5], rel=1e-5)
    assert row[3:] == ["±", "1.000", "%", "3.000", "%"]
    assert "  1          200.00  ±    0.250 %    -2.000 %" in lines
    said = "frequencies with A clamped (Hz); 1 counted below 205 Hz, none missing; columns as above"
    assert said in lines
    unknown = as_text(replace(found, frequency_refinement=np.array([np.nan])))
    (row,) = (line.split() for line in unknown.splitlines() if line.startswith("  1 "))
    assert row == ["1", "200.00", "±", "–", "-2.000", "%"]
