"""What Saint-Venant's torsion of the legs leaves out of a robot's modes.

Along a torsional wave sections warp by different amounts, which stiffens open ones (Vlasov), and
turn by different amounts, whose inertia bends thin walls: closed ones become softer. The wave of
3-D elasticity in an endless leg has both. A mode counts as one of beams where its frequency and
shape stay the same, whether legs have the torsional stiffness of Saint-Venant or of that wave.
"""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from scipy.linalg import eigh

from fem.sections.nonuniform_torsion import torsional_speed
from fem.sections.waveguide import torsion_wave
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import ConstantLeg
from validation.agreement.mode_pairing import CLOSE
from validation.solids.legs import face_mesh, leg_constants
from validation.studies.paired_robot_modes import SampledModes, paired

# A torsional mode on its way to its own frequency may pass others, with which it mixes: what counts
# is the largest effect on the way, in steps of stiffness of 10 %, which move a mode by 5 %: half of
# what counts as close, so that none passes another unseen.
_STEP = CLOSE
# Waves need dense matrices; on half as many divisions the error is the same to a tenth.
_DIVISIONS = 4


@dataclass(frozen=True)
class TorsionEffects:
    """Of what Saint-Venant's torsion leaves out, on the first k modes at p postures (p×k).

    `frequency` is the largest relative change of a mode and its close neighbours, `mac` the
    smallest MAC of a mode with itself (close modes: of the space they span).
    """

    frequency: Array
    mac: Array


def wave_error(leg: ConstantLeg, frequency: float) -> float:
    """Relative excess of a leg's torsional stiffness in a wave over Saint-Venant's GJ.

    ω²/ω₀² − 1 with ω₀ = k√(GJ/ρI_p). The wave is half a wave on the leg or, for modes up to a
    higher `frequency` (Hz) than that has, the shorter one with ω₀ of that frequency. Negative where
    walls bend more than warping stiffens.
    """
    mesh, material = face_mesh(leg, _DIVISIONS), leg.material
    speed = torsional_speed(leg_constants(leg, _DIVISIONS), material)
    wave_number = max(np.pi / leg.length, 2.0 * np.pi * frequency / speed)
    found = torsion_wave(mesh, material, float(wave_number))
    return float((found / (wave_number * speed)) ** 2 - 1.0)


def with_torsion(modes: SampledModes, errors: Array) -> SampledModes:
    """Modes with the torsional stiffness of leg 1 and leg 2 larger by `errors` (2, relative).

    By Ritz in the space of the given modes.
    """
    frequencies, samples, torsion = [], [], []
    for at, shapes, parts in zip(modes.frequencies, modes.samples, modes.torsion, strict=True):
        stiffness = np.diag(np.square(2.0 * np.pi * at)) + np.tensordot(errors, parts, axes=1)
        values, mixed = eigh(stiffness)
        frequencies.append(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi))
        samples.append(shapes @ mixed)
        torsion.append((1.0 + errors)[:, None, None] * (mixed.T @ parts @ mixed))
    return replace(
        modes,
        frequencies=np.array(frequencies),
        samples=np.array(samples),
        torsion=np.array(torsion),
    )


def torsion_effects(robot: Biglide, modes: SampledModes, errors: Array) -> TorsionEffects:
    """How modes of beams change while torsional stiffness goes to 1 + `errors` (2) times its own.

    Modes keep their shape where they stay apart, so that partners by shape are the same modes.
    """
    changes, shapes = [], []
    stiffer = np.log1p(errors)
    count = max(1, ceil(np.abs(stiffer).max() / _STEP))
    for part in np.arange(1, count + 1) / count:
        found = paired(robot, modes, with_torsion(modes, np.expm1(part * stiffer)))
        changes.append(found.difference)
        shapes.append(np.where(found.close, found.shared, found.mac))
    return TorsionEffects(np.max(changes, axis=0), np.min(shapes, axis=0))
