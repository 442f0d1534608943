"""Half-widths of references due to meshes, for errors that are known beforehand."""

import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation.context import Context
from validation.references import mesh_uncertainty
from validation.references.reference_legs import SECTION_DIVISIONS, SLOWEST_ORDER
from validation.references.robot_on_path import robot_on_path
from validation.solids.leg_meshes import COARSEST_WALLS
from validation.uncertainty.mesh_half_widths import UNPROVEN, half_widths_on


@pytest.mark.parametrize("row", ["_STATIC_SECTIONS", "_MODAL_SECTIONS"])
def test_section_half_width_uses_mesh_of_solid(row, monkeypatch):
    """Solids have the coarse section mesh of n divisions, of error n^-p: the half-width is 3 n^-p.

    The formula of the fine mesh gave 1.19 times the error (2^p = 2.52, p = 4/3).
    """
    monkeypatch.setattr(mesh_uncertainty, "shares_section", lambda *_: True)
    policy = getattr(mesh_uncertainty, row).policy(robot_on_path(Context(load_robot("five-bar"))))
    errors = [float(n) ** -SLOWEST_ORDER for n in (COARSEST_WALLS, SECTION_DIVISIONS)]
    half_width = half_widths_on(
        (0, 1), policy, lambda level: np.array(1.0 + errors[level]), lambda a, b, _: abs(a - b)
    )
    assert half_width == pytest.approx(UNPROVEN * errors[0], rel=1e-12)
