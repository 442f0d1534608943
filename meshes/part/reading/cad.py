"""CAD files, read with gmsh's OpenCASCADE kernel: one valid solid in metres, or an error.

STEP files contain their unit; BREP files have none. The kernel converts to metres before it creates
the shape, because scaling the shape would convert cylinders to splines.
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

# Length of the shortest edge, relative to the part's size, that can be meshed. Shorter edges are
# remnants of modelling. Smallest thickness of a solid, relative to the part's size.
_TINY_EDGE, _FLAT = 1e-5, 1e-6
# Largest relative uncertainty of the volume due to gaps. Exact files have 1e-6. Modelling
# tolerances of 0.01 mm cause 1e-3 in a part 2 cm thick. Smaller uncertainties are reported.
_TORN = 0.01
# Names in gmsh of the surfaces and curves over which the kernel integrates exactly. "Unknown" is
# the degenerate edge at the pole of a sphere or the tip of a cone.
_SURFACES = frozenset({"Plane", "Cylinder", "Cone", "Sphere", "Torus"})
_CURVES = frozenset({"Line", "Circle", "Ellipse", "Unknown"})
# Number of points along an edge, ends included, at which gaps are measured.
_POINTS = 9
# Margin (m) that the kernel adds on each side of the bounding box of a shape.
_GAP = 1e-7


@dataclass(frozen=True, eq=False)
class CadModel:
    """The solid with the number `tag` in the current gmsh model.

    `gmsh` is the module with this model. `unit` is the length unit of the file, `extent` (3, in m)
    the size of the solid along x, y and z. `gap` (m) is the largest distance between faces, edges
    and corners of the solid that should coincide.
    """

    gmsh: ModuleType
    tag: int
    unit: str
    extent: list[float]
    gap: float

    def faces(self) -> list[int]:
        """Numbers of the faces of the solid. They are gmsh's tags."""
        return sorted(
            tag for _, tag in self.gmsh.model.getBoundary([(3, self.tag)], oriented=False)
        )

    def names(self) -> dict[int, str]:
        """Names of faces by face number, if the file contains names."""
        entity_names = ((tag, self.gmsh.model.getEntityName(2, tag)) for tag in self.faces())
        return {tag: name.rsplit("/", 1)[-1] for tag, name in entity_names if name}

    @property
    def unknown_share(self) -> float:
        """Relative uncertainty of the volume due to gaps: surface area · largest gap / volume."""
        occ = self.gmsh.model.occ
        area = sum(float(occ.getMass(2, tag)) for tag in self.faces())
        return self.gap * area / abs(float(occ.getMass(3, self.tag)))

    @property
    def is_elementary(self) -> bool:
        """True if all faces are planes, cylinders, cones, spheres or tori with elementary edges.

        Integrals of the kernel over such faces are exact. Over rational splines they are not: the
        volume of a cylinder written as a spline is 0.9 % too large.
        """
        kinds = self.gmsh.model.getType
        faces = [(2, tag) for tag in self.faces()]
        edges = self.gmsh.model.getBoundary(faces, combined=False, oriented=False)
        return all(kinds(*face) in _SURFACES for face in faces) and all(
            kinds(*edge) in _CURVES for edge in edges
        )

    def area(self, face: int) -> FaceArea:
        """Area and centre of a face, integrated by the kernel."""
        occ = self.gmsh.model.occ
        return FaceArea(float(occ.getMass(2, face)), np.array(occ.getCenterOfMass(2, face)))

    def properties(self) -> VolumeProperties:
        """Volume properties of the solid, integrated by the kernel."""
        occ = self.gmsh.model.occ
        inertia = np.array(occ.getMatrixOfInertia(3, self.tag)).reshape(3, 3)
        centre = np.array(occ.getCenterOfMass(3, self.tag))
        return VolumeProperties(float(occ.getMass(3, self.tag)), centre, inertia)


class NotMeshedError(InputError):
    """Error: the kernel reads a shape as a solid, but gmsh cannot mesh it."""


@contextmanager
def cad_model(path: Path, unit: str | None = None) -> Iterator[CadModel]:
    """Context with the model of a CAD file that contains a single solid.

    `unit` is the length unit of a BREP file, which does not contain it. None stands for metres. For
    a STEP file, `unit` must be None or the unit in the file. Raises InputError if the file cannot
    be read, contains no solid or several, or contains a solid that cannot be meshed (open, torn,
    flat, or with tiny edges).
    """
    length_unit = _unit(path, unit)
    with gmsh_model(str(path)) as gmsh:
        occ = gmsh.model.occ
        _import(gmsh, path, length_unit)
        occ.synchronize()
        tag = _one_solid(gmsh, path)
        box = _box(gmsh, tag)
        extent = [max(float(side), 0.0) for side in box[1] - box[0]]
        require_plausible(extent, length_unit, str(path), unit_in_file=path.suffix.lower() in STEP)
        gap, gap_position = _largest_gap(gmsh, tag)
        model = CadModel(gmsh, tag, length_unit, extent, gap)
        _require_sound(model, path, gap_position)
        _require_cavities_inside(model, path)
        _require_all_points(model, path, box)
        if path.suffix.lower() in STEP:
            _require_all_faces(model, path)
        yield model


