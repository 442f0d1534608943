"""Section mesh of a leg whose section changes in steps: a mesh from which all sections are cut.

The lines or circles on which the edges of all sections lie divide the plane into blocks. Each
section is a set of blocks. Both sides of a step therefore have the same nodes where they meet, and
the solid is conforming. Either all sections have edges parallel to y and z, or all are circles and
tubes, or both kinds are rectangles and circles, solid or hollow (`meshes.section.star_mesh`). Where
a section tapers, the lines move with its edges, and those of the other sections with them: the
edges of a later section are lines of the mesh at the root that arrive there. In a leg with sections
of both kinds, the lines at steps from one kind to the other are those of the mesh. Parts between
two such steps are therefore constant, and parts at the ends of the leg may taper.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from math import ceil, pi
from typing import NamedTuple, TypeAlias

import numpy as np

from lumped.arrays import Array, BoolArray, distinct
from lumped.errors import InputError
from lumped.legs import Span
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
from meshes.section.section_mesh import (
    SectionMesh,
    counter_clockwise,
    quadrilaterals,
    section_mesh,
)
from meshes.section.star_mesh import Outline, star_mesh

# Distance, as a fraction of the section's size, below which coordinates of corners count as one.
_SAME_LINE = 1e-9
_ROUND_OFF = 1e-9
# Smallest number of elements along a quarter of a circle: a parabola is a poor arc of 90°.
_LEAST_QUARTER = 2
# Divisions of the coarsest mesh of round and straight-edged sections. Fewer have the same mesh.
_COARSEST = 4


def is_round(section: Section) -> bool:
    """True for a circle and for a tube."""
    return isinstance(section, Circle | Tube)


def is_mixed(spans: Sequence[Span]) -> bool:
    """True for a leg with round and with straight-edged sections."""
    return len({is_round(span.first) for span in spans}) > 1


def why_no_common_mesh(spans: Sequence[Span]) -> str:
    """Reason why the sections of a leg's spans cannot be cut from one mesh. "" if they can."""
    sections = [section for span in spans for section in (span.first, span.last)]
    if all(is_round(section) for section in sections):
        return ""
    straight = Rectangle | HollowRectangle | ISection | OutlinedSection
    shapes = ", ".join(dict.fromkeys(section.shape for section in sections))
    inner_spans = [span for run in _runs(spans)[1:-1] for span in run]
    if is_mixed(spans) and any(span.first != span.last for span in inner_spans):
        return f"a taper between two steps of {shapes} has no mesh"
    meshable = Circle | Tube | Rectangle | HollowRectangle if is_mixed(spans) else straight
    if not all(isinstance(section, meshable) for section in sections):
        return f"a step between {shapes} has no mesh"
    if all(has_blocks(s) for s in sections if isinstance(s, OutlinedSection)):
        return ""
    return f"a step between {shapes} has no mesh: not all edges are parallel to y and z"


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Function of one coordinate: linear between `knots`, where it has `values` (both ascending).

    Beyond the first and the last knot its slope is one.
    """

    knots: Array
    values: Array

    def __call__(self, coordinates: Array) -> Array:
        inside = np.clip(coordinates, self.knots[0], self.knots[-1])
        return np.asarray(np.interp(inside, self.knots, self.values) + coordinates - inside)

    @property
    def inverse(self) -> "_Stretch":
        return _Stretch(self.values, self.knots)

    def then(self, outer: "_Stretch") -> "_Stretch":
        """Function that applies `outer` to the result of this one."""
        knots = np.union1d(self.knots, self.inverse(outer.knots))
        return _Stretch(knots, outer(self(knots)))


# Stretches of a section's plane: along y and along z, or one along the radius.
_Stretches: TypeAlias = tuple[_Stretch, ...]


@dataclass(frozen=True, eq=False)
class SteppedSections:
    """Common mesh of the sections of a leg with k spans, and its stretching in each span.

    Elements of `mesh` belong to the section of a span as a whole or not at all. In a tapered span
    the nodes move with the edges of its section. A later span begins with the nodes where the span
    before ends. `starts` and `ends` (k) are the stretches of the mesh at both ends of the spans.
    """

    mesh: SectionMesh
    spans: tuple[Span, ...]
    starts: tuple[_Stretches, ...]
    ends: tuple[_Stretches, ...]

    def nodes(self, number: int, share: float) -> Array:
        """Nodes (n×2, in m) of the mesh at the fraction `share` of span `number` (from 0)."""
        start, end = (
            _stretched(self.mesh.nodes, ends[number]) for ends in (self.starts, self.ends)
        )
        return np.asarray((1.0 - share) * start + share * end)

    def filled(self, number: int) -> BoolArray:
        """Flags of the elements of the mesh that belong to the section of span `number`."""
        # The last node of a nine-node quadrilateral is its middle.
        middles = self.mesh.nodes[self.mesh.cells[:, 8]]
        return _is_within(_stretched(middles, self.starts[number]), self.spans[number].first)

    def mesh_of(self, section: Section) -> SectionMesh:
        """Mesh that the solid has where its section is `section`.

        Raises InputError if no span has this section.
        """
        for number, span in enumerate(self.spans):
            if (share := span.share_of(section)) is not None:
                mesh = SectionMesh(self.nodes(number, share), self.mesh.cells, self.mesh.element)
                return _part(mesh, self.filled(number))
        raise InputError(f"{section.shape}: the leg has no such section")


@memo(16)
def stepped_sections(spans: tuple[Span, ...], divisions: Divisions) -> SteppedSections:
    """Common mesh of the sections of a leg with steps, and tapers between them.

    `divisions` is the number of elements across the smaller side of the smallest section.
    """
    sections = [section for span in spans for section in (span.first, span.last)]
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    layouts = [_layout(run) for run in _runs(spans)]
    if is_mixed(spans):
        # The first run ends with the lines of the mesh, all others begin with them.
        first_run = reversed(_runs(spans)[0])
        reverse = _layout([Span(s.start, s.end, s.last, s.first) for s in first_run])
        layouts[0] = _Layout(reverse.ends[::-1], reverse.starts[::-1], reverse.edges[::-1])
    edges = [axes for layout in layouts for axes in layout.edges]
    if is_mixed(spans):
        mesh = _mesh_of_outlines(edges, sections, count)
    else:
        gap = _SAME_LINE * max(max(section.extent) for section in sections)
        lines = [distinct(np.sort(np.concatenate(axis)), gap) for axis in zip(*edges, strict=True)]
        mesh = _mesh_on(lines, sections, count)
    starts = tuple(stretches for layout in layouts for stretches in layout.starts)
    ends = tuple(stretches for layout in layouts for stretches in layout.ends)
    common = SteppedSections(mesh, spans, starts, ends)
    kept = np.any([common.filled(number) for number in range(len(spans))], axis=0)
    return replace(common, mesh=_part(mesh, kept))


def _runs(spans: Sequence[Span]) -> list[list[Span]]:
    """Successive spans of a leg, grouped if their sections are of one kind, round or straight."""
    return [list(run) for _, run in groupby(spans, key=lambda span: is_round(span.first))]


class _Layout(NamedTuple):
    """Stretches of the mesh at both ends of k spans, and the lines of the mesh on their edges."""

    starts: list[_Stretches]
    ends: list[_Stretches]
    edges: list[list[Array]]


def _layout(spans: Sequence[Span]) -> _Layout:
    """Layout of spans whose sections are of one kind. The first span begins without a stretch."""
    stretches: _Stretches = tuple(
        _Stretch(np.zeros(1), np.zeros(1)) for _ in _edges(spans[0].first)
    )
    layout = _Layout([], [], [])
    for span in spans:
        layout.starts.append(stretches)
        layout.edges.append(
            [s.inverse(e) for s, e in zip(stretches, _edges(span.first), strict=True)]
        )
        if span.first != span.last:
            taper = _stretches(span.first, span.last)
            stretches = tuple(s.then(t) for s, t in zip(stretches, taper, strict=True))
        layout.ends.append(stretches)
    return layout


def _edges(section: Section) -> tuple[Array, ...]:
    """Coordinates y and z of the edges of a section, or its radii with zero as the first."""
    if not isinstance(section, Circle | Tube):
        return section_lines(section)
    rims = {0.0, section.inner_diameter / 2.0, section.diameter / 2.0}
    return (np.array(sorted(rims)),)


def _mesh_on(lines: list[Array], sections: Sequence[Section], count: int) -> SectionMesh:
    """Mesh of the whole area between `lines`, the y and z of edges, or radii with zero.

    `count` is the number of elements across the smaller side of the smallest of the `sections`.
    """
    size = min(element_length(section, count) for section in sections)
    if len(lines) == 1:
        has_core = any(isinstance(section, Circle) for section in sections)
        return _discs(lines[0][1:], size, count, has_core=has_core)
    if not all(isinstance(section, Rectangle) for section in sections):
        size = min(size, WALL_ASPECT * min(float(np.diff(values).min()) for values in lines))
    ys, zs = (_subdivided(values, size, ceil(count / 4)) for values in lines)
    return _grid_mesh(ys, zs)


def _mesh_of_outlines(
    edges: Sequence[Sequence[Array]], sections: Sequence[Section], count: int
) -> SectionMesh:
    """Mesh of circles and rectangles with one centre, of which all outlines are lines of the mesh.

    `edges` are the y and z of the edges of each rectangle, or the radii of each circle with zero.
    `count` is the number of elements across the smaller side of the smallest of the `sections`.
    """
    outlines = [
        Outline(y, z, is_round=len(axes) == 1)
        for axes in edges
        for y, z in zip(axes[0].tolist(), axes[-1].tolist(), strict=True)
        if y > 0.0
    ]
    size = min(element_length(section, _COARSEST) for section in sections)
    is_solid = any(isinstance(section, Circle | Rectangle) for section in sections)
    return star_mesh(outlines, size, ceil(count / _COARSEST), has_core=is_solid)


def stretched(nodes: Array, reference: Section, section: Section) -> Array:
    """Nodes (n×2) of a mesh of the section `reference`, moved to a `section` of the same shape."""
    return nodes if section == reference else _stretched(nodes, _stretches(reference, section))


def _stretches(first: Section, last: Section) -> _Stretches:
    """Stretches from the edges of a section to those of another one of the same shape."""
    return tuple(_Stretch(*pair) for pair in zip(_edges(first), _edges(last), strict=True))


def _stretched(points: Array, stretches: _Stretches) -> Array:
    """Points (n×2) of a section's plane, moved by its stretches."""
    if len(stretches) == 2:
        return np.column_stack([s(points[:, axis]) for axis, s in enumerate(stretches)])
    radii = np.hypot(*points.T)
    moved = stretches[0](radii)
    factors = np.divide(moved, radii, out=np.zeros_like(radii), where=radii > 0.0)
    return np.asarray(points * factors[:, None])


