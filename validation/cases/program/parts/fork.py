"""A fork of three interfaces: its faces as drawn, its forces counted, its numbers by CalculiX.

Two bores have one radius and are told apart by their places; one of them is broken by the slot into
two faces. Every interface is held in another way.
"""

from dataclasses import dataclass, replace
from types import ModuleType
from typing import get_args

import numpy as np

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.couplings.coupled_solid import coupled_solid
from fem.couplings.grips import Grip, Kind
from fem.elements.elasticity import on_three_components
from lumped.arrays import Array
from lumped.legs import Material
from lumped.mechanism.part import ByCylinder, PartInterface
from meshes.part.interfaces import Interface, find_interfaces
from meshes.part.part_mesh import PartMesh
from validation.agreement.differences import farthest_off, refined, scaled_difference
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.parts.drawing import SECTION, read_again
from validation.context import Context

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Along x, y and z (mm); the slot opens the far end from x = 150 between z = ±5.
_BAR, _SLOT, _GAP = (200.0, 40.0, 30.0), 150.0, 10.0
# Radius and place along x of the bores (mm), which run along z.
_BORES = {"A": (8.0, 20.0), "B": (6.0, 180.0), "C": (6.0, 100.0)}
# Element size (mm) and sides of a circle: what holds on any mesh is looked at on the coarse one.
_SIZE, _RATIO = 20.0, 1.5
COARSE, FINE = 10.0, 10.0 * _RATIO
# From a bore's axis to a point beside it (m).
_ASIDE = np.array([0.01, -0.02, 0.03])
_MM = 1e-3

cases = CaseGroup(
    section=SECTION,
    group="program.parts.fork",
    unit="1",
    reference_kind="closed-form",
    effort=1.0,
    subject="program",
)


@dataclass(frozen=True, eq=False)
class Fork:
    """The fork's mesh, and its interfaces A, B and C."""

    mesh: PartMesh
    interfaces: tuple[Interface, ...]


def fork(sides: float) -> Fork:
    """Drawn, meshed, and read, with so many sides of a circle."""
    part, mesh = read_again("fork", _drawn, _SIZE, sides)
    kinds: tuple[Kind, ...] = ("rigid", "rigid", "average")
    wanted = {
        name: PartInterface(ByCylinder(_MM * r, point=(_MM * x, 0.0, 0.0)), kind)
        for (name, (r, x)), kind in zip(_BORES.items(), kinds, strict=True)
    }
    return Fork(mesh, find_interfaces(part, wanted))


def _drawn(kernel: ModuleType) -> None:
    x, y, z = _BAR
    bar = kernel.addBox(0.0, -y / 2.0, -z / 2.0, x, y, z)
    holes = [(3, kernel.addCylinder(at, 0.0, -z, 0.0, 0.0, 2 * z, r)) for r, at in _BORES.values()]
    slot = kernel.addBox(_SLOT, -y, -_GAP / 2.0, x, 2.0 * y, _GAP)
    kernel.cut([(3, bar)], [*holes, (3, slot)])


def _height(name: str) -> float:
    """Length of a bore's wall (mm): the slot takes its share of one."""
    return _BAR[2] - (_GAP if _BORES[name][1] > _SLOT else 0.0)


@cases.case(
    "program.parts.fork.faces",
    "Interfaces of a fork hold the faces of the drawing, wherever they are broken",
    quantity="largest distance of held nodes and points from the drawn bore and its ends, in radii",
    citation="radii and places of the drawing",
    tolerance=Absolute(1e-6),
    tolerance_reason="places are written with fifteen digits, held nodes lie on the true surface",
)
def _faces(context: Context) -> Measurement:
    found = context.get(fork, FINE)
    off = []
    grips = grips_of(found.mesh, found.interfaces)
    for interface, grip in zip(found.interfaces, grips, strict=True):
        r, x = (_MM * length for length in _BORES[interface.name])
        away = found.mesh.nodes[grip.nodes] - np.array([x, 0.0, 0.0])
        ends = [away[:, 2].min(), away[:, 2].max()]
        off += [
            np.linalg.norm(grip.point[:2] - np.array([x, 0.0])) / r,
            np.abs(np.linalg.norm(away[:, :2], axis=1) / r - 1.0).max(),
            *(np.array(ends) / (_MM * _BAR[2] / 2.0) - [-1.0, 1.0]),
        ]
    return farthest_off(off)


