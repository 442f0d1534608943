"""CAD parts as stepped beams or condensed solids: values by hand, bounds, table without verdicts.

A slender bar has the frequencies of Euler's and Bernoulli's cantilever, (λL)² = 3.5160 and 22.034;
condensed on its ends it is one cubic element with consistent mass, 3.5327 and 34.807.
"""

import numpy as np
import pytest
from support.robots.crane import write_crane, write_overlapping_crane
from support.robots.drawn_parts import plane_ends, written

from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.legs import Material
from lumped.mechanism.body import Body, Frame, Part
from lumped.robot_file import load_robot
from validation.comparisons import part_models_vs_solid
from validation.comparisons.agreement_rows import agreement_rows
from validation.comparisons.discretisations import Discretisation
from validation.comparisons.part_models_vs_solid import (
    QUANTITIES,
    cases,
    condensed_values,
    parts_as_legs,
    solid_values,
    stepped_values,
)
from validation.context import Context
from validation.report.agreement import agreement_sentence, agreement_tables
from validation.run.outcome import judge

pytestmark = pytest.mark.usefixtures("coarse_parts")
E, RHO, LENGTH, SIDE = 2.1e11, 7850.0, 0.3, 0.02
AREA, SECOND_MOMENT = SIDE**2, SIDE**4 / 12.0
AT = {name: index for index, name in enumerate(QUANTITIES)}


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    file = written(
        tmp_path_factory.mktemp("bar") / "bar.step",
        lambda occ: occ.addBox(0, -10, -10, 300, 20, 20),
    )
    ends = plane_ends(LENGTH, "average")
    points = {"A": Frame(), "B": Frame(np.array([LENGTH, 0.0, 0.0]))}
    return Body("bar", Part(file, Material.isotropic(E, 0.0, RHO), ends, None), points)


def test_cad_bar_equals_cantilever(bar):
    """Solid and stepped beam: L/EA, L³/3EI, L/EI and f1, to 0.5 %."""
    solid, stepped = solid_values(bar).values, stepped_values(bar, Discretisation("beam"))
    speed = np.sqrt(E * SECOND_MOMENT / (RHO * AREA)) / LENGTH**2 / (2.0 * np.pi)
    for values in (solid, stepped):
        assert values[AT["x"]] == pytest.approx(LENGTH / (E * AREA), rel=2e-3)
        # Shear adds 0.2 %.
        bending = LENGTH**3 / (3.0 * E * SECOND_MOMENT)
        assert values[[AT["y"], AT["z"]]] == pytest.approx(bending, rel=5e-3)
        assert values[AT["φz"]] == pytest.approx(LENGTH / (E * SECOND_MOMENT), rel=5e-3)
        assert values[AT["f1"]] == pytest.approx(3.5160 * speed, rel=5e-3)


def test_condensed_bar_equals_beam_element(bar):
    """Exact in statics; f1 is 0.5 % and f3 58 % above the solid's."""
    solid, condensed = solid_values(bar).values, condensed_values(bar)
    shares = condensed / solid - 1.0
    np.testing.assert_allclose(shares[: AT["f1"]], 0.0, atol=1e-6)
    assert shares[AT["f1"]] == pytest.approx(3.5327 / 3.5160 - 1.0, abs=1e-3)
    # Shear and rotary inertia take 2 % of the second frequency.
    assert shares[AT["f3"]] == pytest.approx(34.807 / 22.034 - 1.0, abs=0.03)


def outcomes_of(path):
    robot_file = load_robot(path)
    names = parts_as_legs(robot_file.mechanism)
    context = Context(robot_file, "quick")
    return [
        judge(case, case.measure(context), 0.0)
        for case in cases(parts=names, limits=DEFAULT_LIMITS)
    ]


def test_part_table_has_no_verdicts(tmp_path):
    """Idealisations of a CAD part differ from the solid by design: differences without marks."""
    (outcome,) = outcomes_of(write_crane(tmp_path))
    assert outcome.verdict == "agree"
    (table,) = agreement_tables([outcome])
    assert not table.judged
    assert table.quantities == QUANTITIES
    names = [name for name, _ in table.rows]
    assert names == ["Segments, stepped (20)", "Beam FE, stepped (20)", "Condensed"]
    cells = [cell for _, row in table.rows for cell in row]
    assert len(cells) == 3 * len(QUANTITIES)
    assert all(cell.verdict is None and not cell.mark for cell in cells)
    by_place = {
        (unjudged.model, unjudged.label): unjudged for unjudged in outcome.measurement.shown
    }
    stepped = by_place["beam-stepped", "y"]
    assert stepped.share != 0.0
    text = table.rows[1][1][AT["y"]].text.replace("−", "-").split("\N{NO-BREAK SPACE}")[0]
    assert float(text) == pytest.approx(100.0 * stepped.share, abs=5e-3)
    rows = {row[1:3]: row for row in agreement_rows([outcome]).rows}
    row = rows[stepped.model, "y"]
    assert (row[0], *row[3:6]) == (outcome.case.body, "m/N", stepped.value, stepped.reference)
    assert row[6] == pytest.approx(100.0 * stepped.share, abs=5.1e-7)
    assert row[-2:] == (None, "not judged")
    sentence = agreement_sentence([outcome])
    assert "agree" not in sentence
    start = (
        "Largest differences between simplified CAD parts and their solid FE: stepped beams up to"
    )
    assert sentence.startswith(start)


def test_heavier_condensed_part_disagrees(tmp_path, monkeypatch):
    """The mass of the condensed part is 2 % too large.

    With the correct mass, f1 and f2 are 0.3 % above the solid's.
    """
    right = part_models_vs_solid.condensed_values
    monkeypatch.setattr(
        part_models_vs_solid, "condensed_values", lambda body: right(body) / np.sqrt(1.02)
    )
    (outcome,) = outcomes_of(write_crane(tmp_path))
    assert outcome.verdict == "disagree"


def test_part_without_pieces_is_condensed(tmp_path):
    """Interfaces overlap: the table has the condensed model alone, and the reason."""
    write_overlapping_crane(tmp_path)
    (outcome,) = outcomes_of(tmp_path / "robot.toml")
    (table,) = agreement_tables([outcome])
    assert [name for name, _ in table.rows] == ["Condensed"]
    assert "interfaces of the part overlap" in " ".join(table.notes)
    assert "solid FE: condensed parts up to" in agreement_sentence([outcome])
