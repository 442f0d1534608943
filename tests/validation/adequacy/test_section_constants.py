"""Legs with sections given by constants: models run, and verdicts are undecided."""

import pytest
from support.robots.robot_from_text import described, robot_of

from lumped.errors import InputError
from lumped.models.bodies import legs_of
from validation.adequacy.robot_verdicts import robot_adequacy
from validation.case import Skip
from validation.cases.leg_theory import compliances
from validation.context import Context
from validation.models.leg_models import clamped_solid, leg_compliance
from validation.solids.solid_size import why_shapeless

ARM = """
schema = 2
name = "arm"
{units}
[points]
A = [0.0, 0.0, 0.0]
P = [{length}, 0.0, 0.0]

[bodies.arm]
from = "A"
to = "P"
section = {section}
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}

[joints.root]
type = "fixed"
between = ["ground", "arm"]
at = "A"

[tool]
body = "arm"
point = "P"
moves = []
"""
METRES = (
    '{ shape = "properties", A = 1.3e-3, Iy = 2.1e-6, Iz = 3.3e-7, J = 2.5e-8, Iyz = 1e-7, '
    "Ay = 6e-4, Az = 5e-4, ys = -0.03 }"
)
MILLIMETRES = (
    '{ shape = "properties", A = 1.3e3, Iy = 2.1e6, Iz = 3.3e5, J = 2.5e4, Iyz = 1e5, '
    "Ay = 6e2, Az = 5e2, ys = -30.0 }"
)


def test_section_constants_use_file_unit():
    """Areas in mm², moments of area in mm⁴, and corners of polygons in mm."""
    metres, millimetres = (
        legs_of(described(ARM.format(section=section, length=length, units=units)))["arm"]
        for section, length, units in ((METRES, 0.6, ""), (MILLIMETRES, 600.0, 'units = "mm"'))
    )
    assert leg_compliance("beam", millimetres) == pytest.approx(
        leg_compliance("vjm", metres), rel=1e-9, abs=1e-16
    )
    corners = '{ shape = "polygon", outline = [[0.0, 0.0], [60.0, 0.0], [0.0, 40.0]] }'
    triangle = described(ARM.format(section=corners, length=600.0, units='units = "mm"'))
    assert legs_of(triangle)["arm"].section.area == pytest.approx(0.5 * 0.06 * 0.04, rel=1e-12)


def test_constants_give_no_verdict(tmp_path):
    """Every quantity is undecided, with the reason that a section by constants has no solid."""
    robot_file = robot_of(ARM.format(section=METRES, length=0.6, units=""), tmp_path)
    (leg,) = legs_of(robot_file.mechanism).values()
    reason = why_shapeless([leg])
    assert reason.startswith(
        "arm (properties): a section by its constants has no outline that could be meshed"
    )
    assert why_shapeless([leg, leg]) == reason
    with pytest.raises(InputError, match="properties: solids need a section with an outline"):
        clamped_solid(leg, 2, "rigid")
    context = Context(robot_file, "quick")
    with pytest.raises(
        Skip, match="a section by its constants has no outline that could be meshed"
    ):
        compliances(context, "arm", "free")
    matrix = robot_adequacy(context)
    of_beams = [entry for entry in matrix.entries if entry.model in {"vjm", "beam", "segments"}]
    assert of_beams
    assert all(entry.verdict == "undecided" and entry.error is None for entry in of_beams)