@cases.case(
    "program.parts.fork.means",
    "Averaged bores move as the means of a field over them by hand",
    quantity="largest relative difference: u_z = x² and u_x = z³ about its middle",
    citation="∫x² dA/A = r²/2; turned about y by ∫z⁴ dA/∫(x² + z²) dA",
    tolerance=Absolute(1e-3),
    tolerance_reason="circles of a dozen curved sides",
)
def _means(context: Context) -> Measurement:
    coarse, fine = (_off_means(context.get(fork, sides)) for sides in (COARSE, FINE))
    # Arcs through three points leave the fourth power of their length.
    return refined(coarse, fine, order=4.0, ratio=_RATIO)


def _off_means(found: Fork) -> float:
    part = meshed_part(found.mesh, STEEL)
    grips = grips_of(found.mesh, found.interfaces, "average")
    body = coupled_solid(
        part.stiffness, on_three_components(part.scalar_mass), found.mesh.nodes, grips
    )
    off = []
    for number, (r, x) in enumerate(_MM * np.array(list(_BORES.values()))):
        top, gap = _MM * _BAR[2] / 2.0, _MM * _GAP / 2.0 if x > _MM * _SLOT else 0.0
        away = found.mesh.nodes - np.array([x, 0.0, 0.0])
        fields = np.zeros((len(away), 3, 2))
        fields[:, 2, 0], fields[:, 0, 1] = away[:, 0] ** 2, away[:, 2] ** 3
        means = body.twists[:, 6 * number : 6 * number + 6].T @ fields.reshape(-1, 2)
        second, fourth = ((top**k - gap**k) / k / (top - gap) for k in (3, 5))
        expected = np.zeros((6, 2))
        expected[2, 0] = r**2 / 2.0
        expected[4, 1] = fourth / (second + r**2 / 2.0)
        # The middle of a broken bore is weighed with the areas of facets, 1e-7 m off.
        off.append(np.abs(means - expected) / np.repeat([r**2, top**2], [3, 3])[:, None])
    return float(np.max(off))


@cases.case(
    "program.parts.fork.forces.{kind}",
    "A {kind} interface passes on the wrench that acts on it, and is not torn",
    over={"kind": get_args(Kind)},
    quantity="largest resultant that is not the wrench, force where none acts, of one newton; "
    "displacement of held nodes that is not the interface's",
    citation="equilibrium, counted from the nodes' forces Ku at drawn places",
    tolerance=Absolute(1e-6),
    tolerance_reason="rounding, grown by the part's slenderness",
)
def _forces(context: Context, kind: Kind) -> Measurement:
    found = context.get(fork, COARSE)
    part = meshed_part(found.mesh, STEEL)
    kinds: tuple[Kind, ...] = ("rigid", kind, "average")
    held = [replace(i, coupling=k) for i, k in zip(found.interfaces, kinds, strict=True)]
    held[1] = replace(held[1], point=held[1].point + _ASIDE)
    grips = grips_of(found.mesh, held)
    body = held_part(part, grips, "fork")
    motion = body.solid.transformation @ body.response
    nodal, moved = (
        one.reshape(len(found.mesh.nodes), 3, -1) for one in (part.stiffness @ motion, motion)
    )
    off = []
    inside = np.ones(len(nodal), dtype=bool)
    for number, (grip, interface) in enumerate(zip(grips, held, strict=True)):
        inside[grip.nodes] = False
        away = found.mesh.nodes[grip.nodes] - interface.point
        own = nodal[grip.nodes]
        moments = np.cross(away[:, :, None], own, axisa=1, axisb=1, axisc=1)
        resultant = np.vstack([own.sum(axis=0), moments.sum(axis=0)])
        if number:
            expected = np.eye(6, 12, 6 * (number - 1))
            off.append(np.abs(resultant - expected).max())
        if number == 1:
            off.append(_torn(grip, away, moved[grip.nodes], body.compliance[:6]))
    off.append(np.abs(nodal[inside]).max())
    return farthest_off(off)