def _unit(path: Path, specified: str | None) -> str:
    content = path.read_bytes()
    if path.suffix.lower() not in STEP:
        if not content.lstrip().startswith((b"DBRep_DrawableShape", b"CASCADE Topology")):
            raise InputError(f"{path}: is not a BREP file; its first line must name the format")
        return chosen_unit(None, specified, str(path))
    require_whole(content, str(path))
    return chosen_unit(step_unit(content, str(path)), specified, str(path))


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
        raise InputError(f"{path}: OpenCASCADE cannot read the file: {error}") from error


def _box(gmsh: ModuleType, solid: int) -> Array:
    """Lower and upper corner (2×3, in m) of the bounding box of a solid.

    The kernel's boxes include all control points of splines, which do not lie on the surface. For
    spline faces the box of the kernel's triangulation is used instead.
    """
    return _box_of_faces(gmsh, gmsh.model.getBoundary([(3, solid)], oriented=False))


def _box_of_faces(gmsh: ModuleType, faces: Sequence[tuple[int, int]]) -> Array:
    """Lower and upper corner (2×3, in m) of the bounding box of `faces`.

    Each face is a pair of its dimension in gmsh (2) and its tag.
    """
    lower, upper = [], []
    edges = gmsh.model.getBoundary(faces, combined=False, oriented=False)
    for dimension, tag in {*faces, *edges}:
        kind = gmsh.model.getType(dimension, tag).lower()
        # gmsh does not scale the box of a degenerate edge at a pole.
        if dimension == 1 and kind == "unknown":
            continue
        spline = dimension == 2 and "spline" in kind
        gmsh.option.setNumber("Geometry.OCCBoundsUseStl", int(spline))
        box = np.array(gmsh.model.occ.getBoundingBox(dimension, tag))
        margin = 0.0 if spline else _GAP
        lower.append(box[:3] + margin)
        upper.append(box[3:] - margin)
    gmsh.option.setNumber("Geometry.OCCBoundsUseStl", 0)
    return np.array([np.min(lower, axis=0), np.max(upper, axis=0)])


def _largest_gap(gmsh: ModuleType, solid: int) -> tuple[float, Array]:
    """Largest gap (m) of a solid of the current model, and its position (3, in m).

    Two distances are measured: between an edge as a curve in space and the same edge as a curve on
    each of its faces, and between a corner and the ends of its edges. The kernel ignores these
    gaps: it considers a shape closed if its faces, edges and corners refer to each other,
    regardless of their positions.
    """
    model = gmsh.model
    worst, position = 0.0, np.zeros(3)
    for _, face in model.getBoundary([(3, solid)], oriented=False):
        for _, edge in model.getBoundary([(2, face)], combined=False, oriented=False):
            (low,), (high,) = model.getParametrizationBounds(1, edge)
            parameters = np.linspace(low, high, _POINTS)
            curve = np.reshape(model.getValue(1, edge, parameters), (-1, 3))
            on_face = model.reparametrizeOnSurface(1, edge, parameters, face)
            deviation = curve - np.reshape(model.getValue(2, face, on_face), (-1, 3))
            gap = float(np.linalg.norm(deviation, axis=1).max())
            ends = model.getBoundary([(1, edge)], combined=False, oriented=False)
            if ends:
                corners = np.array([model.getValue(0, corner, []) for _, corner in ends])
                distances = np.linalg.norm(corners[:, None] - curve[[0, -1]], axis=2)
                gap = max(
                    gap, float(distances.min(axis=0).max()), float(distances.min(axis=1).max())
                )
            if not gap <= worst:
                worst, position = gap, curve.mean(axis=0)
    return worst, position


def _require_cavities_inside(model: CadModel, path: Path) -> None:
    """Raise InputError if a cavity is not within the solid.

    The bounding boxes of the shells (closed sets of faces) are compared. The kernel accepts any
    closed shell as a cavity, regardless of its position.
    """
    _, shells = model.gmsh.model.occ.getSurfaceLoops(model.tag)
    if len(shells) == 1:
        return
    boxes = [_box_of_faces(model.gmsh, [(2, int(face)) for face in shell]) for shell in shells]
    outer = max(boxes, key=lambda box: float(np.prod(box[1] - box[0])))
    for box in boxes:
        if (box[0] < outer[0]).any() or (box[1] > outer[1]).any():
            centre_text = ", ".join(f"{coordinate:.4g}" for coordinate in 0.5 * (box[0] + box[1]))
            raise InputError(f"{path}: the cavity about ({centre_text}) m sticks out of the solid")


