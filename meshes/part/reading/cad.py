"""CAD files in gmsh's OpenCASCADE kernel: one sound solid in metres, or an error that says why.

STEP files carry their unit; BREP files have none. The kernel turns everything into metres before
it makes the shape: scaled afterwards, cylinders would turn into splines.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import METRES
from lumped.text import counted
from meshes.gmsh_session import gmsh_model
from meshes.part.enclosed import FaceArea, VolumeProperties
from meshes.part.reading.step_text import count_faces, require_whole
from meshes.part.reading.units import chosen_unit, describe, require_plausible, step_unit

STEP, BREP = (".step", ".stp"), (".brep", ".brp")

# Shares of the part's size: an edge below is a leftover of modelling that no mesh can follow, a
# solid thinner than this is none.
_TINY_EDGE, _FLAT = 1e-5, 1e-6
# Share of the volume that gaps may leave open: sound files leave 1e-6, tolerances of modelling of
# 0.01 mm 1e-3 in a part 2 cm thick. What is less than this is said.
_TORN = 0.01
# gmsh's names of surfaces and curves over which the kernel integrates exactly; "Unknown" is the
# edge of a pole.
_SURFACES = frozenset({"Plane", "Cylinder", "Cone", "Sphere", "Torus"})
_CURVES = frozenset({"Line", "Circle", "Ellipse", "Unknown"})
# Points along an edge, ends included.
_POINTS = 9
# What the kernel leaves around a shape on each side of its box (m).
_GAP = 1e-7


@dataclass(frozen=True, eq=False)
class CadModel:
    """The solid `tag` of the current gmsh model; `unit` of its file, `extent` (3, m).

    `gap` (m): how far its faces, edges and corners are apart where they should meet.
    """

    gmsh: ModuleType
    tag: int
    unit: str
    extent: list[float]
    gap: float

    def faces(self) -> list[int]:
        """Numbers of its faces, as gmsh and this program count them."""
        return sorted(
            tag for _, tag in self.gmsh.model.getBoundary([(3, self.tag)], oriented=False)
        )

    def names(self) -> dict[int, str]:
        """Names of its faces, where the file has some."""
        named = ((tag, self.gmsh.model.getEntityName(2, tag)) for tag in self.faces())
        return {tag: name.rsplit("/", 1)[-1] for tag, name in named if name}

    @property
    def unknown_share(self) -> float:
        """Of the volume: what the whole surface moved by the gap adds."""
        occ = self.gmsh.model.occ
        area = sum(float(occ.getMass(2, tag)) for tag in self.faces())
        return self.gap * area / abs(float(occ.getMass(3, self.tag)))

    @property
    def is_elementary(self) -> bool:
        """True if all faces are planes, cylinders, cones, spheres or tori, with edges alike.

        Of these the kernel's integrals are exact. Over rational splines they are not: a cylinder
        written so has a volume 0.9 % too large.
        """
        kinds = self.gmsh.model.getType
        faces = [(2, tag) for tag in self.faces()]
        edges = self.gmsh.model.getBoundary(faces, combined=False, oriented=False)
        return all(kinds(*face) in _SURFACES for face in faces) and all(
            kinds(*edge) in _CURVES for edge in edges
        )

    def area(self, face: int) -> FaceArea:
        """The kernel's area of a face."""
        occ = self.gmsh.model.occ
        return FaceArea(float(occ.getMass(2, face)), np.array(occ.getCenterOfMass(2, face)))

    def properties(self) -> VolumeProperties:
        """The kernel's own integrals over the shape."""
        occ = self.gmsh.model.occ
        inertia = np.array(occ.getMatrixOfInertia(3, self.tag)).reshape(3, 3)
        centre = np.array(occ.getCenterOfMass(3, self.tag))
        return VolumeProperties(float(occ.getMass(3, self.tag)), centre, inertia)


class NotMeshedError(InputError):
    """The kernel takes a shape for a solid, and gmsh cannot mesh it."""


@contextmanager
def cad_model(path: Path, unit: str | None = None) -> Iterator[CadModel]:
    """The one solid of a CAD file.

    `unit` of a BREP file, metres where None. Raises InputError where the file cannot be read, holds
    no solid or several, or one that cannot be meshed (open, torn, flat, with tiny edges).
    """
    chosen = _unit(path, unit)
    with gmsh_model(str(path)) as gmsh:
        occ = gmsh.model.occ
        _import(gmsh, path, chosen)
        occ.synchronize()
        tag = _one_solid(gmsh, path)
        box = _box(gmsh, tag)
        extent = [max(float(side), 0.0) for side in box[1] - box[0]]
        require_plausible(extent, chosen, str(path), said=path.suffix.lower() in STEP)
        gap, place = _largest_gap(gmsh, tag)
        model = CadModel(gmsh, tag, chosen, extent, gap)
        _require_sound(model, path, place)
        _require_cavities_inside(model, path)
        _require_all_points(model, path, box)
        if path.suffix.lower() in STEP:
            _require_all_faces(model, path)
        yield model


