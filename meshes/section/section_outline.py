"""The outline of each section shape as one face of gmsh's OpenCASCADE kernel, and its mesh size."""

from collections.abc import Iterable
from types import ModuleType

from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Section, Tube
from meshes.section.section_blocks import Divisions, thinnest_layer

# Unlike a block, a triangle or a tetrahedron has one size in all directions: in a wall it is kept
# to twice the thickness of a layer, beyond which tetrahedra in the wall turn into slivers.
_WALL_ASPECT = 2.0
# Curved tetrahedra on longer arcs come out folded, and a small bore would overlap itself.
_SIDES_OF_A_CIRCLE = 12


def element_size(section: Section, divisions: Divisions) -> float:
    """Edge length (m) of triangles and tetrahedra that resemble the blocks of `divisions`."""
    if isinstance(divisions, tuple):
        along_y, along_z = divisions
        width, height = section.extent
        return min(width / along_y, height / along_z)
    return min(min(section.extent) / divisions, _WALL_ASPECT * thinnest_layer(section, divisions))


def set_element_size(gmsh: ModuleType, section: Section, divisions: Divisions) -> None:
    """Have gmsh mesh with `element_size`, finer where a full circle would get too few sides."""
    gmsh.option.setNumber("Mesh.MeshSizeMax", element_size(section, divisions))
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", _SIDES_OF_A_CIRCLE)


def add_face(gmsh: ModuleType, section: Section) -> int:
    """Add the section in the plane x = 0, width along y; returns the tag of the surface.

    The caller synchronises the kernel when its geometry is complete.
    """
    match section:
        case Rectangle():
            return _polygon(gmsh, _corners(section))
        case HollowRectangle():
            return _pierced(
                gmsh,
                _polygon(gmsh, _corners(section.outer)),
                _polygon(gmsh, _corners(section.inner)),
            )
        case Circle():
            return _disk(gmsh, section.diameter)
        case Tube():
            return _pierced(
                gmsh, _disk(gmsh, section.diameter), _disk(gmsh, section.inner_diameter)
            )
        case ISection():
            return _polygon(gmsh, _i_corners(section))
    raise TypeError(f"no outline for the section shape {section.shape!r}")


def _corners(section: Rectangle) -> list[tuple[float, float]]:
    y, z = section.width / 2.0, section.height / 2.0
    return [(-y, -z), (y, -z), (y, z), (-y, z)]


def _i_corners(section: ISection) -> list[tuple[float, float]]:
    y, z, web = section.width / 2.0, section.height / 2.0, section.web / 2.0
    root = z - section.flange
    right = [(y, -z), (y, -root), (web, -root), (web, root), (y, root), (y, z)]
    return right + [(-y, z) for y, z in reversed(right)]


def _polygon(gmsh: ModuleType, corners: Iterable[tuple[float, float]]) -> int:
    occ = gmsh.model.occ
    points = [occ.addPoint(0.0, y, z) for y, z in corners]
    ends = [*points[1:], points[0]]
    sides = [occ.addLine(start, end) for start, end in zip(points, ends, strict=True)]
    return int(occ.addPlaneSurface([occ.addCurveLoop(sides)]))


def _disk(gmsh: ModuleType, diameter: float) -> int:
    radius = diameter / 2.0
    return int(
        gmsh.model.occ.addDisk(
            0.0, 0.0, 0.0, radius, radius, zAxis=[1.0, 0.0, 0.0], xAxis=[0.0, 1.0, 0.0]
        )
    )


def _pierced(gmsh: ModuleType, outer: int, hole: int) -> int:
    ((_, surface),), _ = gmsh.model.occ.cut([(2, outer)], [(2, hole)])
    return int(surface)
