"""A leg as hexahedra: its section's mesh extruded, the product of section and line."""

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.sections import Section
from meshes.quality import check
from meshes.section.section_blocks import Divisions
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh


def stations(length: float, count: int) -> Array:
    """Boundaries (count+1, in m) of `count` ≥ 1 slices of one length between x = 0 and `length`."""
    if count < 1:
        raise InputError(f"slices = {count}: must be at least 1")
    return length * np.linspace(0.0, 1.0, count + 1)


def extrude(section: SectionMesh, at: Array) -> SolidMesh:
    """The solid between the ascending stations `at` (S+1, x in m, from 0 at the root), in hex27.

    Node p·N + n is node n of the section (quad9) in plane p; a plane lies in the middle of each
    slice.
    """
    slices = len(at) - 1
    x = np.empty(2 * slices + 1)
    x[::2], x[1::2] = at, (at[:-1] + at[1:]) / 2.0
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
    """The leg of `length` (m) in hex27 of so many slices, `divisions` as in `section_blocks`.

    Raises InputError for impossible requests, ComputationError where gmsh fails or elements are too
    distorted.
    """
    require_leg(section, length, divisions)
    mesh = extrude(section_mesh(section, divisions), stations(length, slices))
    check(mesh, f"extruded leg ({section.shape})")
    return mesh