def _unit(path: Path, given: str | None) -> str:
    content = path.read_bytes()
    if path.suffix.lower() not in STEP:
        if not content.lstrip().startswith((b"DBRep_DrawableShape", b"CASCADE Topology")):
            raise InputError(f"{path}: is not a BREP file; its first line must name the format")
        return chosen_unit(None, given, str(path))
    require_whole(content, str(path))
    return chosen_unit(step_unit(content, str(path)), given, str(path))


def _import(gmsh: ModuleType, path: Path, unit: str) -> None:
    step = path.suffix.lower() in STEP
    gmsh.option.setString("Geometry.OCCTargetUnit", "M" if step else "")
    gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
    gmsh.option.setNumber("Geometry.OCCScaling", 1.0 if step else METRES[unit])
    try:
        gmsh.model.occ.importShapes(
            str(path), highestDimOnly=False, format="step" if step else "brep"
        )
    except Exception as error:
        raise InputError(f"{path}: OpenCASCADE cannot read it: {error}") from error


def _box(gmsh: ModuleType, solid: int) -> Array:
    """Lower and upper corner (2×3, m) of the box around a solid.

    The kernel's boxes hold all control points of splines, off the surface as they are: around faces
    that are splines it is the box of the kernel's triangles.
    """
    return _around(gmsh, gmsh.model.getBoundary([(3, solid)], oriented=False))


def _around(gmsh: ModuleType, faces: Sequence[tuple[int, int]]) -> Array:
    """The same of some faces."""
    lower, upper = [], []
    edges = gmsh.model.getBoundary(faces, combined=False, oriented=False)
    for dimension, tag in {*faces, *edges}:
        kind = gmsh.model.getType(dimension, tag).lower()
        # Of an edge without a curve, a pole, gmsh leaves the box where it was before scaling.
        if dimension == 1 and kind == "unknown":
            continue
        spline = dimension == 2 and "spline" in kind
        gmsh.option.setNumber("Geometry.OCCBoundsUseStl", int(spline))
        box = np.array(gmsh.model.occ.getBoundingBox(dimension, tag))
        around = 0.0 if spline else _GAP
        lower.append(box[:3] + around)
        upper.append(box[3:] - around)
    gmsh.option.setNumber("Geometry.OCCBoundsUseStl", 0)
    return np.array([np.min(lower, axis=0), np.max(upper, axis=0)])


def _largest_gap(gmsh: ModuleType, solid: int) -> tuple[float, Array]:
    """The largest gap (m) of a solid of the current model, and where it is (3, m).

    Edges in space against the same edges on the surfaces of their faces, corners against the ends
    of their edges. The kernel closes such gaps without a word: it holds a shape for closed whose
    faces, edges and corners name each other, wherever they lie.
    """
    model = gmsh.model
    worst, place = 0.0, np.zeros(3)
    for _, face in model.getBoundary([(3, solid)], oriented=False):
        for _, edge in model.getBoundary([(2, face)], combined=False, oriented=False):
            (low,), (high,) = model.getParametrizationBounds(1, edge)
            along = np.linspace(low, high, _POINTS)
            curve = np.reshape(model.getValue(1, edge, along), (-1, 3))
            on_face = model.reparametrizeOnSurface(1, edge, along, face)
            off = curve - np.reshape(model.getValue(2, face, on_face), (-1, 3))
            gap = float(np.linalg.norm(off, axis=1).max())
            ends = model.getBoundary([(1, edge)], combined=False, oriented=False)
            if ends:
                corners = np.array([model.getValue(0, corner, []) for _, corner in ends])
                apart = np.linalg.norm(corners[:, None] - curve[[0, -1]], axis=2)
                gap = max(gap, float(apart.min(axis=0).max()), float(apart.min(axis=1).max()))
            if not gap <= worst:
                worst, place = gap, curve.mean(axis=0)
    return worst, place


def _require_cavities_inside(model: CadModel, path: Path) -> None:
    """Raise InputError where a cavity sticks out of the solid, by the boxes around its shells.

    Faces that close it alone are sound to the kernel, wherever they lie.
    """
    _, shells = model.gmsh.model.occ.getSurfaceLoops(model.tag)
    if len(shells) == 1:
        return
    boxes = [_around(model.gmsh, [(2, int(face)) for face in shell]) for shell in shells]
    outer = max(boxes, key=lambda box: float(np.prod(box[1] - box[0])))
    for box in boxes:
        if (box[0] < outer[0]).any() or (box[1] > outer[1]).any():
            place = ", ".join(f"{one:.4g}" for one in 0.5 * (box[0] + box[1]))
            raise InputError(f"{path}: the cavity about ({place}) m sticks out of the solid")