def _is_within(points: Array, section: Section) -> BoolArray:
    """Flags (n) of the points (n×2) that lie in a section."""
    y, z = points.T
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
            return np.array([is_inside(section.centred_loops, point) for point in points])
        case _:
            raise InputError(f"{section.shape}: edges of this shape are not parallel to y and z")


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
    return SectionMesh(nodes, quadrilaterals(len(ys), len(zs), len(ys)), "quad9")


def _discs(radii: Array, longest: float, count: int, *, has_core: bool) -> SectionMesh:
    """Mesh of concentric rings between `radii` (ascending), with a core if `has_core`.

    Elements are at most `longest` (m) along the radius. `count` is the number of elements across
    the core, and four times the least number between two radii.
    """
    if has_core:
        core = section_mesh(Circle(2.0 * float(radii[0])), max(3, count))
        rim = np.flatnonzero(np.hypot(*core.nodes.T) > radii[0] * (1.0 - 1e-6))
        rim = rim[np.argsort(np.arctan2(core.nodes[rim, 1], core.nodes[rim, 0]))]
        # Corners of elements alternate with the middles of their sides.
        rim = np.roll(rim, 0 if np.isin(rim[0], core.cells[:, :4]) else 1)
        nodes, cells = core.nodes, core.cells
    else:
        side = min(longest, WALL_ASPECT * float(np.diff(radii).min()))
        quarter = max(_LEAST_QUARTER, ceil(0.5 * pi * float(radii[0]) / side))
        angles = 2.0 * pi * np.arange(8 * quarter) / (8 * quarter)
        nodes = float(radii[0]) * np.column_stack([np.cos(angles), np.sin(angles)])
        rim, cells = np.arange(len(nodes)), np.zeros((0, 9), dtype=int)
    if len(radii) > 1:
        layers = _subdivided(radii, longest, ceil(count / 4))[1:]
        directions = nodes[rim] / np.hypot(*nodes[rim].T)[:, None]
        first = len(nodes)
        outer = (layers[:, None, None] * directions).reshape(-1, 2)
        ring = quadrilaterals(len(rim) + 1, len(layers) + 1, len(rim))
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
