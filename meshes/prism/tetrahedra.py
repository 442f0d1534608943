"""A leg as unstructured tetrahedra, by gmsh from the outline of its section: the second family."""

from types import ModuleType
from typing import Literal

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.sections import Section
from meshes.elements import ELEMENTS, SectionElement, SolidElement
from meshes.gmsh_session import connectivity, gmsh_model, numbered
from meshes.quality import check
from meshes.section.section_blocks import Divisions
from meshes.section.section_mesh import SectionMesh, counter_clockwise, require_leg
from meshes.section.section_outline import add_face, set_element_size
from meshes.solid_mesh import EndFace, SolidMesh

_ELEMENT: dict[int, tuple[SolidElement, SectionElement]] = {
    1: ("tet4", "tri3"),
    2: ("tet10", "tri6"),
}


def tetrahedra(
    section: Section, length: float, divisions: Divisions, order: Literal[1, 2] = 2
) -> SolidMesh:
    """The leg of `length` (m) in tet4 or tet10 of the size that `element_size` gives `divisions`.

    Second-order nodes on curved sides lie on the true surface. Raises InputError for impossible
    requests, ComputationError where gmsh fails or elements are too distorted.
    """
    require_leg(section, length, divisions)
    solid, triangle = _ELEMENT[order]
    part = f"tetrahedral leg ({section.shape})"
    with gmsh_model(part) as gmsh:
        root_face, tip_face = _add_leg(gmsh, section, length)
        set_element_size(gmsh, section, divisions)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(ELEMENTS[solid].order)
        tagged = connectivity(gmsh, solid)
        tags, nodes = numbered(gmsh, tagged)
        root, tip = (
            np.searchsorted(tags, connectivity(gmsh, triangle, face))
            for face in (root_face, tip_face)
        )
    # The kernel's planes are exact to rounding only; a face is asked for by equality.
    nodes[root, 0], nodes[tip, 0] = 0.0, length
    mesh = SolidMesh(
        nodes=nodes,
        cells=np.searchsorted(tags, tagged),
        element=solid,
        root=_end_face(nodes, root, triangle),
        tip=_end_face(nodes, tip, triangle),
        slices=None,
    )
    check(mesh, part)
    return mesh


def _add_leg(gmsh: ModuleType, section: Section, length: float) -> tuple[int, int]:
    """The extruded outline; returns the surfaces at x = 0 and x = length."""
    root = add_face(gmsh, section)
    extruded = gmsh.model.occ.extrude([(2, root)], length, 0.0, 0.0)
    gmsh.model.occ.synchronize()
    return root, int(extruded[0][1])


def _end_face(nodes: Array, triangles: IntArray, element: SectionElement) -> EndFace:
    face, local = np.unique(triangles, return_inverse=True)
    flat = nodes[face, 1:]
    cells = counter_clockwise(flat, local.reshape(triangles.shape), element)
    return EndFace(face, SectionMesh(flat, cells, element))
