"""Changes of a mechanism's beam frequencies due to waves of 3-D elasticity in the legs.

Input: reduced beam models of the legs and their section meshes. Output: the relative change of each
natural frequency. Rule: the dynamic stiffness D(ω) of a leg by waves on its section mesh
(`fem.couplings.wave_stiffness`) replaces that of the beam, so that Λ + Φᵀ(D(ω) − D_beam(ω))Φ has
the eigenvalue ω². Λ and Φ are the squared angular frequencies and the shapes of the modes with
beams; D acts on the twists of sections between pieces of the leg.

D_beam is that of the section's Saint-Venant states and inertia (`fem.couplings.wave_cantilever`),
not of the beams that gave Λ and Φ, so an error of those beams remains in the frequencies. Pieces
are so short that their frequencies with both ends fixed are far above ω: a leg vibrating between
fixed ends would not be visible in the motion of its ends. Neither a mesh along the legs nor a solid
is used.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from scipy.linalg import eigh

from fem.couplings.wave_cantilever import saint_venant_beam
from fem.couplings.wave_stiffness import PrismWaves, prism_waves
from fem.reduction.superelement import ENDS, Superelement
from fem.sections.moduli import mirrored_moduli
from lumped.arrays import Array, IntArray, dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from meshes.section.section_mesh import section_mesh
from validation.models.leg_models import filled

WAVES_SOURCE = "waves of 3-D elasticity on the section's mesh (validation.cases.leg_waves)"
NO_WAVES = (
    "waves of 3-D elasticity give no correction for this mode: walls of the legs vibrate "
    "locally at its frequency, or its wavelength is shorter than the elements"
)
# Share of a mode's strain energy below which waves without a beam counterpart are neglected.
_NEGLIGIBLE_STRAIN = 1e-4
# Relative change of a frequency in one iteration at which it has converged, and limit of
# iterations.
_CONVERGED = 1e-6
_MOST_STEPS = 20
# Largest ω over the lowest frequency of a piece with both ends fixed. Up to this ratio, beam and
# waves give the same lowest frequency of the piece.
_SHARE_OF_LOWEST = 0.5

Waves: TypeAlias = Mapping[str, tuple[PrismWaves, ...]]


def waves_of(legs: Mapping[str, ConstantLeg], divisions: Mapping[str, int]) -> Waves:
    """Waves of each leg by name, on the section mesh of its solid.

    `divisions`: those of the section mesh, by leg name. Raises InputError for a section that is not
    symmetric about both axes.
    """
    waves_by_section: dict[tuple[object, ...], tuple[PrismWaves, ...]] = {}
    waves_by_leg = {}
    for name, leg in legs.items():
        key = leg.section, leg.material, divisions[name]
        if key not in waves_by_section:
            mesh = section_mesh(leg.section, divisions[name])
            waves_by_section[key] = prism_waves(mesh, mirrored_moduli(leg, mesh) or leg.material)
        waves_by_leg[name] = waves_by_section[key]
    return waves_by_leg


def wave_changes(
    postures: Sequence[Posture],
    legs: Mapping[str, Superelement],
    beams: Mapping[str, LegMatrices],
    waves: Waves,
    *,
    elements: int,
    basis_count: int,
    count: int,
) -> Array:
    """Relative change (p×count) of the first frequencies due to waves, in p postures.

    It is computed in the space of `basis_count` modes. `beams` have `elements` elements and section
    constants from the section meshes of `waves`; `legs` are the reductions of these beams.
    NaN for a mode whose waves have no counterpart in beams, or which would need pieces shorter than
    the elements.
    """
    bodies = {name: filled(leg.matrices) for name, leg in legs.items()}
    prepared = assembly(postures[0].mechanism, bodies)
    leg_pieces = {
        name: _LegInPieces(legs[name], beams[name], elements, kinds)
        for name, kinds in waves.items()
    }
    rows = []
    for posture in postures:
        system = prepared.at(posture)
        beam_modes = modes(solved(system), basis_count)
        leg_shapes = [
            leg.reduced.recover(system.body_unknowns(name, beam_modes.shapes))
            for name, leg in leg_pieces.items()
        ]
        shapes = tuple(zip(leg_pieces.values(), leg_shapes, strict=True))
        rows.append([_change(beam_modes.frequencies, shapes, mode) for mode in range(count)])
    return np.array(rows)


@dataclass(frozen=True, eq=False)
class _LegInPieces:
    """A leg as a beam that is divided into pieces of equal length, with its waves of each kind.

    `beam` has `elements` equal elements; `reduced` is its reduction. A piece consists of whole
    elements.
    """

    reduced: Superelement
    beam: LegMatrices
    elements: int
    waves: tuple[PrismWaves, ...]

    @cached_property
    def saint_venant(self) -> tuple[PrismWaves, ...]:
        """Waves of a beam with the Saint-Venant states of the section, for each kind of wave."""
        return tuple(saint_venant_beam(kind) for kind in self.waves)

    @cached_property
    def fixed_ends_omega(self) -> float:
        """Lowest angular frequency (rad/s) of the leg with both ends fixed."""
        stiffness, mass = (
            dense(matrix)[ENDS:, ENDS:] for matrix in (self.beam.stiffness, self.beam.mass)
        )
        lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])
        return float(np.sqrt(lowest[0]))

    def pieces(self, omega: float) -> int:
        """Smallest number of equal pieces of whole elements that are short enough at ω (rad/s).

        A piece is short enough if its frequencies with both ends fixed are far above ω.
        """
        # Frequencies of axial vibration are proportional to 1/L; those of bending rise faster.
        needed = omega / (_SHARE_OF_LOWEST * self.fixed_ends_omega)
        for pieces in range(1, self.elements + 1):
            if self.elements % pieces == 0 and pieces >= needed:
                return pieces
        raise ComputationError(
            "waves of 3-D elasticity: the wavelength of the mode is shorter than a beam element, "
            "so that its frequency is not corrected"
        )

    def sections(self, pieces: int) -> IntArray:
        """Indices ((pieces + 1)×6) of the unknowns of sections: root, between pieces, tip."""
        inner = np.arange(1, pieces) * (self.elements // pieces) - 1
        first = np.concatenate([[0], ENDS + 6 * inner, [6]])
        return np.asarray(first[:, None] + np.arange(6))


def _change(frequencies: Array, legs: Sequence[tuple[_LegInPieces, Array]], mode: int) -> float:
    """Relative change of one mode's frequency due to waves in the legs.

    `frequencies` (Hz): those of all modes with beams. `legs`: each leg with its mode shapes in
    these modes. `mode`: index of the mode.
    """
    squares = np.square(2.0 * np.pi * frequencies)
    beam_omega = omega = float(np.sqrt(squares[mode]))
    try:
        for _ in range(_MOST_STEPS):
            before = omega
            differences = (_difference(leg, shapes, mode, omega) for leg, shapes in legs)
            value = float(np.linalg.eigvalsh(np.diag(squares) + sum(differences))[mode])
            if value <= 0.0:
                break
            omega = float(np.sqrt(value))
            if abs(omega - before) <= _CONVERGED * beam_omega:
                return omega / beam_omega - 1.0
    except ComputationError:
        pass
    return float("nan")


def _difference(leg: _LegInPieces, shapes: Array, mode: int, omega: float) -> Array:
    """Change Φᵀ(D − D_beam)Φ (m×m) of the modal stiffness at ω (rad/s) due to waves in one leg.

    D and D_beam: dynamic stiffness of the leg by waves and by beams. Φ: m mode `shapes` of the leg.
    Raises ComputationError if `mode` strains the leg in a way for which there are no waves.
    """
    pieces = leg.pieces(omega)
    sections = leg.sections(pieces).ravel()
    length = leg.beam.length / pieces
    difference = np.zeros((shapes.shape[1],) * 2)
    for kind, beam in zip(leg.waves, leg.saint_venant, strict=True):
        try:
            piece_difference = kind.stiffness(length, omega) - beam.stiffness(length, omega)
        except ComputationError:
            shape = shapes[:, mode]
            strain_energy = shape @ (leg.beam.parts[kind.fields.name] @ shape)
            if strain_energy > _NEGLIGIBLE_STRAIN * omega**2:
                raise
            continue
        count = len(kind.fields.twists)
        unknowns = (6 * np.arange(pieces + 1)[:, None] + kind.fields.twists).ravel()
        assembled = np.zeros((len(unknowns),) * 2)
        for first in range(0, pieces * count, count):
            ends = slice(first, first + len(kind.ends))
            assembled[ends, ends] += piece_difference
        twists = shapes[sections[unknowns]]
        difference += twists.T @ assembled @ twists
    return difference
