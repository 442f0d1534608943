"""Legs as solids on geometrically similar meshes, and as beams with computed section constants.

Input: a leg of constant section and the divisions of its meshes (`leg_meshes`). Output: tip
compliances (6×6, SI, leg axes) and frequencies on each mesh, with numerical uncertainty from the
known orders of convergence.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from time import process_time

import numpy as np
from scipy.sparse import block_diag, diags_array

from fem.beams.beam import beam_leg
from fem.bodies import doubling
from fem.bodies.rooted import RootedBody
from fem.bodies.solid import clamped_leg, section_twists, solid_leg, solid_mesh
from fem.couplings.end_effects import restrained_compliance
from fem.reduction.superelement import HeldLeg, held_solid_leg
from fem.sections.composite import composite_properties, composite_rod
from fem.sections.moduli import leg_moduli, mirrored_moduli
from fem.sections.nonuniform_torsion import WarpingRod, warping_rod
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.arrays import Array, SparseMatrix
from lumped.beam_properties import BeamProperties
from lumped.errors import naming
from lumped.legs import ConstantLeg, LineLeg, SectionedLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.models.bodies import clamped_modes
from meshes.prism import hexahedra
from meshes.section.section_mesh import SectionMesh, section_mesh
from validation.responses.mode_pairing import (
    Pairs,
    SampledModes,
    centreline_samples,
    centreline_weights,
    pair_modes,
    sampled_modes,
)
from validation.solids.leg_meshes import (
    FORMAL_ORDER,
    face_mesh,
    formal_order,
    mesh_pair,
    section_counts,
    slices,
    static_slices,
)
from validation.solids.prism_legs import STATIONS, has_waves, sampled_prism_modes
from validation.uncertainty.grid_convergence import (
    Convergence,
    analyse,
    uncertainty_of,
    uncertainty_of_known_orders,
)
from validation.uncertainty.half_widths import MeshPolicy

# Relative round-off of compliances and frequencies. Smaller changes are not convergence.
ROUND_OFF = 1e-9
# Number of meshes from which on an order is observed.
GRIDS_FOR_ORDER = 4
# Additional modes, so that each beam mode has its partner among them even if the modes of solid and
# beam are in different order.
_SPARE_MODES = 6
_ENDS: tuple[Ends, Ends] = ("rigid", "free")
# Group of tasks that share the cached results of the robot's solids.
SHARED_SOLIDS = "robot.solid.modes"
# Element count of the beams with which solids are compared.
ELEMENTS = 20


@dataclass(frozen=True)
class Refinement:
    """Values (m×…) of quantities on m meshes with `divisions` across the section, coarse to fine.

    `sizes` are relative sizes of the elements if the meshes are not similar. () for similar meshes,
    where they are the inverse divisions.
    `free`: values with end faces free to warp and contract, on the same meshes. They contain all
    errors except that of singular stresses at the edges of rigid faces. None if the ends are free.
    """

    divisions: tuple[int, ...]
    values: Array
    formal_order: float = FORMAL_ORDER
    free: "Refinement | None" = None
    sizes: tuple[float, ...] = ()

    def at(self, *index: int) -> Convergence:
        """Convergence of one value, given by its index.

        Raises ValueError for fewer than four meshes.
        """
        return analyse(self._sizes, self._curve(index), self.formal_order, ROUND_OFF)

    def uncertainty(self, *index: int) -> float:
        """Numerical uncertainty of one value on the finest mesh, in its unit.

        Fewer than four meshes show no order. Then Roache's estimate for two meshes is used: for the
        change due to rigid faces with the order of their edges, for the remainder with the order of
        free ends. With four meshes and a section whose corners lower the order, the term of the
        corners and the smooth term are fitted with their known orders.
        """
        values = self._curve(index)
        if len(values) < GRIDS_FOR_ORDER:
            if self.free is not None:
                edges = Refinement(
                    self.divisions, self.values - self.free.values, self.formal_order
                )
                return self.free.uncertainty(*index) + edges.uncertainty(*index)
            ratio = float(self._sizes[-2] / self._sizes[-1])
            policy = MeshPolicy.of_order(ratio, self.formal_order)
            return policy.half_width(values[-1] - values[-2])
        if self.formal_order < FORMAL_ORDER:
            return uncertainty_of_known_orders(
                self._sizes, values, (self.formal_order, FORMAL_ORDER)
            )
        return uncertainty_of(self.at(*index))

    @property
    def _sizes(self) -> Array:
        return np.array(self.sizes) if self.sizes else 1.0 / np.array(self.divisions, dtype=float)

    def _curve(self, index: tuple[int, ...]) -> Array:
        return np.array([value[index] for value in self.values])


@dataclass(frozen=True)
class SolidModes:
    """Frequencies (m×k, Hz) on m meshes, in the order of the first k modes of the beam.

    `mac` (m×k): MAC with the modes whose shapes decide. `unknowns` (m) of the meshes. `seconds`
    (m): CPU time for mesh, factorisation and modes.
    """

    frequencies: Refinement
    mac: Array
    unknowns: tuple[int, ...]
    seconds: tuple[float, ...]


def leg_constants(leg: ConstantLeg, divisions: int) -> SectionConstants:
    """Constants of a leg's section of one material by finite elements, for any wall thickness."""
    return mesh_constants(leg, face_mesh(leg, divisions))


