"""Von Mises stresses in the sections of legs, by beam theory on a mesh of each section.

Input: a leg and its section forces along its length. Output: `MemberStress`, the largest stress and
its position. Rule: stresses are normal and shear stresses of Saint-Venant's theory; the half-width
of the uncertainty of a stress is the change from a coarse to a fine section mesh, scaled by the
order of convergence, plus the effect of the half-widths of the forces. In a taper each station has
its own section, which is sheared by the forces Qy + λy Mz and Qz − λz My, where λ is the rate of
change of the lever arm (`lumped.line_sections`). The half-widths of these forces contain |λ| times
those of the moments.

On an arc normal stresses are those of Winkler's curved bar, and shear stresses are those of a
straight leg. The half-width covers a relative change of shear stresses by the height h of the
section over the radius R, of which Göhner's series for a round bar in torsion has 5/8. It covers
the normal stresses that Winkler's theory lacks: those of first order in h/R (`arc_stresses`), over
(1 − h/2R)², and in bending (h/R)²/60 of the stress, over 1 − (h/2R)². For narrow rectangles these
terms are the leading ones of Golovin's solution (S. P. Timoshenko, J. N. Goodier, Theory of
Elasticity, ch. 4), and their divisors are chosen such that no error is larger up to outer radii of
ten inner ones. Walls of hollow
sections and flanges on an arc of radius R are pressed across by their normal stress σ. They bend,
with stresses of at most 3σc²/Rt (flanges of thickness t that project by c, Bleich). This is added
to the half-width. Where it exceeds σ, as in elbows of pipes, stresses are not known.

At a step, a corner and where an arc begins, the sections on both sides are judged. In a taper and
on an arc the largest stress is also searched for between the decisive station and its neighbours.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.optimize

from fem.sections.layer_stresses import LayerStresses, layer_stresses
from fem.sections.moduli import part_materials, part_moduli
from fem.sections.part_stresses import PartStresses, part_stresses
from fem.sections.stresses import SectionStresses, arc_stresses, curved_stresses
from lumped.arrays import Array
from lumped.centre_line import CentreLine
from lumped.legs import ConstantLeg, LineLeg, SectionedLeg, Span, line_length
from lumped.line_sections import TOGETHER
from lumped.mechanism.body import Shape
from lumped.memo import memo
from lumped.screws import rotation_vector
from lumped.sections import Composite, HollowRectangle, Laminate, Polygon, Section, Tube
from lumped.sections.polygons import wall_thickness
from lumped.sections.shapes import WalledProfile
from lumped.system.members import MemberForces
from meshes.section.section_mesh import section_mesh
from validation.uncertainty.half_widths import MeshPolicy

# Elements across the smaller side of a section on the coarse and on the fine mesh. Orders of
# convergence of stresses: that of gradients of quadratic elements, and a lower one for sections
# with re-entrant corners.
_DIVISIONS = (4, 8)
_SMOOTH, _STEEP = 2.0, 1.0
# Search between two stations, in fractions of their distance: point at which the stress must rise
# for the search to start, and tolerance of the point found. Stresses are off by its square.
_PROBE, _TOLERANCE = 0.01, 1e-3
# Error of Winkler's stress in bending, over the square of the height over the radius.
_SECOND_ORDER = 1.0 / 60.0
_WITHOUT_MESH = "the section of the leg has no mesh of isotropic materials"


@dataclass(frozen=True, eq=False)
class MemberStress:
    """Largest von Mises stress of a leg (Pa) with its `half_width` (Pa) and its position.

    The stress acts at the distance `station` (m) from the root along the line, in the `point`
    (y, z) of the section (m, from its centroid). In a taper and on an arc this distance may lie
    between two of the `stations`.
    `normal` is the normal stress σxx and `shear` the shear stress (Pa) at the point. `along` (s,
    Pa): largest stress in each of the s sections at `stations` (s, m). The half-width covers the
    mesh of the section and the half-widths of the section forces. `parts` are the largest stresses
    (Pa) in the parts of a composite section, in the section with the largest of all. () if the
    section has one material.
    """

    leg: str
    largest: float
    half_width: float
    station: float
    point: tuple[float, float]
    normal: float
    shear: float
    stations: Array
    along: Array
    parts: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class LaminateStress:
    """Smallest and largest stresses (Pa) of the layers of a leg's wall, by laminate theory.

    Rows are the layers from the inside, with their `angles` (degrees). Columns are the stresses
    along the fibres, across them, and in shear. `smallest` and `largest` (L×3) are extremes over
    the leg. `half_widths` (L×3) cover the error of laminate theory and the half-widths of the
    section forces. Array sizes: L layers.
    """

    leg: str
    angles: tuple[float, ...]
    smallest: Array
    largest: Array
    half_widths: Array


def laminate_stress(leg: ConstantLeg, member: MemberForces) -> LaminateStress | None:
    """Smallest and largest stresses of the layers of a leg.

    None if the leg has no layers, or if its section forces are statically indeterminate.
    """
    section = leg.section
    if not isinstance(section, Laminate) or not np.isfinite(member.forces).all():
        return None
    layers = range(len(section.layers))

    def by_layer(values: Array, stresses: LayerStresses) -> Array:
        return np.array([values[stresses.layers == layer].max(axis=0) for layer in layers])

    along = [layer_stresses(section, leg.timoshenko, forces) for forces in member.forces]
    of_forces = [
        layer_stresses(section, leg.timoshenko, width) for width in np.diag(member.half_width)
    ]
    errors = np.max([by_layer(loaded.half_widths, loaded) for loaded in along], axis=0)
    errors += np.sum([by_layer(np.abs(loaded.stresses), loaded) for loaded in of_forces], axis=0)
    return LaminateStress(
        member.leg,
        tuple(layer.angle for layer in section.layers),
        -np.max([by_layer(-loaded.stresses, loaded) for loaded in along], axis=0),
        np.max([by_layer(loaded.stresses, loaded) for loaded in along], axis=0),
        errors,
    )


def reason_without_stress(shape: Shape) -> str:
    """Reason why no stresses are computed for a leg. "" if stresses are computed."""
    if not isinstance(shape, ConstantLeg | LineLeg):
        return "the section of the leg is not known"
    sections = [shape.section] if isinstance(shape, ConstantLeg) else [s for _, s in shape.stations]
    isotropic = all(
        isinstance(section, Composite) or (section.has_outline and section.is_uniform)
        for section in sections
    )
    return "" if isotropic else _WITHOUT_MESH


def member_stress(leg: SectionedLeg, member: MemberForces) -> MemberStress | None:
    """Largest von Mises stress of a leg.

    None if its section forces are statically indeterminate.
    """
    if not np.isfinite(member.forces).all():
        return None
    along = np.zeros(len(member.stations))
    largest, decisive = -1.0, None
    for row, loaded in _loaded_sections(leg, member):
        stress = loaded.largest_stress(leg)
        along[row] = max(along[row], stress)
        if stress > largest:
            largest, decisive = stress, (row, loaded)
    if decisive is None:
        raise TypeError(f"{member.leg}: no station with section forces")
    row, loaded = decisive
    station = float(member.stations[row])
    for peak, loaded_there in _peaks_beside(leg, member, row):
        stress = loaded_there.largest_stress(leg)
        if stress > largest:
            largest, station, loaded = stress, peak, loaded_there
    forces = loaded.forces
    fine = loaded.stresses(leg, _DIVISIONS[1])
    node = int(np.argmax(np.where(fine.regular, fine.von_mises(forces[None])[0], 0.0)))
    coarse = loaded.stresses(leg, _DIVISIONS[0])
    policy = MeshPolicy.of_order(2.0, _SMOOTH if fine.regular.all() else _STEEP)
    # The von Mises stress is a norm: it changes by at most that of the stresses due to the change
    # of the forces.
    of_forces = fine.von_mises(np.diag(loaded.half_width))[:, fine.regular].sum(axis=0).max()
    of_curvature = _curvature_half_width(leg, loaded, fine) if any(loaded.curvature) else 0.0
    y, z = fine.points[node]
    parts = fine.largest_by_part(forces) if isinstance(fine, PartStresses) else np.zeros(0)
    return MemberStress(
        member.leg,
        largest,
        policy.half_width(largest - _largest(coarse, forces)) + float(of_forces) + of_curvature,
        station,
        (float(y), float(z)),
        float(fine.normal[node] @ forces),
        float(np.linalg.norm(fine.shear[:, node] @ forces)),
        member.stations,
        along,
        tuple(parts.tolist()),
    )


def _curvature_half_width(
    leg: SectionedLeg, loaded: "_LoadedSection", stresses: SectionStresses
) -> float:
    """Half-width (Pa) of the largest von Mises stress of a section on an arc, see the module.

    `stresses` are those of the loaded section.
    """
    ratio = float(np.ptp(stresses.points @ loaded.curvature))
    forces = loaded.forces
    normal = np.abs(stresses.normal @ forces)
    shear = np.linalg.norm(stresses.shear @ forces, axis=0)
    mesh = section_mesh(loaded.section, _DIVISIONS[1])
    lacking = arc_stresses(mesh, leg.material, loaded.curvature, line_length(leg)) @ np.abs(forces)
    lacking /= (1.0 - 0.5 * ratio) ** 2
    bending = np.abs(stresses.normal[:, 4:] @ forces[4:])
    lacking += _SECOND_ORDER * ratio**2 / (1.0 - 0.25 * ratio**2) * bending
    widened = np.hypot(normal + lacking, np.sqrt(3.0) * (1.0 + ratio) * shear)
    bent_walls = 3.0 * _wall_ratio(loaded.section) * float(np.linalg.norm(loaded.curvature))
    change = widened[stresses.regular].max() - _largest(stresses, forces)
    return float(change + bent_walls * normal.max())


def _wall_ratio(section: Section) -> float:
    """Square of half the larger side of a section, over its wall thickness (m).

    Zero for a section without walls.
    """
    half = 0.5 * max(section.extent)
    if isinstance(section, HollowRectangle | Tube):
        return half**2 / section.thickness
    if isinstance(section, WalledProfile):
        return half**2 / min(section.flange, section.web)
    if isinstance(section, Polygon):
        return half**2 / wall_thickness(section.loops)
    return 0.0


@dataclass(frozen=True, eq=False)
class _LoadedSection:
    """A section, and the forces (6: N, Qy, Qz, T, My, Mz) that stress it, with their half-widths.

    In a taper, the shear forces are replaced by Qy + λy Mz and Qz − λz My, see the module.
    `curvature` (1/m) are the components of the line's curvature along the section's axes y and z.
    """

    section: Section
    forces: Array
    half_width: Array
    curvature: tuple[float, float] = (0.0, 0.0)

    def largest_stress(self, leg: SectionedLeg) -> float:
        """Largest von Mises stress (Pa) in the section of `leg`."""
        return _largest(self.stresses(leg, _DIVISIONS[1]), self.forces)

    def stresses(self, leg: SectionedLeg, divisions: int) -> SectionStresses:
        """Stresses under unit section forces on a mesh with `divisions` across the section."""
        if isinstance(leg, ConstantLeg) and isinstance(self.section, Composite):
            return _composite_stresses(leg, divisions)
        mesh = section_mesh(self.section, divisions)
        return curved_stresses(mesh, leg.material, self.curvature)


def _loaded_sections(
    leg: SectionedLeg, member: MemberForces
) -> Iterator[tuple[int, _LoadedSection]]:
    """Yield the index of a station, and the loaded section there.

    There are two of them at a step and where the curvature jumps. Each side of a corner has a
    station of its own.
    """
    width = member.half_width
    if isinstance(leg, ConstantLeg):
        for row, forces in enumerate(member.forces):
            yield row, _LoadedSection(leg.section, forces, width)
        return
    slack = TOGETHER * leg.line.length
    middles = [0.5 * (span.start + span.end) for span in leg.spans]
    runs_of_spans = np.searchsorted(leg.line.corners, middles)
    for row, (station, forces) in enumerate(zip(member.stations, member.forces, strict=True)):
        for span, run in zip(leg.spans, runs_of_spans, strict=True):
            inside = span.start - slack <= station <= span.end + slack
            if inside and run == member.runs[row]:
                yield row, _in_span(leg.line, span, float(station), forces, width)


def _in_span(
    line: CentreLine, span: Span, station: float, forces: Array, half_width: Array
) -> _LoadedSection:
    piece = line.piece_at(np.array([0.5 * (span.start + span.end)]))
    _, axes = line.frames(np.array([station]), piece)
    curvature_y, curvature_z = line.curvatures(axes, piece)[0].tolist()
    share = float(np.clip((station - span.start) / (span.end - span.start), 0.0, 1.0))
    rate_y, rate_z = span.taper_rates(np.array([share]))[0]
    shearing = np.eye(6)
    shearing[1, 5], shearing[2, 4] = rate_y, -rate_z
    widths = np.abs(shearing) @ half_width
    curvature = curvature_y, curvature_z
    return _LoadedSection(span.section(share), shearing @ forces, widths, curvature)


def _peaks_beside(
    leg: SectionedLeg, member: MemberForces, row: int
) -> Iterator[tuple[float, _LoadedSection]]:
    """Yield peaks of the stress in tapers and arcs between the station `row` and its neighbours.

    A peak is given by its station (m) and the loaded section there.
    """
    if isinstance(leg, ConstantLeg):
        return
    line = leg.line
    start = float(member.stations[row])
    for neighbour in (row - 1, row + 1):
        if not 0 <= neighbour < len(member.stations) or member.runs[neighbour] != member.runs[row]:
            continue
        pair = sorted((row, neighbour))
        low, high = member.stations[pair].tolist()
        span = next((s for s in leg.spans if s.start <= (low + high) / 2.0 <= s.end), None)
        if span is None:
            continue
        (piece,) = line.piece_at(np.array([0.5 * (low + high)]))
        if span.first == span.last and not line.pieces[piece].turning.any():
            continue
        ends, forces = member.stations[pair], member.forces[pair]
        at = partial(_between, line, span, ends, forces, member.half_width)

        def stress(station: float, at: Callable[[float], _LoadedSection] = at) -> float:
            return at(station).largest_stress(leg)

        if stress(start + _PROBE * (float(member.stations[neighbour]) - start)) > stress(start):
            peak = scipy.optimize.minimize_scalar(
                lambda station, stress=stress: -stress(station),
                bounds=(low, high),
                method="bounded",
                options={"xatol": _TOLERANCE * (high - low)},
            )
            yield float(peak.x), at(float(peak.x))


def _between(
    line: CentreLine, span: Span, ends: Array, forces: Array, half_width: Array, station: float
) -> _LoadedSection:
    """Loaded section of `span` at `station`.

    The forces are interpolated between the rows of `forces` (2×6) at the two stations `ends`. Parts
    of their derivatives are taken as linear between the ends: −κ × n of the force n, and
    −κ × m − t × n of the moment m, with the rate of rotation κ of the section's axes along the line
    and the tangent t.
    """
    length = ends[1] - ends[0]
    share = (station - ends[0]) / length
    there = (1.0 - share) * forces[0] + share * forces[1]
    pieces = line.piece_at(np.repeat(ends.mean(), 2))
    _, (first, last) = line.frames(ends, pieces)
    turning = rotation_vector(first.T @ last) / length
    change = forces[1] - forces[0]
    rates = -np.cross(turning, change.reshape(2, 3))
    rates[1] -= np.cross([1.0, 0.0, 0.0], change[:3])
    there -= 0.5 * length * share * (1.0 - share) * rates.ravel()
    return _in_span(line, span, station, there, half_width)


@memo(16)
def _composite_stresses(leg: ConstantLeg, divisions: int) -> PartStresses:
    mesh = section_mesh(leg.section, divisions)
    return part_stresses(mesh, part_moduli(mesh, part_materials(leg)))


def _largest(stresses: SectionStresses, forces: Array) -> float:
    return float(stresses.von_mises(forces[None])[0, stresses.regular].max())
