"""Solid meshes of tapered, curved and bent legs: a section's mesh, moved along the line, stretched.

Each plane of nodes is the mesh of the section in the middle of the line, stretched to the size and
to the wall thickness of the section at the position of the plane. The numbering of the nodes is the
same in all planes. Hexahedra have straight sides within a linear taper, and quadratic sides along
an arc.

At a corner of the line, both pieces end in the plane that bisects the corner (a mitre). There the
nodes are the projection of the section along either piece, since each piece is the mirror image of
the continuation of the other. The planes of nodes turn gradually from the mitre to the normal of
the line, while fibres stay straight. An arc is continued along its tangent at the corner: its
fibres leave the circle by κ r²/2 at most, with the curvature κ and the reach r of the mitre, and
the volume stays that of the line, since all planes are plane and centred on it.

In a leg whose section changes in steps, each section is a part of one mesh (`meshes.stepped`), so
that the elements on both sides of a step have common nodes.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import NamedTuple

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.centre_line import CentreLine
from lumped.errors import InputError
from lumped.legs import LineLeg, Span
from lumped.line_sections import TOGETHER
from lumped.sections import (
    OutlinedSection,
    Section,
)
from meshes.quality import LARGEST_ASPECT, LEAST_SCALED_JACOBIAN, check, quality
from meshes.section.section_blocks import Divisions, element_length, has_blocks
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh
from meshes.stepped import is_mixed, is_round, stepped_sections, stretched, why_no_common_mesh

# Rotation (rad) of the axes of the sections at a corner, relative to their mirror image, below
# which outlines match.
_SAME_AXES = 1e-6
# Distance, over the largest side of the section, in which the planes of nodes turn from a mitre to
# the normal of the line, and the largest distance of the mitre's edge from the corner.
_TURNING, _LARGEST_REACH = 2.0, 1.5


@dataclass(frozen=True, eq=False)
class LoftedMesh(SolidMesh):
    """Mesh of 27-node hexahedra along the centre line `line`. The end faces are normal to the line.

    Nodes are numbered plane by plane. `positions` (p values, in m along the line) are the positions
    of the p planes of nodes. `faces` (p) are the section meshes in these planes, in the axes of the
    line, and `along` (p arrays, in m) the coordinates of their nodes along the line, relative to
    the position. They are zero in planes that are normal to the line. `numbers` (p arrays) are the
    numbers of these nodes in the solid. The face at a step is the section before it.
    """

    line: CentreLine
    positions: Array
    faces: tuple[SectionMesh, ...]
    along: tuple[Array, ...]
    numbers: tuple[IntArray, ...]

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
    if leg.steps and (reason := _why_no_steps(leg)):
        return f"{name}: {reason}, or use a CAD part"
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
    reason = _why_no_mitre(leg) if leg.line.turns else ""
    return f"{name}: {reason}" if reason else ""


def _why_no_steps(leg: LineLeg) -> str:
    """Reason why a leg with steps has no solid mesh. "" if it has one."""
    if reason := why_no_common_mesh(leg.spans):
        return f"{reason}: give a short taper"
    common = stepped_sections(leg.spans, 1)
    if is_mixed(leg.spans):
        jacobians, aspects = quality(common.mesh)
        corners = common.mesh.nodes[common.mesh.cells[:, :4]]
        shortest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).min()
        # Longest elements of the coarsest solid.
        longest = leg.line.length / slices_along(leg, 2)
        most = max(aspects.max(), longest / shortest)
        if jacobians.min() < LEAST_SCALED_JACOBIAN or most > LARGEST_ASPECT:
            return (
                "outlines of round and straight-edged sections nearly touch each other, so that "
                "elements between them are distorted: change a size by 1 %"
            )
    filled = [common.filled(number) for number in range(len(leg.spans))]
    for span, before, after in zip(leg.spans[1:], filled[:-1], filled[1:], strict=True):
        if not (before & after).any():
            return (
                f"the sections on both sides of the step at {span.start:.4g} m along the line "
                "do not touch each other: make them overlap"
            )
    return ""


def mesh_section(leg: LineLeg) -> Section:
    """Section in the middle of the line. Its mesh is stretched to those of all other sections."""
    return leg.section_at(0.5 * leg.line.length)


def leg_sections(leg: LineLeg) -> tuple[Section, ...]:
    """Distinct sections at the stations of a leg."""
    return tuple(dict.fromkeys(section for _, section in leg.stations))


def solid_section(leg: LineLeg, section: Section, divisions: Divisions) -> SectionMesh:
    """Mesh that the leg's solid has in one of its sections, `divisions` as for `loft`."""
    if leg.steps:
        return stepped_sections(leg.spans, divisions).mesh_of(section)
    reference = mesh_section(leg)
    face = section_mesh(reference, divisions)
    return replace(face, nodes=stretched(face.nodes, reference, section))


