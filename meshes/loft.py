"""Solid meshes of tapered and curved legs: a section's mesh, moved along the line and stretched.

Each plane of nodes is the mesh of the section in the middle of the line, stretched to the size and
to the wall thickness of the section at the position of the plane. The numbering of the nodes is the
same in all planes. Hexahedra have straight sides within a linear taper, and quadratic sides along
an arc. A leg whose line has corners, or whose section changes in steps, cannot be meshed this way.
"""

from dataclasses import dataclass
from math import ceil

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.centre_line import CentreLine
from lumped.errors import InputError
from lumped.legs import LineLeg
from lumped.line_sections import TOGETHER
from lumped.sections import (
    Circle,
    HollowRectangle,
    ISection,
    OutlinedSection,
    Rectangle,
    Section,
    Tube,
)
from meshes.quality import check
from meshes.section.section_blocks import Divisions, element_length, has_blocks
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh

# Distance, as a fraction of the section's size, below which coordinates of corners count as one.
_SAME_LINE = 1e-9


@dataclass(frozen=True, eq=False)
class LoftedMesh(SolidMesh):
    """Mesh of 27-node hexahedra along the centre line `line`. The end faces are normal to the line.

    Nodes are numbered plane by plane, as in an extruded mesh. `positions` (p values, in m along the
    line) are the positions of the p planes of nodes. `sections` (p×n×2, in m) are the coordinates y
    and z of the n nodes of each plane, in the axes of the line at this plane.
    """

    line: CentreLine
    positions: Array
    sections: Array

    @property
    def length(self) -> float:
        """Straight distance (m) from root to tip of the leg."""
        return self.line.chord


def why_no_loft(leg: LineLeg) -> str:
    """Reason why a leg has no solid mesh. "" if it has one."""
    name = leg.name or "a leg"
    sections = [section for _, section in leg.stations]
    if not all(section.has_outline for section in sections):
        return f"{name}: a section given by its constants has no shape that could be meshed"
    if leg.line.corners:
        positions = ", ".join(f"{position:.4g} m" for position in leg.line.corners)
        return (
            f"{name}: the centre line has corners (at {positions} along it); only rounded corners "
            "can be meshed: give arcs, or use a CAD part"
        )
    steps = [
        first[0]
        for first, second in zip(leg.stations[:-1], leg.stations[1:], strict=True)
        if second[0] - first[0] <= TOGETHER * leg.line.length and first[1] != second[1]
    ]
    if steps:
        return (
            f"{name}: the section jumps at {', '.join(f'{step:.4g} m' for step in steps)}; only a "
            "continuous section can be meshed: give a short taper, or use a CAD part"
        )
    free = [
        section
        for section in sections
        if isinstance(section, OutlinedSection) and not has_blocks(section)
    ]
    if free and any(section != sections[0] for section in sections):
        return f"{name}: a tapered {free[0].shape} has no mesh; only a constant one has"
    material = leg.material
    isotropic = abs(material.G - material.E / (2.0 * (1.0 + material.nu))) <= 1e-9 * material.G
    if not (isotropic or leg.line.is_straight):
        return f"{name}: an independent G belongs to the axes of a straight leg; leave it out"
    return ""


def mesh_section(leg: LineLeg) -> Section:
    """Section in the middle of the line. Its mesh is stretched to those of all other sections."""
    return leg.section_at(0.5 * leg.line.length)


def slices_along(leg: LineLeg, divisions: Divisions) -> int:
    """Number of slices that are about as long as the elements of the section are wide.

    `divisions` is the number of elements across the smaller side of the section.
    """
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    return max(2, ceil(leg.line.length / element_length(mesh_section(leg), count)))


