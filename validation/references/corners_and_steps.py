"""Corners and steps of legs along a line as solids: compliance that beam theory lacks.

Input: a leg along a line with corners or steps, and the divisions of its section mesh. Output:
changes of its tip compliance and of its frequencies as a beam, by cause. Rule: beam theory
continues both pieces to the corner of the line, and both sections to a step. In the solid, stresses
differ from those of beams over about the height of the section (Saint-Venant). The difference is
therefore computed in a solid of the corner or step alone: two stubs along the line, curved if the
line is, with the sections of the leg there, loaded at their ends as in Saint-Venant's theory, less
the beam of both stubs, and less what their flanges and converging walls do in torsion, a cause of
its own. The result is a 6×6 compliance in the section there. It depends on the line and the
sections there alone, so that an error of a model of the leg stays unexplained. Distortion of walls
reaches beyond the stubs: the change from stubs of half the length is a half-width, or the whole
result if there is no room for long stubs. Nothing is computed for a corner or step that is nearer
than a stub to the next one or to an end of the leg: the difference is then flagged.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fem.beams.line_beam import line_beam
from fem.beams.tapered_flanges import flange_work
from lumped.arrays import Array
from lumped.centre_line import CentreLine, LinePiece, point_of
from lumped.legs import LineLeg
from lumped.line_sections import TOGETHER, LineSections
from lumped.memo import memo
from lumped.screws import shift, turn
from lumped.sections import Circle, Rectangle, Section
from validation.models.leg_models import clamped_solid
from validation.responses.mode_pairing import pair_modes
from validation.solids.line_beams import computed_along, computed_tip, wall_distortion
from validation.solids.solid_legs import ELEMENTS, line_modes

# Causes of a difference between beam and solid.
CORNERS = "corners of the line"
STEPS = "steps of the section"
SOURCE = "solid of each corner or step with stubs of the line, less their beam"
# Length of a stub over the largest side of its sections. In a solid section, fields decay over the
# first length to e^-8. Sections with walls distort, which decays more slowly: in frames of square
# tubes with walls of 1/15 and 1/30 of their side, the first length leaves 1.6 % and 10 % of the
# displacement across the plane of the frame, the second one 0.3 % and 0.9 %. It is used if there is
# room for it, otherwise a stub is as long as the room.
_STUB, _WALLED_STUB = 2.0, 4.0
# Number of modes beyond the requested ones among which partners of a beam's modes are searched.
_SPARE_MODES = 4


@dataclass(frozen=True, eq=False)
class Jump:
    """Corner or step at `position` (m along the line) and `point` (3, in m, leg axes).

    `cause` is `CORNERS` or `STEPS`. `reaches` (m) are distances over which beams spread it, in
    order of preference. `compliance` (6×6, SI, leg axes) is the relative twist of both sides, less
    that of beams, under a wrench that the section there transmits. `beyond_stubs` (6×6) bounds what
    the length of the stubs leaves out. `first_moment` (3, in kg m, leg axes) is the first moment of
    the solid's mass about the point, less that of the line.
    """

    cause: str
    position: float
    point: Array
    reaches: tuple[float, ...]
    compliance: Array
    beyond_stubs: Array
    first_moment: Array


@dataclass(frozen=True, eq=False)
class _Place:
    """Axes (3×3, columns, leg axes) and sections before and after a corner or step."""

    position: float
    axes: tuple[Array, Array]
    sections: tuple[Section, Section]
    cause: str


def has_jumps(leg: object) -> bool:
    """True for a leg along a line that has corners or steps."""
    return isinstance(leg, LineLeg) and bool(leg.line.turns or leg.steps)


@memo(16)
def jumps(leg: LineLeg, divisions: int) -> list[Jump]:
    """Corners and steps of a leg with their compliances, on the mesh of its solid.

    `divisions` is the number of elements across the section.
    """
    places = _places(leg)
    ends = [0.0, *(place.position for place in places), leg.line.length]
    rooms = [min(b - a, c - b) for (a, b), (_, c) in pairwise(pairwise(ends))]
    described = []
    for place, room in zip(places, rooms, strict=True):
        side = max(max(section.extent) for section in place.sections)
        stub = _STUB * side
        if room < stub * (1.0 - TOGETHER):
            continue
        point, _ = leg.line.frames(np.array([place.position]))
        compliance = _lacking(leg, place, stub, divisions)
        beyond_stubs = np.zeros((6, 6))
        reaches: tuple[float, ...] = 0.5 * stub, stub
        if not all(isinstance(section, Rectangle | Circle) for section in place.sections):
            stub = min(room, _WALLED_STUB * side)
            reaches = (stub,)
            short, compliance = compliance, _lacking(leg, place, stub, divisions)
            # Distortion at least halves over two heights.
            is_long = stub >= _WALLED_STUB * side * (1.0 - TOGETHER)
            beyond_stubs = compliance - short if is_long else compliance
        moment = _first_moment(leg, place)
        described.append(
            Jump(place.cause, place.position, point[0], reaches, compliance, beyond_stubs, moment)
        )
    return described


def _lacking(leg: LineLeg, place: _Place, length: float, divisions: int) -> Array:
    """Compliance (6×6, SI, leg axes) that a beam lacks at a corner or step, by stubs of `length`.

    It is the relative twist of both sides under a wrench that the section there transmits.
    `divisions` is the number of elements across the section.
    """
    stub, axes = _stub(leg, place, length)
    difference = clamped_solid(stub, divisions, "free").compliance - computed_tip(stub, divisions)
    difference[3, 3] -= flange_work(stub, np.ones_like) + wall_distortion(stub, divisions)
    middle, _ = stub.line.frames(np.array([length]))
    to_jump = turn(axes) @ shift(middle[0] - [stub.length, 0.0, 0.0])
    return np.asarray(to_jump @ difference @ to_jump.T)


def _places(leg: LineLeg) -> list[_Place]:
    """Corners and steps of a leg in order from its root to its tip."""
    line, slack = leg.line, TOGETHER * leg.line.length
    steps = {position: (first, second) for position, first, second in leg.steps}
    places = []
    for number in line.turns:
        corner = float(line.ends[number])
        at_corner = next((x for x in steps if abs(x - corner) <= slack), None)
        section = leg.section_at(corner)
        sections = (section, section) if at_corner is None else steps.pop(at_corner)
        places.append(_Place(corner, line.corner_axes(number), sections, CORNERS))
    for position, sections in steps.items():
        axes = line.frames(np.array([position]))[1][0]
        places.append(_Place(position, (axes, axes), sections, STEPS))
    return sorted(places, key=lambda place: place.position)


def _first_moment(leg: LineLeg, place: _Place) -> Array:
    """First moment of mass (3, in kg m, leg axes) about a corner. Zero for a step.

    Fibres on the outside of a corner are longer than the line, those on the inside shorter, up to
    the plane of the mitre. Only this difference is counted.
    """
    normal = place.axes[0][:, 0] + place.axes[1][:, 0]
    moment = np.zeros(3)
    for sign, axes, section in zip((1.0, -1.0), place.axes, place.sections, strict=True):
        inertia_y, inertia_z, product = section.inertia_moments
        slopes = -(normal @ axes)[1:] / (normal @ axes)[0]
        across = np.array([[inertia_z, product], [product, inertia_y]]) @ slopes
        moment += sign * axes @ np.array([0.5 * slopes @ across, *across])
    return leg.material.rho * moment


def _stub(leg: LineLeg, place: _Place, length: float) -> tuple[LineLeg, Array]:
    """Corner or step of a leg between stubs of `length` (m), and the axes (3×3) of this stub leg.

    The columns of the axes are in the axes of the leg.
    """
    pieces = leg.line.part(place.position - length, place.position + length)
    root, tip = np.array(pieces[0].start), np.array(pieces[-1].end)
    chord = float(np.linalg.norm(tip - root))
    along = (tip - root) / chord
    before, after = (axes[:, 0] for axes in place.axes)
    normal = np.cross(before, after) if place.cause == CORNERS else place.axes[0][:, 2]
    across = np.cross(normal, along)
    across /= np.linalg.norm(across)
    axes = np.column_stack([along, across, np.cross(along, across)])
    line = CentreLine(
        tuple(_in_axes(piece, root, axes) for piece in pieces),
        point_of(np.array(leg.line.up) @ axes),
    )
    # A step at the end of a stub does not belong to it.
    inside = length - TOGETHER * leg.line.length
    ends = [leg.section_at(place.position + way) for way in (-length, inside)]
    first, second = place.sections
    stations = ((0.0, ends[0]), (length, first), (length, second), (line.length, ends[1]))
    return LineLeg(line, stations, leg.material, "free", leg.name), axes


def _in_axes(piece: LinePiece, origin: Array, axes: Array) -> LinePiece:
    """Piece of a line in axes (3×3, columns) about an `origin` (3, in m)."""
    start, end = (point_of((np.array(point) - origin) @ axes) for point in (piece.start, piece.end))
    through = None if piece.through is None else point_of((np.array(piece.through) - origin) @ axes)
    return LinePiece(start, end, through)


def tip_changes(leg: LineLeg, divisions: int) -> dict[str, Array]:
    """Change (6×6, SI) of the tip compliance of a leg due to its corners and due to its steps.

    The keys are `CORNERS` and `STEPS`, if the leg has them. `divisions` is the number of elements
    across the section.
    """
    changes: dict[str, Array] = {}
    for jump in jumps(leg, divisions):
        change = _at_tip(leg, jump, jump.compliance)
        changes[jump.cause] = changes.get(jump.cause, np.zeros((6, 6))) + change
    return changes


def sections_with_jumps(sections: LineSections, leg: LineLeg, divisions: int) -> LineSections:
    """Sections along a leg with the compliance and the mass of its corners and steps.

    Both are spread over the neighbourhood of each corner or step: in solid sections over half of
    the stubs, in sections with walls, whose distortion reaches further, over the stubs. `divisions`
    is the number of elements across the section.
    """
    return _with_jumps(sections, jumps(leg, divisions))


def _with_jumps(sections: LineSections, added: Iterable[Jump]) -> LineSections:
    for jump in added:
        sections = sections.changed(jump.position, jump.reaches, jump.compliance, jump.first_moment)
    return sections


def tip_half_widths(leg: LineLeg, divisions: int) -> Array:
    """Half-widths (6, SI) of the diagonal of all `tip_changes`, due to the length of the stubs."""
    left_out = [_at_tip(leg, jump, jump.beyond_stubs) for jump in jumps(leg, divisions)]
    return np.asarray(sum((np.abs(np.diag(change)) for change in left_out), np.zeros(6)))


def _at_tip(leg: LineLeg, jump: Jump, compliance: Array) -> Array:
    """Change (6×6, SI) of the tip compliance of a leg due to a `compliance` (6×6) at a jump."""
    to_tip = shift(np.array([leg.length, 0.0, 0.0]) - jump.point)
    return np.asarray(to_tip @ compliance @ to_tip.T)


def frequency_changes(leg: LineLeg, divisions: int, count: int) -> tuple[dict[str, Array], Array]:
    """Relative changes (`count`) of a clamped leg's frequencies due to its corners and its steps.

    They are the changes of a beam's modes if first the corners and then the steps get their
    compliance and their mass. Modes are paired by shape. The keys are those of `tip_changes`. The
    second result is the half-width (`count`) of the sum of all changes, due to the length of the
    stubs. `divisions` is the number of elements across the section.
    """
    found = jumps(leg, divisions)
    if not found:
        return {}, np.zeros(count)
    sections = computed_along(leg, divisions)
    beam_modes = line_modes(leg, line_beam(sections, ELEMENTS), count)

    def frequencies(added: Sequence[Jump]) -> Array:
        beam = line_beam(_with_jumps(sections, added), ELEMENTS)
        modes = line_modes(leg, beam, count + _SPARE_MODES)
        return np.asarray(modes.frequencies[pair_modes(beam_modes, modes).nearest])

    added: list[Jump] = []
    changes: dict[str, Array] = {}
    before = beam_modes.frequencies
    for cause in dict.fromkeys(jump.cause for jump in found):
        added += [jump for jump in found if jump.cause == cause]
        after = frequencies(added)
        changes[cause] = (after - before) / beam_modes.frequencies
        before = after
    if not any(jump.beyond_stubs.any() for jump in found):
        return changes, np.zeros(count)
    short = [replace(jump, compliance=jump.compliance - jump.beyond_stubs) for jump in found]
    return changes, np.abs(frequencies(short) - before) / beam_modes.frequencies