def _require_all_points(model: CadModel, path: Path, box: Array) -> None:
    """Raise InputError if a point of the file lies outside the bounding `box` of the solid.

    `box` (2×3, in m) contains its lower and its upper corner.
    """
    gmsh = model.gmsh.model
    points = np.array([gmsh.getValue(0, tag, []) for _, tag in gmsh.getEntities(0)])
    outside = np.maximum(box[0] - points, points - box[1]).max(axis=1)
    allowed = model.gap + _TINY_EDGE * max(model.extent)
    if (distance := float(outside.max())) > allowed:
        x, y, z = points[np.argmax(outside)]
        raise InputError(
            f"{path}: the point ({x:.4g}, {y:.4g}, {z:.4g}) m lies {distance:.3g} m outside the "
            f"solid, {allowed:.2g} m is allowed: part of the solid is missing, or "
            "the file contains more than the part"
        )


def _require_all_faces(model: CadModel, path: Path) -> None:
    """Raise InputError if the file contains faces that do not bound the solid.

    Such faces belong to an open shell or cavity, or to a sheet body.
    """
    listed, bounding = count_faces(path.read_bytes()), len(model.faces())
    if bounding < listed:
        lost = f"{listed - bounding} of its {counted(listed, 'face')}"
        raise InputError(
            f"{path}: {lost} do not belong to the solid (sheet bodies, or a shell that is open or "
            "damaged); a part must be one solid and nothing else"
        )


def _one_solid(gmsh: ModuleType, path: Path) -> int:
    solids = gmsh.model.getEntities(3)
    if len(solids) == 1:
        return int(solids[0][1])
    if solids:
        places = "; ".join(
            f"{gmsh.model.occ.getMass(3, tag) * 1e6:.4g} cm³ at {_centre_text(gmsh, 3, tag)}"
            for _, tag in solids[:4]
        )
        raise InputError(
            f"{path}: {len(solids)} solids ({places}); a part must be a single solid: unite "
            "them in the CAD system, or export each solid as a body with its own file"
        )
    faces = gmsh.model.getEntities(2)
    if not faces:
        raise InputError(f"{path}: contains no faces; a part must be a single solid")
    raise InputError(
        f"{path}: {counted(len(faces), 'face')}, but no solid: sheet bodies, or a shell that is "
        f"open{_opening(gmsh)}; close it in the CAD system"
    )


def _opening(gmsh: ModuleType) -> str:
    """Text with the position of an edge that belongs to one face only, so that the shell is open.

    "" if there is no such edge.
    """
    for _, tag in gmsh.model.getEntities(1):
        faces, _ = gmsh.model.getAdjacencies(1, tag)
        if len(faces) == 1:
            return f" at the edge near {_centre_text(gmsh, 1, tag)}"
    return ""


def _centre_text(gmsh: ModuleType, dimension: int, tag: int) -> str:
    x, y, z = gmsh.model.occ.getCenterOfMass(dimension, tag)
    return f"({x:.4g}, {y:.4g}, {z:.4g}) m"


def _require_sound(model: CadModel, path: Path, position: Array) -> None:
    gmsh, size = model.gmsh, max(model.extent)
    volume = gmsh.model.occ.getMass(3, model.tag)
    size_text = describe(model.extent, model.unit)
    if abs(volume) <= _FLAT * size**3 * _FLAT or min(model.extent) <= _FLAT * size:
        raise InputError(f"{path}: the solid has no volume ({volume:.3g} m³ in {size_text})")
    if volume < 0.0:
        raise InputError(
            f"{path}: the faces of the solid point inwards (volume {volume:.3g} m³); "
            "export the part again from the CAD system"
        )
    if (share := model.unknown_share) > _TORN:
        x, y, z = position
        raise InputError(
            f"{path}: the faces, edges and corners of the solid are up to {model.gap:.2g} m apart "
            f"where they should meet, near ({x:.4g}, {y:.4g}, {z:.4g}) m, which leaves "
            f"{share:.2g} of the volume open; export the part again from the CAD system"
        )
    for _, tag in gmsh.model.getEntities(1):
        length = gmsh.model.occ.getMass(1, tag)
        ends = gmsh.model.getBoundary([(1, tag)], combined=False, oriented=False)
        # A seam, and the degenerate edge at the tip of a cone, have two equal ends or none.
        if length < _TINY_EDGE * size and len({end for _, end in ends}) == 2:
            raise InputError(
                f"{path}: edge {tag} at {_centre_text(gmsh, 1, tag)} is {length:.2g} m long, no "
                "mesh can follow it; heal the part in the CAD system"
            )


@contextmanager
def locating_mesh_failures(path: Path, model: CadModel) -> Iterator[None]:
    """Context that converts an error of gmsh during meshing to NotMeshedError with its position.

    A solid that intersects itself cannot be meshed, because gmsh fails to recover one of its faces.
    The position is that of a face without elements.
    """
    try:
        yield
    except (InputError, ComputationError):
        raise
    except Exception as error:
        if type(error) is not Exception:
            raise
        elements_of = model.gmsh.model.mesh.getElements
        faults = [tag for tag in model.faces() if not any(map(len, elements_of(2, tag)[1]))]
        location = (
            f"face {faults[0]} at {_centre_text(model.gmsh, 2, faults[0])}"
            if faults
            else str(error)
        )
        raise NotMeshedError(
            f"{path}: no mesh can be made ({error}): the surface crosses itself or does not close "
            f"near {location}; repair it in the CAD system"
        ) from error