def loft(leg: LineLeg, divisions: Divisions, slices: int) -> LoftedMesh:
    """Mesh of a leg with about `slices` slices, and `divisions` as for `section_blocks`.

    Raises InputError if `why_no_loft` returns a reason, ComputationError if elements are too
    distorted.
    """
    if reason := why_no_loft(leg):
        raise InputError(reason)
    reference = mesh_section(leg)
    require_leg(reference, leg.line.length, divisions)
    face = section_mesh(reference, divisions)
    positions, pieces, sections = _planes(leg, face, reference, slices)
    points, axes = leg.line.frames(positions, pieces)
    nodes = points[:, None] + np.einsum("pij,pnj->pni", axes[:, :, 1:], sections)
    per_plane, planes = len(face.nodes), len(positions)
    one_slice = np.hstack([face.cells + plane * per_plane for plane in range(3)])
    offsets = 2 * per_plane * np.arange((planes - 1) // 2)
    cells = (one_slice[None] + offsets[:, None, None]).reshape(-1, one_slice.shape[1])
    first = np.arange(per_plane)
    last = first + (planes - 1) * per_plane
    nodes[-1] += np.array([leg.line.chord, 0.0, 0.0]) - points[-1]
    mesh = LoftedMesh(
        nodes=nodes.reshape(-1, 3),
        cells=cells,
        element="hex27",
        root=EndFace(first, SectionMesh(sections[0], face.cells, face.element), axes[0]),
        tip=EndFace(last, SectionMesh(sections[-1], face.cells, face.element), axes[-1]),
        slices=(planes - 1) // 2,
        line=leg.line,
        positions=positions,
        sections=sections,
    )
    check(mesh, f"leg along a line ({reference.shape})")
    return mesh


def _planes(
    leg: LineLeg, face: SectionMesh, reference: Section, slices: int
) -> tuple[Array, IntArray, Array]:
    """Positions (p, in m) of the planes of nodes, their pieces (p), and their nodes (p×n×2, in m).

    The second array contains the index of the piece of the centre line to which each plane belongs.
    `face` is the mesh of the section `reference`, from which the n nodes of each plane are
    stretched.
    """
    positions, shapes = [], []
    for number, span in enumerate(leg.spans):
        count = max(1, ceil(slices * (span.end - span.start) / leg.line.length - TOGETHER))
        shares = np.linspace(0.0, 1.0, 2 * count + 1)[0 if number == 0 else 1 :]
        positions.append(span.start + (span.end - span.start) * shares)
        shapes += [stretched(face.nodes, reference, span.section(share)) for share in shares]
    planes = np.concatenate(positions)
    # A plane between two pieces belongs to the one before it, which meets the next one smoothly.
    pieces = np.searchsorted(leg.line.ends, planes, side="left") - 1
    return planes, np.clip(pieces, 0, len(leg.line.pieces) - 1), np.array(shapes)


def stretched(nodes: Array, reference: Section, section: Section) -> Array:
    """Nodes (n×2) of a mesh of the section `reference`, moved to a `section` of the same shape."""
    if section == reference:
        return nodes
    if isinstance(reference, Circle | Tube) and isinstance(section, Circle | Tube):
        radii = np.linalg.norm(nodes, axis=1)
        rims, new_rims = (
            [tube.inner_diameter / 2.0, tube.diameter / 2.0] for tube in (reference, section)
        )
        new = new_rims[0] + (radii - rims[0]) * (new_rims[1] - new_rims[0]) / (rims[1] - rims[0])
        factors = np.divide(new, radii, out=np.zeros_like(radii), where=radii > 0.0)
        return np.asarray(nodes * factors[:, None])
    lines, new_lines = _lines(reference), _lines(section)
    return np.column_stack(
        [np.interp(nodes[:, k], lines[k], new_lines[k]) for k in range(nodes.shape[1])]
    )


def _lines(section: Section) -> tuple[Array, Array]:
    """Coordinates y and z (ascending) of the lines on which the edges of a section lie.

    All edges of the section are parallel to y or to z.
    """
    match section:
        case Rectangle():
            y, z = [section.width / 2.0], [section.height / 2.0]
        case HollowRectangle():
            y = [section.width / 2.0 - section.thickness, section.width / 2.0]
            z = [section.height / 2.0 - section.thickness, section.height / 2.0]
        case ISection():
            y = [section.web / 2.0, section.width / 2.0]
            z = [section.height / 2.0 - section.flange, section.height / 2.0]
        case OutlinedSection():
            corners = np.vstack(section.centred_loops)
            gap = _SAME_LINE * max(section.extent)
            first, second = (
                values[np.r_[True, np.diff(values) > gap]] for values in np.sort(corners, axis=0).T
            )
            return first, second
        case _:
            raise InputError(f"{section.shape}: a tapered section of this shape has no mesh")
    return (
        np.array([*(-value for value in reversed(y)), *y]),
        np.array([*(-value for value in reversed(z)), *z]),
    )