@cases.case(
    "program.parts.fork.arm.{kind}",
    "A {kind} interface holds the fork alike from a point beside its bore",
    over={"kind": get_args(Kind)},
    quantity="largest entry of the difference over √(Cii Cjj), all 36",
    citation="a wrench at one point is a wrench and its moment at another: C by the arm",
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding, grown by the part's slenderness",
)
def _arm(context: Context, kind: Kind) -> Measurement:
    found = context.get(fork, COARSE)
    part = meshed_part(found.mesh, STEEL)
    root, bore = found.interfaces[0], replace(found.interfaces[1], coupling=kind)
    beside = replace(bore, point=bore.point + _ASIDE)
    on_it, moved = (
        held_part(part, grips_of(found.mesh, [root, one]), "fork").compliance
        for one in (bore, beside)
    )
    x, y, z = _ASIDE
    across = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    carried = np.block([[np.eye(3), across], [np.zeros((3, 3)), np.eye(3)]])
    return farthest_off(scaled_difference(moved, carried @ on_it @ carried.T))


def _torn(grip: Grip, away: Array, moved: Array, twists: Array) -> float:
    """Largest part by which held nodes do not move (n×3×k) with the twist (6×k) of their point.

    `away` (n×3) from it. Of a pin along the bore's radius alone, of an averaged face not at all.
    """
    turned = np.cross(twists[None, 3:], away[:, :, None], axisa=1, axisb=1, axisc=1)
    off = moved - twists[:3] - turned
    if grip.kind == "pin":
        # Bores run along z; the grip's point is beside the axis, by as much as its nodes' middle.
        ray = away[:, :2] - (away[:, :2].min(axis=0) + away[:, :2].max(axis=0)) / 2.0
        off = np.einsum("ni,nik->nk", ray / np.linalg.norm(ray, axis=1)[:, None], off[:, :2])
    return 0.0 if grip.kind == "average" else float(np.abs(off).max() / np.abs(moved).max())


@cases.case(
    "program.parts.fork.mass",
    "A fork's mass, centre and inertia are those of a bar less its holes",
    quantity="largest relative difference",
    citation="boxes and cylinders of the drawing",
    tolerance=Absolute(1e-3),
    tolerance_reason="circles of a dozen curved sides",
)
def _mass(context: Context) -> Measurement:
    coarse, fine = (_off_drawing(context.get(fork, sides)) for sides in (COARSE, FINE))
    return refined(coarse, fine, order=2.0, ratio=_RATIO)


def _off_drawing(found: Fork) -> float:
    """Largest relative difference of mass, centre and inertia from those of the drawing."""
    properties = meshed_part(found.mesh, STEEL).properties()
    pieces = [
        _box(_BAR, _BAR[0] / 2.0, 1.0),
        _box((_BAR[0] - _SLOT, _BAR[1], _GAP), (_BAR[0] + _SLOT) / 2.0, -1.0),
        *(_bore(name) for name in _BORES),
    ]
    volume = sum(v for v, _, _ in pieces)
    centre = sum(v * x for v, x, _ in pieces) / volume
    inertia = np.zeros(3)
    for v, x, own in pieces:
        inertia += v * own + v * (x - centre) ** 2 * np.array([0.0, 1.0, 1.0])
    expected = STEEL.rho * _MM**5 * inertia
    off = [
        properties.mass / (STEEL.rho * _MM**3 * volume) - 1.0,
        *(properties.centre / _MM - [centre, 0.0, 0.0]) / _BAR[0],
        *((properties.inertia - np.diag(expected)) / expected.max()).ravel(),
    ]
    return float(np.abs(off).max())


def _box(sides: tuple[float, float, float], x: float, sign: float) -> tuple[float, float, Array]:
    """Volume (mm³), place along x, and squared radii of gyration about the axes (3, mm²)."""
    a, b, c = np.square(sides)
    return sign * float(np.prod(sides)), x, np.array([b + c, a + c, a + b]) / 12.0


def _bore(name: str) -> tuple[float, float, Array]:
    """The same of a bore, less what of it lies in the slot."""
    r, x = _BORES[name]
    h, gap = _height(name), _BAR[2] - _height(name)
    # ∫z² dz over the wall's height.
    z = ((_BAR[2] / 2.0) ** 3 - (gap / 2.0) ** 3) * 2.0 / 3.0 / h
    across = r**2 / 4.0 + z
    return -float(np.pi) * r**2 * h, x, np.array([across, across, r**2 / 2.0])
