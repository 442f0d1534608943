"""Solid meshes of prismatic legs, with their end faces.

Hexahedra are obtained by extruding the mesh of the section along the leg. For rectangular sections
there are also unstructured tetrahedra, meshed by gmsh.
"""

from types import ModuleType

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import InputError
from lumped.sections import Rectangle, Section
from meshes.gmsh_session import connectivity, gmsh_model, numbered
from meshes.quality import check
from meshes.section.section_blocks import Divisions
from meshes.section.section_mesh import SectionMesh, counter_clockwise, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh


def stations(length: float, count: int) -> Array:
    """Positions x (count+1 values, in m) of the ends of `count` ≥ 1 equal slices of a leg.

    They run from 0 to `length` (m).
    """
    if count < 1:
        raise InputError(f"slices = {count}: must be at least 1")
    return length * np.linspace(0.0, 1.0, count + 1)


def extrude(section: SectionMesh, boundaries: Array) -> SolidMesh:
    """Mesh of 27-node hexahedra from a section mesh, with slices between given `boundaries`.

    `boundaries` (S+1 values of x, in m) are ascending, from 0 at the root. There is a plane of
    nodes at each boundary and in the middle of each slice. Node p·N + n of the solid is node n of
    the section (quad9, N nodes) in plane p.
    """
    slices = len(boundaries) - 1
    x = np.empty(2 * slices + 1)
    x[::2], x[1::2] = boundaries, (boundaries[:-1] + boundaries[1:]) / 2.0
    per_plane = len(section.nodes)
    nodes = np.column_stack([np.repeat(x, per_plane), np.tile(section.nodes, (len(x), 1))])
    one_slice = np.hstack([section.cells + plane * per_plane for plane in range(3)])
    offsets = 2 * per_plane * np.arange(slices)
    cells = (one_slice[None, :, :] + offsets[:, None, None]).reshape(-1, one_slice.shape[1])
    face = np.arange(per_plane)
    return SolidMesh(
        nodes=nodes,
        cells=cells,
        element="hex27",
        root=EndFace(face, section),
        tip=EndFace(face + (len(x) - 1) * per_plane, section),
        slices=slices,
    )


def hexahedra(section: Section, length: float, divisions: Divisions, slices: int) -> SolidMesh:
    """Mesh of a leg of `length` (m) with 27-node hexahedra in the given number of `slices`.

    `divisions` are explained in `section_blocks`. Raises InputError if an argument is not valid,
    ComputationError if gmsh fails or elements are too distorted.
    """
    require_leg(section, length, divisions)
    mesh = extrude(section_mesh(section, divisions), stations(length, slices))
    check(mesh, f"extruded leg ({section.shape})")
    return mesh


def tetrahedra(section: Section, length: float, divisions: int) -> SolidMesh:
    """Mesh of a leg of `length` (m) with 10-node tetrahedra, `divisions` across the smaller side.

    Raises InputError if an argument is not valid or the section is not a solid rectangle,
    ComputationError if gmsh fails or elements are too distorted.
    """
    if not isinstance(section, Rectangle):
        raise InputError(f"{section.shape}: only solid rectangles are meshed with tetrahedra")
    require_leg(section, length, divisions)
    part = f"tetrahedral leg ({section.shape})"
    with gmsh_model(part) as gmsh:
        root_face, tip_face = _add_leg(gmsh, section, length)
        gmsh.option.setNumber("Mesh.MeshSizeMax", min(section.extent) / divisions)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        tagged = connectivity(gmsh, "tet10")
        tags, nodes = numbered(gmsh, tagged)
        root, tip = (
            np.searchsorted(tags, connectivity(gmsh, "tri6", face))
            for face in (root_face, tip_face)
        )
    # Positions from the kernel have round-off errors, but nodes of the end faces are compared
    # exactly.
    nodes[root, 0], nodes[tip, 0] = 0.0, length
    mesh = SolidMesh(
        nodes=nodes,
        cells=np.searchsorted(tags, tagged),
        element="tet10",
        root=_end_face(nodes, root),
        tip=_end_face(nodes, tip),
        slices=None,
    )
    check(mesh, part)
    return mesh


def _add_leg(gmsh: ModuleType, section: Rectangle, length: float) -> tuple[int, int]:
    """Add a box to the model. Return the tags of its faces at x = 0 and at x = `length`."""
    occ = gmsh.model.occ
    y, z = section.width / 2.0, section.height / 2.0
    points = [occ.addPoint(0.0, *corner) for corner in ((-y, -z), (y, -z), (y, z), (-y, z))]
    ends = [*points[1:], points[0]]
    sides = [occ.addLine(start, end) for start, end in zip(points, ends, strict=True)]
    root = int(occ.addPlaneSurface([occ.addCurveLoop(sides)]))
    extruded = occ.extrude([(2, root)], length, 0.0, 0.0)
    occ.synchronize()
    return root, int(extruded[0][1])


def _end_face(nodes: Array, triangles: IntArray) -> EndFace:
    face, local = np.unique(triangles, return_inverse=True)
    flat = nodes[face, 1:]
    cells = counter_clockwise(flat, local.reshape(triangles.shape), "tri6")
    return EndFace(face, SectionMesh(flat, cells, "tri6"))
