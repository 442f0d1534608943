"""Solids of slender legs: sizes are estimated in advance, and too large ones are omitted."""

import re

import pytest
from support.robots.paper_robot_variants import IFW, file_of, placed_at, variant_of_ifw

from fem.bodies.solid import solid_mesh
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, Rectangle, Tube
from validation.case import Skip
from validation.catalogue import catalogue
from validation.context import Context
from validation.references import modal_reference as of_mechanisms
from validation.references.reference_legs import finer_statics, solid_leg
from validation.references.responses import Responses
from validation.references.robot_on_path import robot_at
from validation.report.figures import modes
from validation.solids.solid_size import LARGEST, solid_unknowns, too_large
from validation.validate import Request, validate

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# A strip: elements of 0.5 by 3.1 by 3.1 mm over 0.85 m and 50 mm, 272 slices of 2 by 16.
BLADE = ConstantLeg(0.85, Rectangle(0.001, 0.05), STEEL, name="leg 1")
SLENDER = file_of(variant_of_ifw(leg1=BLADE, leg2=BLADE))
REASON = (
    r"^leg1 as a solid of 2 divisions has about 2.7e\+05.* unknowns; preset quick allows 100000"
)


@pytest.fixture
def context(monkeypatch):
    """Context of a quick run in which meshing a solid is an error."""
    for module in ("validation.solids.solid_legs", "fem.bodies.solid"):
        monkeypatch.setattr(f"{module}.solid_mesh", refused)
    return Context(SLENDER, "quick")


def refused(*_):
    pytest.fail("a solid of 270 000 unknowns is meshed")


@pytest.mark.parametrize("divisions", [1, 3])
def test_estimated_unknowns_equal_mesh(divisions):
    """Exact for rectangles; for circles at most 1.8 times the unknowns of the mesh."""
    for section in (Rectangle(0.1, 0.06), Rectangle(0.002, 0.06)):
        leg = ConstantLeg(0.5, section, STEEL)
        assert solid_unknowns(leg, divisions) == 3 * len(solid_mesh(leg, divisions).nodes)
    # The five blocks of a circle share the nodes on their edges, at worst 45 on 25 places.
    disc = ConstantLeg(0.5, Circle(0.1), STEEL)
    estimated, meshed = solid_unknowns(disc, divisions), 3 * len(solid_mesh(disc, divisions).nodes)
    assert meshed <= estimated <= 1.8 * meshed


def test_too_large_legs_are_listed():
    """Name, divisions and unknowns, and the limit of the preset."""
    stout = ConstantLeg(0.5, Rectangle(0.1, 0.06), STEEL, name="leg 2")
    assert too_large([stout, stout], [2, 2], "quick") == ""
    message = too_large([BLADE, stout], [4, 2], "fine")
    assert message.startswith("leg 1 as a solid of 4 divisions has about 1.9e+06")
    assert "leg 2" not in message
    assert f"preset fine allows {LARGEST['fine']}" in message


def test_missing_reference_has_reason(context):
    """If the solids are too large, there is no other reference: all verdicts are undecided."""
    robot = robot_at(context, placed_at(SLENDER.mechanism))
    reference = of_mechanisms.dynamic_reference(Responses(robot))
    assert not reference.interpretations
    assert re.match(REASON, reference.decides)


def test_unpaired_modes_figure_has_reason(context):
    """The figure of paired modes is skipped if the reference is too large."""
    with pytest.raises(Skip, match="no reference for the frequencies: leg1 as a solid"):
        modes.pairs(context)


def test_too_large_export_is_refused_before_run(tmp_path):
    """`--export` of solids beyond the limit: no folder is made."""
    request = Request(SLENDER, "quick", tmp_path / "run", 1, export=True)
    with pytest.raises(InputError, match=REASON.replace("^", "^--export: ")):
        validate(request, catalogue)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("thickness", "message"),
    [(2e-4, "preset fine allows this mesh$"), (5e-5, "no preset allows this mesh$")],
)
def test_too_large_leg_names_preset(thickness, message):
    """The message names the preset that allows the solid, or states that none does."""
    foil = ConstantLeg(0.85, Tube(0.12, thickness), STEEL, name="leg 1")
    with pytest.raises(InputError, match=message):
        solid_leg(Context(IFW, "quick"), foil)


@pytest.mark.parametrize(
    ("preset", "message"),
    [("quick", "--preset fine"), ("standard", "--preset fine"), ("fine", "no preset")],
)
def test_undecided_entry_names_preset(preset, message):
    """The remedy for mesh uncertainty is the next finer preset, if there is one."""
    # 0.1 m by 0.06 m: 900 unknowns are six divisions, and so they are at standard; fine has more.
    leg = ConstantLeg(0.5, Rectangle(0.1, 0.06), STEEL)
    uncertain = "undecided because of the mesh uncertainty of the reference"
    due = f"{uncertain}; {message} has a finer one"
    assert finer_statics(Context(IFW, preset), [leg]) == due