def mesh_constants(leg: ConstantLeg, mesh: SectionMesh) -> SectionConstants:
    """Constants of a leg's section of one material on the given section mesh."""
    material = leg.material
    return section_constants(mesh, material.nu, material.G / material.E)


@memo(64)
def computed_properties(leg: ConstantLeg, divisions: int) -> BeamProperties:
    """Timoshenko beam with section constants by finite elements, for walls of any thickness."""
    with naming(leg.name):
        return mesh_properties(leg, face_mesh(leg, divisions))


def mesh_properties(leg: ConstantLeg, mesh: SectionMesh) -> BeamProperties:
    """Timoshenko beam with section constants computed on this mesh of the leg's section."""
    if moduli := leg_moduli(leg, mesh):
        return composite_properties(mesh, moduli, helical=any(leg.section.couplings))
    return beam_properties(mesh_constants(leg, mesh), leg.material)


@memo(64)
def computed_rod(leg: ConstantLeg, divisions: int) -> WarpingRod:
    """Rod with the torsional and warping stiffness of a leg, by finite elements of its section."""
    mesh = face_mesh(leg, divisions)
    if moduli := mirrored_moduli(leg, mesh):
        return composite_rod(mesh, moduli)
    return warping_rod(mesh_constants(leg, mesh), leg.material)


@memo(32)
def face_restraint(leg: ConstantLeg, divisions: int) -> Array:
    """Change (6×6, negative semidefinite) of a beam's tip compliance due to rigid end faces."""
    mesh = face_mesh(leg, divisions)
    return restrained_compliance(mesh, leg_moduli(leg, mesh) or leg.material, leg.length)


def decay_of_warping(leg: ConstantLeg, divisions: int) -> float:
    """√(EΓ/GJ) (m): decay length of non-uniform torsion from an end (Vlasov)."""
    rod = computed_rod(leg, divisions)
    return float(np.sqrt(rod.bimoment / (rod.twist - rod.shear)))


def solid_compliances(leg: ConstantLeg, divisions: tuple[int, ...]) -> dict[Ends, Refinement]:
    """Tip compliances (m×6×6, SI, leg axes), with rigid and with free ends, on m meshes.

    They are computed by the doubling method (`fem.bodies.doubling`).

    Shapes: m meshes.
    """
    tips = [doubled_tips(leg, number, static_slices(leg, number)) for number in divisions]
    rigid, free = (np.array([tip[ends] for tip in tips]) for ends in _ENDS)
    relaxed = Refinement(divisions, free, formal_order(leg, "free"))
    restrained = Refinement(divisions, rigid, formal_order(leg, "rigid"), relaxed)
    return {"rigid": restrained, "free": relaxed}


def doubled_tips(leg: ConstantLeg, divisions: int, along: int) -> Mapping[Ends, Array]:
    """Tip compliance (6×6, SI, leg axes) of the solid leg with `along` slices, by end condition."""
    # Both end conditions are computed together, whichever one the leg specifies.
    return _doubled_tips(replace(leg, ends=None), divisions, along)


# In memory: studies of the leg, of the robot and of the models' adequacy use the same legs.
@memo(64)
def _doubled_tips(leg: ConstantLeg, divisions: int, along: int) -> dict[Ends, Array]:
    condensed = doubling.condensed_leg(leg, face_mesh(leg, divisions), along)
    return {ends: doubling.tip_compliance(condensed, ends) for ends in _ENDS}


def solid_frequencies(
    leg: ConstantLeg, divisions: tuple[int, ...], ends: Ends, count: int
) -> SolidModes:
    """First `count` frequencies of the clamped leg on each mesh, paired with the beam's modes.

    They are paired by shape. If the section does not have two axes of symmetry, the shapes are
    those of the prism's modes that correspond to the modes of the beam (`prism_legs`).
    """
    stations, lengths = centreline_samples(leg.length, STATIONS)
    root = diags_array(np.sqrt(centreline_weights(leg.timoshenko, lengths)))
    if has_waves(leg):
        beam = beam_leg(leg.timoshenko, leg.length, ELEMENTS)
        beam_modes = clamped_modes(beam, count)
        mode_frequencies, places = beam_modes.frequencies, np.arange(count)
        twists = np.asarray(beam.centreline(stations) @ beam_modes.shapes)
    else:
        mode_frequencies, twists, places = sampled_prism_modes(leg, divisions[0], ends, count)
    target = sampled_modes(mode_frequencies, root @ twists)
    frequencies, mac, unknowns, seconds = [], [], [], []
    for division_count in divisions:
        start = process_time()
        counts = section_counts(leg, division_count)
        mesh = hexahedra(leg.section, leg.length, counts, slices(leg, division_count))
        clamped = clamped_leg(solid_leg(leg, mesh), ends)
        frequencies_on_mesh, pairs = _paired_modes(
            target, clamped, root @ section_twists(mesh, stations)
        )
        frequencies.append(frequencies_on_mesh[places])
        mac.append(pairs.mac[places])
        unknowns.append(mesh.nodes.size)
        seconds.append(process_time() - start)
    refinement = Refinement(divisions, np.array(frequencies), formal_order(leg, ends))
    return SolidModes(refinement, np.array(mac), tuple(unknowns), tuple(seconds))