def slices_along(leg: LineLeg, divisions: Divisions) -> int:
    """Number of slices that are about as long as the elements of the section are wide.

    `divisions` is the number of elements across the smaller side of the section.
    """
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    sections = leg_sections(leg) if leg.steps else [mesh_section(leg)]
    size = min(element_length(section, count) for section in sections)
    return max(2, ceil(leg.line.length / size))


def loft(leg: LineLeg, divisions: Divisions, slices: int) -> LoftedMesh:
    """Mesh of a leg with about `slices` slices, and `divisions` as for `section_blocks`.

    Raises InputError if `why_no_loft` returns a reason, ComputationError if elements are too
    distorted.
    """
    if reason := why_no_loft(leg):
        raise InputError(reason)
    reference = mesh_section(leg)
    require_leg(reference, leg.line.length, divisions)
    if leg.steps:
        common = stepped_sections(leg.spans, divisions)
        face, nodes_at = common.mesh, common.nodes
        filled = np.array([common.filled(number) for number in range(len(leg.spans))])
    else:
        face = section_mesh(reference, divisions)
        filled = np.ones((len(leg.spans), len(face.cells)), dtype=bool)

        def nodes_at(number: int, share: float) -> Array:
            return stretched(face.nodes, reference, leg.spans[number].section(share))

    planes = _planes(leg, nodes_at, slices)
    points, axes = leg.line.frames(planes.positions, planes.pieces)
    nodes = points[:, None] + np.einsum("pij,pnj->pni", axes, planes.places)
    nodes[-1] += np.array([leg.line.chord, 0.0, 0.0]) - points[-1]
    per_plane, slice_count = len(face.nodes), len(planes.spans)
    is_filled = filled[planes.spans]
    one_slice = np.hstack([face.cells + plane * per_plane for plane in range(3)])
    offsets = 2 * per_plane * np.arange(slice_count)
    all_cells = (one_slice[None] + offsets[:, None, None])[is_filled]
    used, cells = np.unique(all_cells, return_inverse=True)
    faces, along, numbers = [], [], []
    for plane, places in enumerate(planes.places):
        section_cells = face.cells[is_filled[max(0, (plane - 1) // 2)]]
        local, renumbered = np.unique(section_cells, return_inverse=True)
        faces.append(
            SectionMesh(places[local, 1:], renumbered.reshape(section_cells.shape), face.element)
        )
        along.append(places[local, 0])
        numbers.append(np.searchsorted(used, plane * per_plane + local))
    mesh = LoftedMesh(
        nodes=nodes.reshape(-1, 3)[used],
        cells=cells.reshape(all_cells.shape),
        element="hex27",
        root=EndFace(numbers[0], faces[0], axes[0]),
        tip=EndFace(numbers[-1], faces[-1], axes[-1]),
        slices=slice_count,
        line=leg.line,
        positions=planes.positions,
        faces=tuple(faces),
        along=tuple(along),
        numbers=tuple(numbers),
    )
    check(mesh, f"leg along a line ({reference.shape})")
    return mesh


class _Planes(NamedTuple):
    """Planes of nodes along a leg: p planes and s slices, two planes for each slice and one more.

    `positions` (p, in m along the line), `pieces` (p, indices of the pieces of the line to which
    the planes belong), `places` (p×n×3, in m) of the n nodes of each plane in the axes of the line,
    and `spans` (s), indices of the spans to which the slices belong.
    """

    positions: Array
    pieces: IntArray
    places: Array
    spans: list[int]


def _planes(leg: LineLeg, nodes_at: Callable[[int, float], Array], slices: int) -> _Planes:
    """Planes of nodes of a leg with about `slices` slices.

    `nodes_at` returns the nodes (n×2, in m) of the section at a fraction of a span, from the index
    of the span and the fraction.
    """
    line = leg.line
    rotations = _rotations(line)
    positions, places, spans = [], [], []
    for number, span in enumerate(leg.spans):
        count = max(1, ceil(slices * (span.end - span.start) / line.length - TOGETHER))
        shares = np.linspace(0.0, 1.0, 2 * count + 1)
        shapes = np.array([nodes_at(number, float(share)) for share in shares])
        shapes = shapes @ rotations[_piece_of(line, span)].T
        first, last = (
            shape @ mitre
            for shape, mitre in zip(shapes[[0, -1]], _span_mitres(line, span), strict=True)
        )
        turning = _turning_slices(span, count) / count
        weights = np.clip(1.0 - np.array([shares, 1.0 - shares]) / turning, 0.0, 1.0)
        along = np.outer(weights[0], first) + np.outer(weights[1], last)
        # The first plane of a span is the last one of the span before.
        kept = slice(0 if number == 0 else 1, None)
        positions.append(span.start + (span.end - span.start) * shares[kept])
        places.append(np.concatenate([along[:, :, None], shapes], axis=2)[kept])
        spans += [number] * count
    planes = np.concatenate(positions)
    # A plane between two pieces belongs to the one before it, which meets the next one smoothly or
    # at a mitre. Ends of spans equal those of pieces up to round-off.
    pieces = np.searchsorted(line.ends + TOGETHER * line.length, planes, side="left") - 1
    pieces = np.clip(pieces, 0, len(line.pieces) - 1)
    return _Planes(planes, pieces, np.concatenate(places), spans)


def _piece_of(line: CentreLine, span: Span) -> int:
    """Index of the piece of a line that contains a span."""
    return int(line.piece_at(np.array([0.5 * (span.start + span.end)]))[0])


def _span_mitres(line: CentreLine, span: Span) -> Array:
    """Slopes (2×2) along y and z of the planes at the start and at the end of a span.

    A point (y, z) of the section there is moved along the line by the scalar product of (y, z) and
    the slopes. They are zero if the plane is normal to the line.
    """
    slopes = np.zeros((2, 2))
    slack, piece = TOGETHER * line.length, _piece_of(line, span)
    if piece in line.turns and span.start - line.ends[piece] <= slack:
        slopes[0] = line.mitre(piece)[1]
    if piece + 1 in line.turns and line.ends[piece + 1] - span.end <= slack:
        slopes[1] = line.mitre(piece + 1)[0]
    return slopes


def _turning_slices(span: Span, count: int) -> int:
    """Number of the `count` slices of a span over which planes turn from a mitre to the normal.

    In a taper these are all slices: fibres are straight only if planes turn evenly.
    """
    if span.first != span.last:
        return count
    length = _TURNING * max(span.first.extent)
    return min(count, ceil(count * length / (span.end - span.start) - TOGETHER))


def _rotations(line: CentreLine) -> Array:
    """Rotations (p×2×2) of the section's mesh in the axes of the p pieces of a line.

    At a corner, the mesh is mirrored in the plane of the mitre. The axes of the sections are the
    mirror image, too, if `up` lies in this plane or in that of the corner.
    """
    rotations = np.tile(np.eye(2), (len(line.pieces), 1, 1))
    for number in line.turns:
        before, after = line.corner_axes(number)
        normal = before[:, 0] + after[:, 0]
        mirror = np.eye(3) - 2.0 * np.outer(normal, normal) / float(normal @ normal)
        rotations[number:] = after[:, 1:].T @ mirror @ before[:, 1:] @ rotations[number - 1]
    return rotations


def _why_no_mitre(leg: LineLeg) -> str:
    """Reason why a corner of a leg's line has no mitre that could be meshed. "" if all have one."""
    line, rotations = leg.line, _rotations(leg.line)
    turnable = all(is_round(section) for section in leg_sections(leg))
    for number in line.turns:
        place = f"the corner at {line.ends[number]:.4g} m along the line"
        if not turnable and np.abs(rotations[number] - np.eye(2)).max() > _SAME_AXES:
            return (
                f"the outlines of the sections do not meet at {place}, because `up` is neither in "
                "its plane nor in the plane that bisects it: give an arc, or use a CAD part"
            )
    for span in leg.spans:
        slopes = np.abs(_span_mitres(line, span))
        reach = [
            0.5 * float(slope @ section.extent)
            for slope, section in zip(slopes, (span.first, span.last), strict=True)
        ]
        # The fibre on the inner side of an arc is shorter than the line.
        curved = 0.5 * max(span.first.extent) / line.pieces[_piece_of(line, span)].radius
        inner_length = (span.end - span.start) * (1.0 - curved)
        if sum(reach) >= inner_length or max(reach) >= _LARGEST_REACH * max(span.first.extent):
            return (
                f"the mitres of corners are longer than the inner side of the line between "
                f"{span.start:.4g} m and {span.end:.4g} m: give an arc, or use a CAD part"
            )
    return ""
