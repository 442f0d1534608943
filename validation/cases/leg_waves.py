"""What waves of 3-D elasticity in the legs make of a mechanism's frequencies by beams.

The legs' dynamic stiffness by the waves on their sections' meshes (`fem.couplings.wave_stiffness`)
takes the place of that of beams: Λ + Φᵀ(D(ω) − D_beam(ω))Φ has the eigenvalue ω², with D on the
twists of the sections between a leg's pieces and Λ, Φ the modes by beams. D_beam is that of the
section's own Saint-Venant states and inertia (`fem.couplings.wave_cantilever`), not of the beams
that gave Λ and Φ: what is wrong with those stays in the frequencies. Pieces are so short that
with both ends held they would swing far above ω: a leg that swings between ends at rest shows at
its ends nothing of what it does. No mesh along the legs, and no solid, has a part in it.
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
from lumped.arrays import Array, IntArray, dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import modes, solved
from meshes.section.section_mesh import section_mesh
from validation.models.leg_models import filled

WAVES = "waves in the legs: contraction, warping by shear on the way, walls that bend"
WAVES_SOURCE = "waves of 3-D elasticity on the section's mesh (validation.cases.leg_waves)"
NO_WAVES = (
    "waves of 3-D elasticity have no number for this mode: walls of the legs move by themselves at "
    "its frequency, or it lies so high that pieces of a leg would be shorter than its elements"
)
# Share of a mode's strain energy below which it does not matter that a wave is no beam's.
_NOTHING = 1e-4
# What frequencies change by from one step to the next, relative, when they are found.
_CONVERGED = 1e-6
_STEPS = 20
# Of the lowest frequency of a piece with both ends held: a beam's and that by waves are one there.
_BELOW = 0.5

Waves: TypeAlias = Mapping[str, tuple[PrismWaves, ...]]


def waves_of(legs: Mapping[str, ConstantLeg], divisions: Mapping[str, int]) -> Waves:
    """Waves on the section mesh of every leg by name, that of its solid with so many divisions.

    Raises InputError for a section that is not symmetric about both axes.
    """
    made: dict[tuple[object, ...], tuple[PrismWaves, ...]] = {}
    found = {}
    for name, leg in legs.items():
        key = leg.section, leg.material, divisions[name]
        if key not in made:
            made[key] = prism_waves(section_mesh(leg.section, divisions[name]), leg.material)
        found[name] = made[key]
    return found


def wave_changes(
    postures: Sequence[Posture],
    legs: Mapping[str, Superelement],
    beams: Mapping[str, LegMatrices],
    waves: Waves,
    *,
    elements: int,
    offered: int,
    count: int,
) -> Array:
    """Relative change (p×count) of the first frequencies by waves, in the space of `offered` modes.

    `beams` are those of so many `elements` and of the constants of the same section meshes, `legs`
    their reductions. NaN where a mode has waves that are none of a beam's any more, or swings in
    shorter pieces than elements.
    """
    bodies = {name: filled(leg.matrices) for name, leg in legs.items()}
    prepared = assembly(postures[0].mechanism, bodies)
    pieced = {
        name: _PiecedLeg(legs[name], beams[name], elements, kinds) for name, kinds in waves.items()
    }
    rows = []
    for posture in postures:
        system = prepared.at(posture)
        found = modes(solved(system), offered)
        own = [
            leg.reduced.recover(system.body_unknowns(name, found.shapes))
            for name, leg in pieced.items()
        ]
        shapes = tuple(zip(pieced.values(), own, strict=True))
        rows.append([_change(found.frequencies, shapes, mode) for mode in range(count)])
    return np.array(rows)


@dataclass(frozen=True, eq=False)
class _PiecedLeg:
    """A leg as a beam of equal `elements`, and its `waves`."""

    reduced: Superelement
    beam: LegMatrices
    elements: int
    waves: tuple[PrismWaves, ...]

    @cached_property
    def alike(self) -> tuple[PrismWaves, ...]:
        """Beam of the Saint-Venant states of each kind of waves."""
        return tuple(saint_venant_beam(kind) for kind in self.waves)

    @cached_property
    def held(self) -> float:
        """ω (rad/s) of the leg with both ends held."""
        stiffness, mass = (
            dense(matrix)[ENDS:, ENDS:] for matrix in (self.beam.stiffness, self.beam.mass)
        )
        lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])
        return float(np.sqrt(lowest[0]))

    def pieces(self, omega: float) -> int:
        """Into how many equal pieces of whole elements the leg is cut at ω (rad/s)."""
        # Tension's frequencies grow with 1/L, bending's faster.
        needed = omega / (_BELOW * self.held)
        for pieces in range(1, self.elements + 1):
            if self.elements % pieces == 0 and pieces >= needed:
                return pieces
        raise ComputationError("waves: shorter than the beam's elements")

    def sections(self, pieces: int) -> IntArray:
        """Unknowns ((pieces + 1)×6) of the sections between them: root, inner nodes, tip."""
        inner = np.arange(1, pieces) * (self.elements // pieces) - 1
        first = np.concatenate([[0], ENDS + 6 * inner, [6]])
        return np.asarray(first[:, None] + np.arange(6))


def _change(frequencies: Array, legs: Sequence[tuple[_PiecedLeg, Array]], mode: int) -> float:
    """Relative change of a mode among those of `frequencies` (Hz), `legs` with their shapes."""
    squares = np.square(2.0 * np.pi * frequencies)
    own = omega = float(np.sqrt(squares[mode]))
    try:
        for _ in range(_STEPS):
            before = omega
            differences = (_difference(leg, own, mode, omega) for leg, own in legs)
            value = float(np.linalg.eigvalsh(np.diag(squares) + sum(differences))[mode])
            if value <= 0.0:
                break
            omega = float(np.sqrt(value))
            if abs(omega - before) <= _CONVERGED * own:
                return omega / own - 1.0
    except ComputationError:
        pass
    return float("nan")


def _difference(leg: _PiecedLeg, own: Array, mode: int, omega: float) -> Array:
    """Φᵀ(D − D_beam)Φ (m×m) of one leg with `own` shapes Φ at ω (rad/s)."""
    pieces = leg.pieces(omega)
    sections = leg.sections(pieces).ravel()
    length = leg.beam.length / pieces
    difference = np.zeros((own.shape[1],) * 2)
    for kind, alike in zip(leg.waves, leg.alike, strict=True):
        try:
            of_piece = kind.stiffness(length, omega) - alike.stiffness(length, omega)
        except ComputationError:
            swung = own[:, mode]
            strained = swung @ (leg.beam.parts[kind.fields.name] @ swung)
            if strained > _NOTHING * omega**2:
                raise
            continue
        count = len(kind.fields.twists)
        moved = (6 * np.arange(pieces + 1)[:, None] + kind.fields.twists).ravel()
        assembled = np.zeros((len(moved),) * 2)
        for first in range(0, pieces * count, count):
            ends = slice(first, first + len(kind.ends))
            assembled[ends, ends] += of_piece
        twists = own[sections[moved]]
        difference += twists.T @ assembled @ twists
    return difference
