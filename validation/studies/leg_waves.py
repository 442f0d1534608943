"""What waves of 3-D elasticity in the legs make of a mechanism's frequencies by beams.

The legs' dynamic stiffness by the waves on their sections' meshes (`fem.couplings.wave_stiffness`)
takes the place of that of beams: Λ + Φᵀ(D(ω) − D_beam(ω))Φ has the eigenvalue ω², with D on the
ends' twists and Λ, Φ the modes by beams. No mesh along the legs, and no solid, has a part in it.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

from fem.couplings.wave_stiffness import PrismWaves, prism_waves
from fem.reduction.superelement import ENDS
from lumped.arrays import Array
from lumped.dense.modes import Modes, dense
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import System, assembly
from lumped.system.solution import modes, solved
from meshes.section.section_mesh import section_mesh
from validation.models.legs import filled

WAVES = "waves in the legs: contraction, warping by shear on the way, walls that bend"
WAVES_SOURCE = "waves of 3-D elasticity on the section's mesh (validation.studies.leg_waves)"
# A beam's part of the stiffness is named by the axis of its moment, a wave by where it deflects.
_PARTS = {
    "tension": "tension",
    "torsion": "torsion",
    "bending y": "bending z",
    "bending z": "bending y",
}
# Share of a mode's strain energy below which it does not matter that a wave is no beam's.
_NOTHING = 1e-4
# What frequencies change by from one step to the next, relative, when they are found.
_CONVERGED = 1e-6
_STEPS = 20

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
    bodies: Mapping[str, BodyModel],
    waves: Waves,
    *,
    offered: int,
    count: int,
) -> Array:
    """Relative change (p×count) of the first frequencies by waves, in the space of `offered` modes.

    `bodies` are beams of the legs that have `waves`, of the constants of the same section meshes,
    and whatever the others are. NaN where a mode has waves that are none of a beam's any more.
    """
    prepared = assembly(postures[0].mechanism, {name: filled(one) for name, one in bodies.items()})
    rows = []
    for posture in postures:
        system = prepared.at(posture)
        found = modes(solved(system), offered)
        rows.append([_change(system, waves, found, mode) for mode in range(count)])
    return np.array(rows)


def _change(system: System, waves: Waves, found: Modes, mode: int) -> float:
    squares = np.square(2.0 * np.pi * found.frequencies)
    own = omega = float(np.sqrt(squares[mode]))
    try:
        for _ in range(_STEPS):
            before = omega
            differences = (
                _difference(system, name, of_leg, found, mode, omega)
                for name, of_leg in waves.items()
            )
            value = float(np.linalg.eigvalsh(np.diag(squares) + sum(differences))[mode])
            if value <= 0.0:
                break
            omega = float(np.sqrt(value))
            if abs(omega - before) <= _CONVERGED * own:
                return omega / own - 1.0
    except ComputationError:
        pass
    return float("nan")


def _difference(
    system: System,
    name: str,
    waves: tuple[PrismWaves, ...],
    found: Modes,
    mode: int,
    omega: float,
) -> Array:
    """Φᵀ(D − D_beam)Φ (m×m) of one leg at ω (rad/s)."""
    beam = system.models[name]
    if not isinstance(beam, LegMatrices):
        raise TypeError(f"{name} is no leg")
    own = system.own(name, found.shapes)
    by_beam = dynamic_stiffness(beam, omega)
    difference = np.zeros((len(found.frequencies),) * 2)
    for kind in waves:
        ends = own[kind.ends]
        try:
            stiffness = kind.stiffness(beam.length, omega)
        except ComputationError:
            swung = own[:, mode]
            strained = swung @ (beam.parts[_PARTS[kind.fields.name]] @ swung)
            if strained > _NOTHING * omega**2:
                raise
            continue
        difference += ends.T @ (stiffness - by_beam[np.ix_(kind.ends, kind.ends)]) @ ends
    return difference


def dynamic_stiffness(leg: LegMatrices, omega: float) -> Array:
    """Forces on root and tip (12×12, SI, leg axes) of a leg that swings with ω (rad/s)."""
    dynamic = dense(leg.stiffness) - omega**2 * dense(leg.mass)
    inner = np.linalg.solve(dynamic[ENDS:, ENDS:], dynamic[ENDS:, :ENDS])
    return np.asarray(dynamic[:ENDS, :ENDS] - dynamic[:ENDS, ENDS:] @ inner)
