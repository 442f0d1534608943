"""A leg as hexahedra: its section's mesh extruded, the product of section and line."""

from math import ceil

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.sections import Section
from meshes.elements import ELEMENTS, SectionElement, SolidElement
from meshes.quality import LARGEST_ASPECT, check
from meshes.section.section_blocks import Divisions, thinnest_layer
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh

_SOLID: dict[SectionElement, SolidElement] = {"quad4": "hex8", "quad9": "hex27"}


def stations(length: float, count: int) -> Array:
    """Boundaries (count+1, in m) of `count` ≥ 1 slices of one length between x = 0 and `length`."""
    if count < 1:
        raise InputError(f"slices = {count}: must be at least 1")
    return length * np.linspace(0.0, 1.0, count + 1)


def extrude(section: SectionMesh, at: Array) -> SolidMesh:
    """The solid between the ascending stations `at` (S+1, x in m, from 0 at the root).

    quad4 becomes hex8, quad9 hex27. Node p·N + n is node n of the section in plane p; second-order
    meshes have a plane in the middle of each slice. Raises InputError for triangles.
    """
    if section.element not in _SOLID:
        raise InputError(f"element = {section.element}: only quad4 and quad9 can be extruded")
    if np.any(np.diff(at) <= 0.0) or at[0] != 0.0:
        raise InputError("stations must ascend from 0 m at the root")
    element = _SOLID[section.element]
    order = ELEMENTS[element].order
    slices = len(at) - 1
    x = np.empty(order * slices + 1)
    x[::order] = at
    if order == 2:
        x[1::2] = (at[:-1] + at[1:]) / 2.0
    per_plane = len(section.nodes)
    nodes = np.column_stack([np.repeat(x, per_plane), np.tile(section.nodes, (len(x), 1))])
    one_slice = np.hstack([section.cells + plane * per_plane for plane in range(order + 1)])
    offsets = order * per_plane * np.arange(slices)
    cells = (one_slice[None, :, :] + offsets[:, None, None]).reshape(-1, one_slice.shape[1])
    face = np.arange(per_plane)
    return SolidMesh(
        nodes=nodes,
        cells=cells,
        element=element,
        root=EndFace(face, section),
        tip=EndFace(face + (len(x) - 1) * per_plane, section),
        slices=slices,
    )


def slice_count(section: Section, length: float, divisions: Divisions) -> int:
    """Slices as long as smaller side / divisions, so that all sizes refine together.

    In thin walls they are shorter where they would come near the aspect ratio that is refused.
    """
    across = divisions if isinstance(divisions, int) else min(divisions)
    of_four = ceil(4.0 * length / min(section.extent) - 1e-9)
    bounded = ceil(length / (LARGEST_ASPECT / 2.0 * thinnest_layer(section, across)) - 1e-9)
    return max(ceil(across * of_four / 4), bounded)


def hexahedra(
    section: Section,
    length: float,
    divisions: Divisions,
    element: SolidElement = "hex27",
    *,
    slices: int | None = None,
) -> SolidMesh:
    """The leg of `length` (m) in hex8 or hex27, `divisions` as in `section_blocks`.

    `slices` defaults to `slice_count`. Raises InputError for impossible requests,
    ComputationError where gmsh fails or elements are too distorted.
    """
    require_leg(section, length, divisions)
    count = slice_count(section, length, divisions) if slices is None else slices
    flat = section_mesh(section, divisions, "quad4" if element == "hex8" else "quad9")
    mesh = extrude(flat, stations(length, count))
    check(mesh, f"extruded leg ({section.shape})")
    return mesh
