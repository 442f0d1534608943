"""A hollow box of falling height: its pieces as a stepped leg, and its modes with held ends.

All its faces are plane, so that sections cut from a mesh are exact whatever the mesh.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np
from scipy.linalg import eigh

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.elements.elasticity import on_three_components
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import HeldBody
from lumped.arrays import Array
from lumped.legs import Material
from lumped.mechanism.body import Body, Frame
from lumped.mechanism.part import Part
from lumped.models.cantilever import tip_compliance_of
from meshes.part.interfaces import find_interfaces
from validation.agreement.differences import farthest_off
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.parts.drawing import SECTION, meshed, plane_ends, read_again
from validation.context import Context
from validation.models.legs import leg_matrices
from validation.models.options import ModelOptions
from validation.models.stepped_parts import stepped

_STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Along x, width, heights at both ends, and width and height of the hole through it (mm).
_LENGTH, _WIDTH, _HEIGHTS, _HOLE = 300.0, 40.0, (60.0, 40.0), (20.0, 16.0)
_SIZE, _PIECES = 30.0, 5
# Of the mesh whose modes are counted (mm), and up to where (Hz).
_COARSE, _CUTOFF = 60.0, 2e4
_MM = 1e-3

cases = CaseGroup(section=SECTION, group="program.parts.wedge", effort=0.5, subject="program")


def pieces() -> tuple[Array, float]:
    """Compliance (6×6, tip, root held) and mass (kg) of the stepped leg, from a mesh in mm."""
    places = {"A": Frame(), "B": Frame(np.array([_LENGTH * _MM, 0.0, 0.0]))}
    with TemporaryDirectory(prefix="wedge-") as folder:
        file = meshed(Path(folder) / "wedge.msh", _drawn, _SIZE, 4.0)
        leg = stepped(
            Body("wedge", Part(file, _STEEL, plane_ends(_LENGTH * _MM), "mm"), places), _PIECES
        )
    matrices = leg_matrices("beam", leg, ModelOptions(elements=_PIECES))
    mass = sum(piece.properties.mu * piece.length for piece in leg.pieces)
    rest = leg.root_mass[0, 0] + leg.tip_mass[0, 0]
    return tip_compliance_of(matrices), float(mass + rest)


def _drawn(kernel: ModuleType) -> None:
    root, tip = (height / 2.0 for height in _HEIGHTS)
    corners = [(0.0, -root), (_LENGTH, -tip), (_LENGTH, tip), (0.0, root)]
    points = [kernel.addPoint(x, -_WIDTH / 2.0, z) for x, z in corners]
    lines = [kernel.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = kernel.addPlaneSurface([kernel.addCurveLoop(lines)])
    solid = [one for one in kernel.extrude([(2, face)], 0.0, _WIDTH, 0.0) if one[0] == 3]
    b, h = _HOLE
    hole = kernel.addBox(-_LENGTH, -b / 2.0, -h / 2.0, 3.0 * _LENGTH, b, h)
    kernel.cut(solid, [(3, hole)])
    kernel.remove([(2, face)], recursive=True)


@cases.case(
    "program.parts.wedge.stepped",
    "A hollow box of falling height, stepped, is a row of prisms as drawn",
    quantity="largest relative difference: stretch, bending, their levers, and mass",
    unit="1",
    reference_kind="closed-form",
    citation="Σ lᵢ Lᵢᵀ diag(1/EAᵢ, 1/EIᵢ) Lᵢ, A = bh − b′h′ and 12 I = bh³ − b′h′³ in the middle "
    "of each piece",
    tolerance=Absolute(1e-6),
    tolerance_reason="plane faces are cut exactly; line and places are rounded in the file",
)
def _stepped(context: Context) -> Measurement:
    found, mass = context.get(pieces)
    expected, weight = np.zeros((6, 6)), 0.0
    (b, h), (root, tip) = _HOLE, _HEIGHTS
    length = _LENGTH / _PIECES
    for x in length * (np.arange(_PIECES) + 0.5):
        height, to_tip = root + (tip - root) * x / _LENGTH, _LENGTH - x
        area = _WIDTH * height - b * h
        about_y = (_WIDTH * height**3 - b * h**3) / 12.0
        about_z = (height * _WIDTH**3 - h * b**3) / 12.0
        expected[0, 0] += length / area / _MM
        expected[4, 4] += length / about_y / _MM**3
        expected[5, 5] += length / about_z / _MM**3
        expected[2, 4] -= length * to_tip / about_y / _MM**2
        expected[1, 5] += length * to_tip / about_z / _MM**2
        weight += _STEEL.rho * area * length * _MM**3
    expected /= _STEEL.E
    entries = np.nonzero(expected)
    off = [*(found[entries] / expected[entries] - 1.0), mass / weight - 1.0]
    return farthest_off(off)


@cases.case(
    "program.parts.wedge.count",
    "Reduced, a hollow box has all modes with held ends below the cut-off, counted",
    quantity=f"number below {_CUTOFF:g} Hz",
    unit="1",
    reference_kind="independent-solver",
    citation="all eigenvalues of the nodes that no end holds, dense (LAPACK)",
    tolerance=Absolute(0.5),
    tolerance_reason="a whole number",
)
def _counted(_: Context) -> Measurement:
    part, mesh = read_again("wedge", _drawn, _COARSE)
    whole = meshed_part(mesh, _STEEL)
    grips = grips_of(mesh, find_interfaces(part, plane_ends(_LENGTH * _MM)), "rigid")
    found = reduction(HeldBody(held_part(whole, grips, "wedge")), _CUTOFF / 2.0, _CUTOFF)
    x = mesh.nodes[:, 0] / (_MM * _LENGTH)
    inside = np.flatnonzero((x > 1e-6) & (x < 1.0 - 1e-6))
    free = (3 * inside[:, None] + np.arange(3)).ravel()
    K, M = (
        matrix[free][:, free].toarray()
        for matrix in (whole.stiffness, on_three_components(whole.scalar_mass))
    )
    squared = eigh(K, M, eigvals_only=True)
    below = int((squared < (2.0 * np.pi * found.cutoff) ** 2).sum())
    return Measurement(float(found.counted or 0), float(below), exact=True)
