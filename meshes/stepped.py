"""Section mesh of a leg whose section changes in steps: a mesh from which all sections are cut.

The lines or circles on which the edges of all sections lie divide the plane into blocks. Each
section is a set of blocks. Both sides of a step therefore have the same nodes where they meet, and
the solid is conforming. The sections are constant between steps. Either all have edges parallel to
y and z, or all are circles and tubes.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, pi

import numpy as np

from lumped.arrays import Array, BoolArray, IntArray, distinct
from lumped.errors import InputError
from lumped.memo import memo
from lumped.sections import (
    Circle,
    HollowRectangle,
    ISection,
    OutlinedSection,
    Rectangle,
    Section,
    Tube,
    is_inside,
)
from meshes.section.section_blocks import WALL_ASPECT, Divisions, element_length, has_blocks
from meshes.section.section_mesh import SectionMesh, counter_clockwise, section_mesh

# Distance, as a fraction of the section's size, below which coordinates of corners count as one.
_SAME_LINE = 1e-9
_ROUND_OFF = 1e-9
# Smallest number of elements along a quarter of a circle: a parabola is a poor arc of 90°.
_LEAST_QUARTER = 2


def is_round(section: Section) -> bool:
    """True for a circle and for a tube."""
    return isinstance(section, Circle | Tube)


def why_no_common_mesh(sections: Sequence[Section]) -> str:
    """Reason why sections cannot be cut from one mesh. "" if they can."""
    if all(is_round(section) for section in sections):
        return ""
    straight = Rectangle | HollowRectangle | ISection | OutlinedSection
    shapes = ", ".join(dict.fromkeys(section.shape for section in sections))
    if not all(isinstance(section, straight) for section in sections):
        return f"a step between {shapes} has no mesh"
    if all(has_blocks(s) for s in sections if isinstance(s, OutlinedSection)):
        return ""
    return f"a step between {shapes} has no mesh: not all edges are parallel to y and z"


@memo(16)
def common_mesh(sections: tuple[Section, ...], divisions: Divisions) -> SectionMesh:
    """Mesh of the union of `sections`, whose elements belong to a section as a whole or not at all.

    `divisions` is the number of elements across the smaller side of the smallest section.
    """
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    size = min(element_length(section, count) for section in sections)
    if is_round(sections[0]):
        return _discs(sections, count)
    lines = zip(*(section_lines(section) for section in sections), strict=True)
    gap = _SAME_LINE * max(max(section.extent) for section in sections)
    ys, zs = (distinct(np.sort(np.concatenate(coordinates)), gap) for coordinates in lines)
    if not all(isinstance(section, Rectangle) for section in sections):
        wall = min(float(np.diff(ys).min()), float(np.diff(zs).min()))
        size = min(size, WALL_ASPECT * wall)
    across = ceil(count / 4)
    grids = [_subdivided(values, size, across) for values in (ys, zs)]
    mesh = _grid_mesh(*grids)
    kept = np.any([cells_in(mesh, section) for section in sections], axis=0)
    return _part(mesh, kept)


def cells_in(mesh: SectionMesh, section: Section) -> BoolArray:
    """Flags (M) of the elements of a common mesh that belong to a section."""
    # The last node of a nine-node quadrilateral is its middle.
    y, z = mesh.nodes[mesh.cells[:, 8]].T
    match section:
        case Circle() | Tube():
            radii = np.hypot(y, z)
            inner = section.inner_diameter if isinstance(section, Tube) else 0.0
            return np.asarray((radii < section.diameter / 2.0) & (radii >= inner / 2.0))
        case Rectangle():
            return _in_box(y, z, section.width, section.height)
        case HollowRectangle():
            inside = _in_box(y, z, *section.inner.extent)
            return np.asarray(_in_box(y, z, section.width, section.height) & ~inside)
        case ISection():
            web_height = section.height - 2.0 * section.flange
            flanges = np.abs(z) > web_height / 2.0
            web = _in_box(y, z, section.web, web_height)
            return np.asarray(_in_box(y, z, section.width, section.height) & (flanges | web))
        case OutlinedSection():
            loops = section.centred_loops
            return np.array([is_inside(loops, point) for point in np.column_stack([y, z])])
        case _:
            raise InputError(f"{section.shape}: edges of this shape are not parallel to y and z")


def cut(sections: tuple[Section, ...], section: Section, divisions: Divisions) -> SectionMesh:
    """Mesh of one of the `sections`, cut from their common mesh."""
    mesh = common_mesh(sections, divisions)
    return _part(mesh, cells_in(mesh, section))


def _in_box(y: Array, z: Array, width: float, height: float) -> BoolArray:
    return np.asarray((np.abs(y) < width / 2.0) & (np.abs(z) < height / 2.0))


def _part(mesh: SectionMesh, kept: BoolArray) -> SectionMesh:
    """Part of a mesh: its `kept` cells (M flags) and their nodes."""
    used, cells = np.unique(mesh.cells[kept], return_inverse=True)
    return SectionMesh(mesh.nodes[used], cells.reshape(-1, 9), mesh.element)


def _subdivided(lines: Array, size: float, least: int) -> Array:
    """Coordinates of all nodes along one axis: elements between `lines`, and their middles.

    Elements are at most `size` (m) long, with at least `least` between two lines.
    """
    pieces = []
    for start, end in pairwise(lines.tolist()):
        count = max(least, ceil((end - start) / size - _ROUND_OFF))
        pieces.append(np.linspace(start, end, 2 * count + 1)[:-1])
    return np.concatenate([*pieces, lines[-1:]])


def _grid_mesh(ys: Array, zs: Array) -> SectionMesh:
    """Nine-node quadrilaterals on the nodes at all pairs of `ys` and `zs`."""
    nodes = np.column_stack([np.tile(ys, len(zs)), np.repeat(zs, len(ys))])
    return SectionMesh(nodes, _quadrilaterals(len(ys), len(zs), len(ys)), "quad9")


def _quadrilaterals(across: int, along: int, period: int) -> IntArray:
    """Cells (M×9) on a grid of `across` × `along` nodes, numbered row by row.

    Nodes of a row are numbered modulo `period`: a row is closed if it has one node more.
    """
    column, row = np.meshgrid(np.arange(0, across - 1, 2), np.arange(0, along - 1, 2))
    steps = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
    return np.column_stack([((column + i) % period + (row + j) * period).ravel() for i, j in steps])


def _discs(sections: Sequence[Section], count: int) -> SectionMesh:
    """Mesh of concentric rings between the rims of circles and tubes, with a core if one is solid.

    `count` is the number of elements across the smallest diameter.
    """
    rims = [s.diameter / 2.0 for s in sections if isinstance(s, Circle | Tube)]
    rims += [s.inner_diameter / 2.0 for s in sections if isinstance(s, Tube)]
    radii = distinct(np.sort(np.array(rims)), _SAME_LINE * max(rims))
    size = 2.0 * min(s.diameter / 2.0 for s in sections if isinstance(s, Circle | Tube)) / count
    if any(isinstance(section, Circle) for section in sections):
        core = section_mesh(Circle(2.0 * float(radii[0])), max(3, count))
        rim = np.flatnonzero(np.hypot(*core.nodes.T) > radii[0] * (1.0 - 1e-6))
        rim = rim[np.argsort(np.arctan2(core.nodes[rim, 1], core.nodes[rim, 0]))]
        # Corners of elements alternate with the middles of their sides.
        rim = np.roll(rim, 0 if np.isin(rim[0], core.cells[:, :4]) else 1)
        nodes, cells = core.nodes, core.cells
    else:
        longest = min(size, WALL_ASPECT * float(np.diff(radii).min()))
        quarter = max(_LEAST_QUARTER, ceil(0.5 * pi * float(radii[0]) / longest))
        angles = 2.0 * pi * np.arange(8 * quarter) / (8 * quarter)
        nodes = float(radii[0]) * np.column_stack([np.cos(angles), np.sin(angles)])
        rim, cells = np.arange(len(nodes)), np.zeros((0, 9), dtype=int)
    if len(radii) > 1:
        layers = _subdivided(radii, size, ceil(count / 4))[1:]
        directions = nodes[rim] / np.hypot(*nodes[rim].T)[:, None]
        first = len(nodes)
        outer = (layers[:, None, None] * directions).reshape(-1, 2)
        ring = _quadrilaterals(len(rim) + 1, len(layers) + 1, len(rim))
        numbers = np.concatenate([rim, first + np.arange(len(outer))])
        nodes = np.vstack([nodes, outer])
        cells = np.vstack([cells, counter_clockwise(nodes, numbers[ring], "quad9")])
    return SectionMesh(nodes, cells, "quad9")


def section_lines(section: Section) -> tuple[Array, Array]:
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
            first, second = (distinct(values, gap) for values in np.sort(corners, axis=0).T)
            return first, second
        case _:
            raise InputError(f"{section.shape}: edges of this shape are not parallel to y and z")
    return (
        np.array([*(-value for value in reversed(y)), *y]),
        np.array([*(-value for value in reversed(z)), *z]),
    )
