"""Division of section shapes into four-sided blocks for a structured mesh.

`divisions` is the number of elements across the smaller side of the section's bounding box:

- rectangle: this number across the smaller side, and along the larger side as many as make the
  elements nearly square, or fewer in a narrow strip (`side_ratio`). For this shape `divisions` can
  also be two numbers, along y and z;
- circle: this number, but at least three, across a diameter (a core with curved sides, and a ring
  of four blocks around it);
- walls (hollow rectangle, tube, I, channel, angle, tee, and polygons and composites all of whose
  edges are parallel to y or z): across the thickness, one element per four divisions, and more in
  a thick wall (`_across`); along the wall, elements whose length is the smaller side divided by
  `divisions`, but not longer than `WALL_ASPECT` times their thickness.

Meshes with divisions of 4, 8, 16, … are uniform refinements of each other for every shape. Polygons
and composites with other edges have no blocks: `meshes.section.section_mesh` fills them without
blocks.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, log2, pi, prod, radians, sqrt, tan
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import InputError
from lumped.sections import (
    Circle,
    Composite,
    HollowRectangle,
    ISection,
    Laminate,
    LaminateBox,
    LaminateTube,
    Loop,
    OutlinedSection,
    Rectangle,
    Section,
    Tube,
    is_inside,
)

Divisions: TypeAlias = int | tuple[int, int]
Edge: TypeAlias = tuple[int, int]

# Largest aspect ratio of elements in a wall. Along a wall, stresses vary over lengths of the order
# of the section's size, not of the wall's thickness.
WALL_ASPECT = 8.0
# Core of a circle: its width along the axes as a fraction of the diameter, and the half opening
# angle of its curved sides, chosen so that three blocks meet at 120° each.
_CORE_SHARE = 0.5
_CORE_BULGE = radians(15.0)
# Tolerance that prevents round-off in ratios such as 0.3 / 0.1 from adding an element.
_ROUND_OFF = 1e-9
# Divisions of the coarsest mesh of a polygon without blocks. Fewer divisions give the same mesh.
_COARSEST = 4
# Edges that are closer than this fraction of the section's size lie on one line of blocks.
_SAME_LINE = 1e-9


@dataclass(frozen=True, eq=False)
class Blocks:
    """Four-sided blocks that fill a section.

    `points` (P×2) are coordinates y and z in m. `corners` contains the four point numbers of each
    block, counter-clockwise. An edge is a pair of point numbers; the dictionaries contain each edge
    in one of its two directions. `counts` is the number of elements along each edge. `arc_centres`
    (y and z, in m) is the centre of each edge that is a circular arc. In a section of several
    materials, `regions` contains for each block the index of the part to which it belongs. () in
    other sections.
    """

    points: Array
    corners: tuple[tuple[int, int, int, int], ...]
    counts: dict[Edge, int]
    arc_centres: dict[Edge, tuple[float, float]]
    regions: tuple[int, ...] = ()


def section_blocks(section: Section, divisions: Divisions) -> Blocks:
    """Blocks of a valid section. Raises InputError if `divisions` do not suit it."""
    match section, divisions:
        case Rectangle() as rectangle, _:
            return _rectangle(rectangle, divisions)
        case (HollowRectangle() | LaminateBox()) as hollow, int() as count:
            return _hollow_rectangle(hollow, count)
        case Circle() as circle, int() as count:
            return _circle(circle, count)
        case (Tube() | LaminateTube()) as tube, int() as count:
            return _tube(tube, count)
        case ISection() as i_section, int() as count:
            return _i_section(i_section, count)
        case (OutlinedSection() | Composite()) as outlined, int() as count if has_blocks(outlined):
            return _rectilinear(outlined, count)
    raise InputError(
        f"{section.shape}: divisions = {divisions}: must be one number for this section"
    )


def has_blocks(section: OutlinedSection | Composite) -> bool:
    """True if all edges of a section, of its holes and of its parts are parallel to y or to z."""
    gap = _SAME_LINE * max(section.extent)
    parts = section.parts if isinstance(section, Composite) else [section]
    loops = (loop for part in parts for loop in part.loops)
    ways = [np.abs(np.roll(loop, -1, axis=0) - loop) for loop in loops]
    return bool((np.vstack(ways).min(axis=1) <= gap).all())


def refinements(divisions: Divisions) -> int:
    """Number of times that each element of a polygon's coarsest mesh is divided into four.

    It is the smallest number for which the mesh has at least the required `divisions`.
    """
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    return max(0, ceil(log2(count / _COARSEST)))


def side_ratio(section: Section) -> float:
    """Ratio of the number of elements along the larger side to that along the smaller side.

    A strip bends like a plate, over lengths of the order of its width. If a strip is wider than
    `WALL_ASPECT` times its thickness, its elements are therefore stretched along the width of the
    strip.
    """
    smaller, larger = sorted(section.extent)
    ratio = larger / smaller
    return ratio if ratio <= WALL_ASPECT else max(WALL_ASPECT, ratio / WALL_ASPECT)


def element_length(section: Section, divisions: int) -> float:
    """Length (m) along the leg of solid elements, `divisions` of which span the smaller side.

    Elements are as long as they are wide across the smaller side, or longer in a wide strip.
    """
    smaller, larger = sorted(section.extent)
    if not isinstance(section, Rectangle) or larger <= WALL_ASPECT * smaller:
        return smaller / divisions
    return larger / (divisions * side_ratio(section))


def element_count(section: Section, divisions: Divisions) -> int:
    """Number of elements in the mesh of a section. Raises InputError as `section_blocks` does.

    For a polygon without blocks this is an estimate: the number of squares that fill its area.
    """
    if isinstance(section, OutlinedSection | Composite) and not has_blocks(section):
        size = min(section.extent) / (_COARSEST * 2 ** refinements(divisions))
        return int(np.ceil(section.area / size**2))
    blocks = section_blocks(section, divisions)
    return sum(prod(sides_of(blocks, corners)) for corners in blocks.corners)


def sides_of(blocks: Blocks, corners: tuple[int, int, int, int]) -> tuple[int, int]:
    """Numbers of elements along the first and second side of a block.

    `corners` are the four point numbers of the block. The first side runs from its first corner to
    its second.
    """
    a, b, c, _ = corners
    across, along = (
        blocks.counts.get(edge) or blocks.counts[edge[::-1]] for edge in ((a, b), (b, c))
    )
    return across, along


def _across(thickness: float, side: float, divisions: int) -> int:
    """Number of elements across a wall of the given `thickness` (m).

    `side` (m) is the section's smaller side.
    """
    return ceil(divisions / 4) * _fitting(thickness, side / 4.0)


def _along(length: float, thickness: float, side: float, divisions: int) -> int:
    """Number of elements along a wall of the given `length` and `thickness` (m).

    It is the number for four divisions, times divisions / 4. It is increased if the aspect ratio of
    an element would exceed `WALL_ASPECT`. `side` (m) is the section's smaller side.
    """
    longest = WALL_ASPECT * thickness / _across(thickness, side, 4)
    of_four = _fitting(length, min(side / 4.0, longest))
    bounded = _fitting(length, WALL_ASPECT * thickness / _across(thickness, side, divisions))
    return max(ceil(divisions * of_four / 4), bounded)


def _fitting(length: float, size: float) -> int:
    return max(1, ceil(length / size - _ROUND_OFF))


def _rectangle(section: Rectangle, divisions: Divisions) -> Blocks:
    if isinstance(divisions, tuple):
        along_y, along_z = divisions
    else:
        smaller = min(section.extent)
        along_y, along_z = (
            divisions if side == smaller else ceil(divisions * round(4.0 * side_ratio(section)) / 4)
            for side in section.extent
        )
    return _grid(
        _mirrored(section.width), _mirrored(section.height), [along_y], [along_z], [[True]]
    )


def _hollow_rectangle(section: HollowRectangle | LaminateBox, divisions: int) -> Blocks:
    if isinstance(section, LaminateBox):
        return _box_of_layers(section, divisions)
    inner, thickness, side = section.inner, section.thickness, min(section.extent)
    across = _across(thickness, side, divisions)
    along_y, along_z = (_along(clear, thickness, side, divisions) for clear in inner.extent)
    return _grid(
        _mirrored(section.width, inner.width),
        _mirrored(section.height, inner.height),
        [across, along_y, across],
        [across, along_z, across],
        [[True, True, True], [True, False, True], [True, True, True]],
    )


def _i_section(section: ISection, divisions: int) -> Blocks:
    side = min(section.extent)
    across_flange = _across(section.flange, side, divisions)
    across_web = _across(section.web, side, divisions)
    clear_height = section.height - 2.0 * section.flange
    overhang = _along((section.width - section.web) / 2.0, section.flange, side, divisions)
    along_web = _along(clear_height, section.web, side, divisions)
    return _grid(
        _mirrored(section.width, section.web),
        _mirrored(section.height, clear_height),
        [overhang, across_web, overhang],
        [across_flange, along_web, across_flange],
        [[True, True, True], [False, True, False], [True, True, True]],
    )


def _rectilinear(section: OutlinedSection | Composite, divisions: int) -> Blocks:
    """Rectangular blocks of a section, bounded by the lines through all its edges."""
    parts = section.centred_loops if isinstance(section, Composite) else (section.centred_loops,)
    corners = np.vstack([loop for loops in parts for loop in loops])
    ys, zs = (_lines(corners[:, axis], section) for axis in (0, 1))
    middles_y, middles_z = (0.5 * (line[:-1] + line[1:]) for line in (ys, zs))
    owners = np.array(
        [[_part_at(parts, np.array([y, z])) for y in middles_y] for z in middles_z], dtype=int
    )
    side = min(section.extent)
    blocks = _grid(
        ys.tolist(),
        zs.tolist(),
        _strip_counts(np.diff(ys), np.diff(zs), owners.T, side, divisions),
        _strip_counts(np.diff(zs), np.diff(ys), owners, side, divisions),
        (owners >= 0).tolist(),
    )
    if isinstance(section, Composite):
        return replace(blocks, regions=tuple(owners[owners >= 0].tolist()))
    return blocks


def _part_at(parts: Sequence[Sequence[Loop]], point: Array) -> int:
    """Number of the part that contains a point (y and z, in m). −1 if no part does.

    `parts` contains the outlines of each part: the outer one and those of its holes.
    """
    return next((number for number, loops in enumerate(parts) if is_inside(loops, point)), -1)


def _lines(coordinates: Array, section: Section) -> Array:
    """Coordinates (m, ascending) of the parallel lines on which edges of a section lie.

    `coordinates` are those of all corners along one axis.
    """
    ordered = np.sort(coordinates)
    steps = np.diff(ordered, prepend=-np.inf)
    return np.asarray(ordered[steps > _SAME_LINE * max(section.extent)])


def _strip_counts(
    widths: Array, across: Array, owners: IntArray, side: float, divisions: int
) -> list[int]:
    """Number of elements across each of the parallel strips into which a section is divided.

    `widths` (m) are the widths of the strips. Perpendicular strips with the widths `across` (m)
    divide them into blocks. `owners` (one row per strip, one column per block) contains the number
    of the part to which a block belongs, −1 outside the section. Adjacent blocks of one part in a
    strip form a run. A strip is a wall if its shortest run is at least as long as the strip is
    wide. A wall is divided across its thickness (`_across`). The width of any other strip is
    divided like a piece of wall of that length (`_along`), whose thickness is the length of the
    shortest run. `side` (m) is the section's smaller side.
    """
    counts = []
    for width, blocks in zip(widths.tolist(), owners, strict=True):
        edges = np.flatnonzero(np.diff(np.concatenate([[-1], blocks, [-1]])))
        runs = [float(across[a:b].sum()) for a, b in pairwise(edges) if blocks[a] >= 0]
        thinnest = min(runs)
        # The strip is a wall if it is thinner than all runs of blocks along it.
        if width <= thinnest:
            counts.append(_across(width, side, divisions))
        else:
            counts.append(_along(width, thinnest, side, divisions))
    return counts


def _mirrored(*sizes: float) -> list[float]:
    """Coordinates (m, ascending) of the sides of strips centred at 0.

    `sizes` (m) are the widths of the strips, the widest first.
    """
    return [-size / 2.0 for size in sizes] + [size / 2.0 for size in reversed(sizes)]


def _grid(
    ys: list[float],
    zs: list[float],
    counts_y: list[int],
    counts_z: list[int],
    filled: Sequence[Sequence[bool]],
) -> Blocks:
    """Rectangular blocks between lines at `ys` and `zs` (m).

    `filled` has a row for each interval of `zs`, and in it one flag for each interval of `ys`: True
    if a block is made there. `counts_y` and `counts_z` are the numbers of elements in these
    intervals.
    """
    numbers: dict[tuple[int, int], int] = {}
    counts: dict[Edge, int] = {}
    corners = []
    for row, strip in enumerate(filled):
        for column, is_filled in enumerate(strip):
            if not is_filled:
                continue
            places = [(0, 0), (1, 0), (1, 1), (0, 1)]
            a, b, c, d = (
                numbers.setdefault((column + i, row + j), len(numbers)) for i, j in places
            )
            counts |= {(a, b): counts_y[column], (d, c): counts_y[column]}
            counts |= {(b, c): counts_z[row], (a, d): counts_z[row]}
            corners.append((a, b, c, d))
    points = np.array([(ys[column], zs[row]) for column, row in numbers])
    return Blocks(points, tuple(corners), counts, {})


def _circle(section: Circle, divisions: int) -> Blocks:
    across_ring = max(1, divisions // 4)
    across_core = max(1, divisions - 2 * across_ring)
    radius = section.diameter / 2.0
    half_core = _CORE_SHARE * radius / (1.0 + tan(_CORE_BULGE / 2.0))
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    sides = [(0, 1), (1, 2), (2, 3), (3, 0)]
    counts: dict[Edge, int] = {}
    centres: dict[Edge, tuple[float, float]] = {}
    corners = [(0, 1, 2, 3)]
    for a, b in sides:
        counts |= {(a, b): across_core, (a + 4, b + 4): across_core, (a, a + 4): across_ring}
        y, z = (square[a] + square[b]) / 2.0 * half_core * (1.0 - 1.0 / tan(_CORE_BULGE))
        centres |= {(a, b): (float(y), float(z)), (a + 4, b + 4): (0.0, 0.0)}
        corners.append((a + 4, b + 4, b, a))
    points = np.vstack([square * half_core, square * radius / sqrt(2.0)])
    return Blocks(points, tuple(corners), counts, centres)


def _tube(section: Tube | LaminateTube, divisions: int) -> Blocks:
    if isinstance(section, LaminateTube):
        return _tube_of_layers(section, divisions)
    across = _across(section.thickness, section.diameter, divisions)
    diameters = [section.diameter, section.inner_diameter]
    return _rings(diameters, _quarter(section.diameter, section.thickness, divisions), across)


def _quarter(diameter: float, thickness: float, divisions: int) -> int:
    """Number of elements along a quarter of a tube of the given `diameter` and `thickness` (m).

    The number is at least two, because a parabola is a poor approximation of an arc of 90°.
    """
    return max(2, _along(pi / 4.0 * (diameter - thickness), thickness, diameter, divisions))


def _rings(diameters: Sequence[float], quarter: int, across: int) -> Blocks:
    """Rings between concentric circles with these diameters (m, descending), four blocks each.

    `quarter` is the number of elements along a quarter of a ring, `across` that across a ring.
    """
    axes = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    points = np.vstack([axes * diameter / 2.0 for diameter in diameters])
    counts: dict[Edge, int] = {}
    centres: dict[Edge, tuple[float, float]] = {}
    corners = []
    for first in range(0, 4 * (len(diameters) - 1), 4):
        for a, b in pairwise([first, first + 1, first + 2, first + 3, first]):
            counts |= {(a, b): quarter, (a + 4, b + 4): quarter, (a, a + 4): across}
            centres |= {(a, b): (0.0, 0.0), (a + 4, b + 4): (0.0, 0.0)}
            corners.append((a, b, b + 4, a + 4))
    return Blocks(points, tuple(corners), counts, centres)


def _tube_of_layers(section: LaminateTube, divisions: int) -> Blocks:
    """Blocks of a tube of layers. Adjacent equal layers (a run) are meshed like one layer.

    Every ring of elements is a ring of blocks, because only nodes on edges of blocks lie on arcs,
    and the chord of a long element is farther from its arc than a layer is thick.
    """
    numbers, depths = _layer_runs(section)
    across = _across_run(divisions)
    steps = np.repeat(np.diff(depths) / across, across)
    rings = section.diameter - 2.0 * np.concatenate([[0.0], np.cumsum(steps)])
    blocks = _rings(rings.tolist(), _quarter(section.diameter, section.thickness, divisions), 1)
    return replace(blocks, regions=tuple(np.repeat(numbers, 4 * across).tolist()))


def _box_of_layers(section: LaminateBox, divisions: int) -> Blocks:
    """Blocks of a box of layers with sharp corners.

    Adjacent equal layers are meshed like one layer.
    """
    numbers, depths = _layer_runs(section)
    side, thickness, count = min(section.extent), section.thickness, len(numbers)
    lines, counts = [], []
    for size in section.extent:
        half = 0.5 * size - depths
        lines.append([*(-half).tolist(), *half[::-1].tolist()])
        along = _along(size - 2.0 * thickness, thickness, side, divisions)
        across = [_across_run(divisions)] * count
        counts.append([*across, along, *across])
    # Number of the ring, from the outside, of each strip; the hollow has the number of rings.
    rings = np.array([*range(count), count, *reversed(range(count))])
    owners = np.minimum(rings[:, None], rings)
    blocks = _grid(lines[0], lines[1], counts[0], counts[1], (owners < count).tolist())
    return replace(blocks, regions=tuple(np.array(numbers)[owners[owners < count]].tolist()))


def _across_run(divisions: int) -> int:
    """Number of elements across adjacent equal layers: one per four divisions, rounded up."""
    return ceil(divisions / 4)


def _layer_runs(section: Laminate) -> tuple[list[int], Array]:
    """Runs of adjacent layers that are equal except for their thickness, the outermost run first.

    Returns the index of one layer of each of the r runs, and the depths below the outer face (r + 1
    values, in m) at which the runs begin and end.
    """
    numbers: list[int] = []
    thicknesses: list[float] = []
    for number, layer in reversed(list(enumerate(section.layers))):
        last = section.layers[numbers[-1]] if numbers else None
        if last is not None and replace(layer, thickness=last.thickness) == last:
            thicknesses[-1] += layer.thickness
        else:
            numbers.append(number)
            thicknesses.append(layer.thickness)
    return numbers, np.concatenate([[0.0], np.cumsum(thicknesses)])