def _require_all_points(model: CadModel, path: Path, box: Array) -> None:
    """Raise InputError where a point of the file lies outside the solid."""
    gmsh = model.gmsh.model
    points = np.array([gmsh.getValue(0, tag, []) for _, tag in gmsh.getEntities(0)])
    outside = np.maximum(box[0] - points, points - box[1]).max(axis=1)
    allowed = model.gap + _TINY_EDGE * max(model.extent)
    if (off := float(outside.max())) > allowed:
        x, y, z = points[np.argmax(outside)]
        raise InputError(
            f"{path}: the point ({x:.4g}, {y:.4g}, {z:.4g}) m lies {off:.3g} m outside the solid, "
            f"{allowed:.2g} m is allowed: part of it is lost, or the file holds more than the part"
        )


def _require_all_faces(model: CadModel, path: Path) -> None:
    """Raise InputError where faces are left over, say those of a cavity that does not close."""
    told, taken = count_faces(path.read_bytes()), len(model.faces())
    if taken < told:
        lost = f"{told - taken} of its {counted(told, 'face')}"
        raise InputError(
            f"{path}: {lost} bound no solid: sheet bodies, or a shell that is open or damaged; a "
            "part is one solid and nothing else"
        )


def _one_solid(gmsh: ModuleType, path: Path) -> int:
    solids = gmsh.model.getEntities(3)
    if len(solids) == 1:
        return int(solids[0][1])
    if solids:
        places = "; ".join(
            f"{gmsh.model.occ.getMass(3, tag) * 1e6:.4g} cm³ at {_place(gmsh, 3, tag)}"
            for _, tag in solids[:4]
        )
        raise InputError(
            f"{path}: {len(solids)} solids ({places}); a part is one: fuse them, or make each a "
            "body of its own"
        )
    faces = gmsh.model.getEntities(2)
    if not faces:
        raise InputError(f"{path}: holds no faces; a part is one solid")
    raise InputError(
        f"{path}: {counted(len(faces), 'face')}, but no solid: sheet bodies, or a shell that is "
        f"open{_opening(gmsh)}; close it in the CAD system"
    )


def _opening(gmsh: ModuleType) -> str:
    """Where a shell is open: at an edge that belongs to one face alone; "" if none does."""
    for _, tag in gmsh.model.getEntities(1):
        faces, _ = gmsh.model.getAdjacencies(1, tag)
        if len(faces) == 1:
            return f" at the edge near {_place(gmsh, 1, tag)}"
    return ""


def _place(gmsh: ModuleType, dimension: int, tag: int) -> str:
    x, y, z = gmsh.model.occ.getCenterOfMass(dimension, tag)
    return f"({x:.4g}, {y:.4g}, {z:.4g}) m"


def _require_sound(model: CadModel, path: Path, place: Array) -> None:
    gmsh, size = model.gmsh, max(model.extent)
    volume = gmsh.model.occ.getMass(3, model.tag)
    said = describe(model.extent, model.unit)
    if abs(volume) <= _FLAT * size**3 * _FLAT or min(model.extent) <= _FLAT * size:
        raise InputError(f"{path}: the solid has no volume ({volume:.3g} m³ in {said})")
    if volume < 0.0:
        raise InputError(f"{path}: the solid is inside out (volume {volume:.3g} m³)")
    if (share := model.unknown_share) > _TORN:
        x, y, z = place
        raise InputError(
            f"{path}: its faces, edges and corners are up to {model.gap:.2g} m apart where they "
            f"should meet, near ({x:.4g}, {y:.4g}, {z:.4g}) m, which leaves {share:.2g} of its "
            "volume open; export it anew from the CAD system"
        )
    for _, tag in gmsh.model.getEntities(1):
        length = gmsh.model.occ.getMass(1, tag)
        ends = gmsh.model.getBoundary([(1, tag)], combined=False, oriented=False)
        # A seam or the tip of a cone has one end twice, or none.
        if length < _TINY_EDGE * size and len({end for _, end in ends}) == 2:
            raise InputError(
                f"{path}: edge {tag} at {_place(gmsh, 1, tag)} is {length:.2g} m long, no mesh can "
                "follow it; heal the part in the CAD system"
            )


@contextmanager
def naming_the_place(path: Path, model: CadModel) -> Iterator[None]:
    """Turn gmsh's failure to mesh a shape into an error that names the place at fault.

    Shapes that pass as solids can still cross themselves: gmsh then cannot recover a face.
    """
    try:
        yield
    except (InputError, ComputationError):
        raise
    except Exception as error:
        if type(error) is not Exception:
            raise
        made = model.gmsh.model.mesh.getElements
        faults = [tag for tag in model.faces() if not any(map(len, made(2, tag)[1]))]
        where = f"face {faults[0]} at {_place(model.gmsh, 2, faults[0])}" if faults else str(error)
        raise NotMeshedError(
            f"{path}: no mesh can be made ({error}): the surface crosses itself or does not close "
            f"near {where}; repair it in the CAD system"
        ) from error
