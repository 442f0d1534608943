"""Von Mises stresses in the sections of legs, by beam theory on a mesh of each section.

Input: a leg and its section forces along its length. Output: `MemberStress`, the largest stress and
its position. Rule: stresses are normal and shear stresses of Saint-Venant's theory; the half-width
of the uncertainty of a stress is the change from a coarse to a fine section mesh, scaled by the
order of convergence, plus the effect of the half-widths of the forces. In a taper each station has
its own section, which is sheared by the forces Qy + λy Mz and Qz − λz My, where λ is the rate of
change of the lever arm (`lumped.line_sections`). At a step both sections are judged.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fem.sections.stresses import SectionStresses, section_stresses
from lumped.arrays import Array
from lumped.legs import ConstantLeg, LineLeg, SectionedLeg, Span
from lumped.line_sections import TOGETHER
from lumped.mechanism.body import Shape
from lumped.sections import Section
from lumped.system.members import MemberForces
from meshes.section.section_mesh import section_mesh
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

# Elements across the smaller side of a section on the coarse and on the fine mesh. Orders of
# convergence of stresses: that of gradients of quadratic elements, and a lower one for sections
# with re-entrant corners.
_DIVISIONS = (4, 8)
_SMOOTH, _STEEP = 2.0, 1.0
_WITHOUT_MESH = "its section has no mesh of one material"


@dataclass(frozen=True, eq=False)
class MemberStress:
    """Largest von Mises stress of a leg (Pa) with its `half_width` (Pa) and its position.

    It acts at the distance `station` (m) from the root in the point (y, z) of the section (m, from
    its centroid). There, `normal` is the normal stress σxx and `shear` the shear stress (Pa).
    `along` (s, Pa): largest stress in each of the s sections at `stations` (s, m). The half-width
    covers the mesh of the section and the half-widths of the section forces.
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


def reason_without_stress(shape: Shape) -> str:
    """Reason why no stresses are computed for a leg. "" if they are."""
    if not isinstance(shape, ConstantLeg | LineLeg):
        return "its section is not known"
    sections = [shape.section] if isinstance(shape, ConstantLeg) else [s for _, s in shape.stations]
    uniform = all(section.has_outline and section.is_uniform for section in sections)
    return "" if uniform else _WITHOUT_MESH


def member_stress(leg: SectionedLeg, member: MemberForces) -> MemberStress | None:
    """Largest von Mises stress of a straight leg.

    None if its section forces are statically indeterminate.
    """
    if not np.isfinite(member.forces).all():
        return None
    along = np.zeros(len(member.stations))
    largest, decisive = -1.0, None
    for row, section, forces in _loaded_sections(leg, member):
        fine = section_stresses(section_mesh(section, _DIVISIONS[1]), leg.material)
        stresses = np.where(fine.regular, fine.von_mises(forces[None])[0], 0.0)
        node = int(np.argmax(stresses))
        along[row] = max(along[row], stresses[node])
        if stresses[node] > largest:
            largest, decisive = float(stresses[node]), (row, node, section, forces, fine)
    if decisive is None:
        raise TypeError(f"{member.leg}: section forces without stations")
    row, node, section, forces, fine = decisive
    coarse = section_stresses(section_mesh(section, _DIVISIONS[0]), leg.material)
    change = np.array(abs(largest - _largest(coarse, forces[None])))
    policy = MeshPolicy.of_order(2.0, _SMOOTH if fine.regular.all() else _STEEP)
    # The von Mises stress is a norm: it changes by at most that of the stresses due to the change
    # of the forces.
    of_forces = fine.von_mises(np.diag(member.half_width))[:, fine.regular].sum(axis=0).max()
    y, z = fine.mesh.nodes[node]
    return MemberStress(
        member.leg,
        largest,
        float(mesh_half_widths([change], policy) + of_forces),
        float(member.stations[row]),
        (float(y), float(z)),
        float(fine.normal[node] @ forces),
        float(np.linalg.norm(fine.shear[:, node] @ forces)),
        member.stations,
        along,
    )


def _loaded_sections(
    leg: SectionedLeg, member: MemberForces
) -> Iterator[tuple[int, Section, Array]]:
    """Yield the index of a station, a section there, and the forces (6) that stress it.

    Of a taper, the shear forces are replaced by Qy + λy Mz and Qz − λz My, see the module.
    """
    if isinstance(leg, ConstantLeg):
        yield from ((row, leg.section, forces) for row, forces in enumerate(member.forces))
        return
    slack = TOGETHER * leg.line.length
    for row, (station, forces) in enumerate(zip(member.stations, member.forces, strict=True)):
        for span in leg.spans:
            if span.start - slack <= station <= span.end + slack:
                yield row, *_in_span(span, float(station), forces)


def _in_span(span: Span, station: float, forces: Array) -> tuple[Section, Array]:
    share = float(np.clip((station - span.start) / (span.end - span.start), 0.0, 1.0))
    rate_y, rate_z = span.taper_rates(np.array([share]))[0]
    shearing = forces.copy()
    shearing[1] += rate_y * forces[5]
    shearing[2] -= rate_z * forces[4]
    return span.section(share), shearing


def _largest(stresses: SectionStresses, forces: Array) -> float:
    return float(stresses.von_mises(forces)[:, stresses.regular].max())
