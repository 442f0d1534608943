"""A bar pulled and bent by averaged ends: a patch test, exact on any mesh of the second order.

Even and linearly varying tractions meet Saint-Venant's stresses, whose displacements are quadratic
in the coordinates: nothing is left to refine, whatever Poisson's ratio.
"""

from types import ModuleType

import numpy as np

from fem.bodies.part import grips_of, held_part, meshed_part
from lumped.arrays import Array
from lumped.legs import Material
from meshes.part.interfaces import find_interfaces
from validation.agreement.differences import farthest_off
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.parts.drawing import SECTION, plane_ends, read_again
from validation.context import Context

_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Along x, y and z (mm), and elements' size (mm).
_BAR, _SIZE = (120.0, 40.0, 24.0), 20.0
_MM = 1e-3
# Pull along x, and bending about y and z.
_LOADS = [0, 4, 5]

cases = CaseGroup(section=SECTION, group="program.parts.bar", subject="program")


def bar_compliance() -> Array:
    """Compliance (6×6, SI) of one averaged end from the other."""
    part, mesh = read_again("bar", _drawn, _SIZE)
    grips = grips_of(mesh, find_interfaces(part, plane_ends(_BAR[0] * _MM, "average")))
    return held_part(meshed_part(mesh, _STEEL), grips, "bar").compliance


def _drawn(kernel: ModuleType) -> None:
    x, y, z = _BAR
    kernel.addBox(0.0, -y / 2.0, -z / 2.0, x, y, z)


@cases.case(
    "program.parts.bar.patch",
    "A bar between averaged ends stretches and bends as Saint-Venant's, on a coarse mesh",
    quantity="largest difference of the columns of pull and bending in units of √(c_ii c_jj)",
    unit="1",
    reference_kind="closed-form",
    citation="N L/EA; M L/EI and M L²/2EI: even and linear tractions",
    tolerance=Absolute(1e-9),
    tolerance_reason="quadratic displacements are exact: rounding",
)
def _patch(context: Context) -> Measurement:
    l, b, h = (_MM * side for side in _BAR)
    E, area = _STEEL.E, b * h
    about_y, about_z = b * h**3 / 12.0, h * b**3 / 12.0
    expected = np.zeros((6, 3))
    expected[0, 0] = l / (E * area)
    expected[[4, 2], 1] = l / (E * about_y), -(l**2) / (2.0 * E * about_y)
    expected[[5, 1], 2] = l / (E * about_z), l**2 / (2.0 * E * about_z)
    found = context.get(bar_compliance)
    scale = np.sqrt(np.diag(found))
    return farthest_off(((found[:, _LOADS] - expected) / np.outer(scale, scale[_LOADS])).ravel())