def line_frequencies(
    leg: LineLeg, divisions: int, ends: Ends, beam: LegMatrices, count: int
) -> Array:
    """Frequencies (count, Hz) of a leg along a line with its root clamped, by its solid.

    They are those of the modes with the shapes of the first `count` modes of `beam`, and NaN if
    there is no such mode.
    """
    stations, root = _line_samples(leg)
    solid = solid_leg(leg, solid_mesh(leg, divisions))
    twists = root @ section_twists(solid.mesh, stations)
    target = line_modes(leg, beam, count)
    frequencies, pairs = _paired_modes(target, clamped_leg(solid, ends), twists)
    return np.where(pairs.partner >= 0, frequencies, np.nan)


def line_modes(leg: LineLeg, beam: LegMatrices, count: int) -> SampledModes:
    """First `count` modes of the `beam` of a leg along a line with its root clamped."""
    stations, root = _line_samples(leg)
    modes = clamped_modes(beam, count)
    return sampled_modes(modes.frequencies, root @ (beam.centreline(stations) @ modes.shapes))


def _line_samples(leg: LineLeg) -> tuple[Array, SparseMatrix]:
    """Stations (m along the line) for samples of modes, and the root of the mass of all stations.

    The root maps the twists of the sections at the stations to samples.
    """
    stations, lengths = centreline_samples(leg.line.length, STATIONS)
    sections = leg.sections("timoshenko")
    masses = sections.at(sections.span_at(stations), stations).mass * lengths[:, None, None]
    return stations, block_diag([*np.swapaxes(np.linalg.cholesky(masses), 1, 2)], format="csr")


def _paired_modes(
    target: SampledModes, clamped: RootedBody, twists: SparseMatrix
) -> tuple[Array, Pairs]:
    """Frequencies (m, Hz) of a solid leg with the shapes of the m modes `target`, and the pairs.

    `twists` is the matrix from the solid's unknowns to the samples of a shape.
    """
    count = len(target.frequencies)
    for mode_count in count + _SPARE_MODES * np.array([1, 2, 4, 8]):
        modes = clamped.modes(int(mode_count))
        shapes = twists @ modes.shapes
        # Share of the unit modal mass in motions of whole sections, which is almost zero for local
        # modes of walls.
        seen = np.square(shapes).sum(axis=0)
        pairs = pair_modes(target, sampled_modes(modes.frequencies, shapes, seen))
        if (pairs.partner >= 0).all():
            break
    return modes.frequencies[pairs.nearest], pairs


def held_solid(
    leg: SectionedLeg, divisions: int, ends: Ends, section: int | None = None
) -> HeldLeg:
    """Solid leg with the twists of both ends fixed; `ends` is the condition of its end faces.

    `divisions` is the number of elements across the section, from which the length of the elements
    follows. `section`: another number of elements across the section, which does not affect their
    length; if None, it is `divisions`.
    """
    solid = solid_leg(leg, solid_mesh(leg, divisions, section=section))
    with naming(leg.name):
        return held_solid_leg(clamped_leg(solid, ends), solid.mesh)


def computed_beam(leg: ConstantLeg, divisions: int) -> LegMatrices:
    """Timoshenko beam elements with section constants computed on the solid's section mesh."""
    properties = mesh_properties(leg, section_mesh(leg.section, divisions))
    return beam_leg(properties, leg.length, ELEMENTS)


@dataclass(frozen=True)
class TwoMeshes:
    """Tip compliances (6×6, SI, leg axes) of a solid leg on two similar meshes, by end condition.

    Element sizes of `coarse` are `ratio` times those of `fine`. `restrained`: theoretical change of
    a Timoshenko cantilever's compliance due to rigid faces, on the finer section mesh.
    """

    coarse: Mapping[Ends, Array]
    fine: Mapping[Ends, Array]
    restrained: Array
    ratio: float


def two_meshes(leg: ConstantLeg, most: int) -> TwoMeshes:
    """Tip compliances of a leg on the meshes of `mesh_pair`, by `fem.bodies.doubling`."""
    coarse, fine = mesh_pair(leg, most)
    with naming(leg.name):
        return TwoMeshes(
            doubled_tips(leg, *coarse),
            doubled_tips(leg, *fine),
            face_restraint(leg, fine[0]),
            fine[1] / coarse[1],
        )
