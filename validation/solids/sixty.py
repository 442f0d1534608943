"""The first sixty modes of the robot with solid legs, and where their strain energy sits."""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.system.joint_motion import Portion
from validation.context import Context, Preset
from validation.solids.robots import strain_energy_shares, unreduced_robot
from validation.solids.size import skip_too_large

SIXTY = 60
DIVISIONS: dict[Preset, int] = {"quick": 1, "standard": 3, "fine": 4}
COARSE = 1
FEET = (Portion("foot 1"), Portion("foot 2"))
# Share of the strain energy above which a mode is due to a part alone.
ALONE = 0.95


@dataclass(frozen=True)
class SixtyModes:
    """Frequencies (Hz) of the first modes of the solid robot at the centre of its stroke.

    `shares` of the strain energy as in `strain_energy_shares`; `balance`: the parts' energy over
    ω²/2, less one, of which `rounding` is lost in its sum (m values each; N. J. Higham, Accuracy
    and Stability of Numerical Algorithms, §3.1: a unit in the last place of |φ|ᵀ|K||φ|).
    """

    x: float
    frequencies: Array
    shares: dict[Portion, Array]
    balance: Array
    rounding: Array


def sixty_modes(robot: Biglide, divisions: int) -> SixtyModes:
    """The first sixty modes, both legs as solids with rigid end faces, no reduction."""
    (whole,) = unreduced_robot(robot, (robot.centre,), divisions, SIXTY)
    shapes, frequencies = whole.modes.shapes, whole.modes.frequencies
    stiffness, squares = whole.system.stiffness, np.square(2.0 * np.pi * frequencies)
    energy = np.einsum("ij,ij->j", shapes, stiffness @ shapes)
    summed = np.einsum("ij,ij->j", np.abs(shapes), abs(stiffness) @ np.abs(shapes))
    return SixtyModes(
        x=robot.centre,
        frequencies=frequencies,
        shares=strain_energy_shares(whole),
        balance=energy / squares - 1.0,
        rounding=np.finfo(np.float64).eps * summed / squares,
    )


def sixty(context: Context) -> SixtyModes:
    """The first sixty modes on the preset's meshes; raises Skip where legs are too slender."""
    robot, divisions = context.robot, DIVISIONS[context.preset]
    skip_too_large((robot.leg1, robot.leg2), (divisions, divisions), context.preset)
    return context.get(sixty_modes, robot, divisions)


def in_the_feet(found: SixtyModes) -> Array:
    """Share of each mode's strain energy in both feet (m values)."""
    feet = [share for part, share in found.shares.items() if part in FEET]
    return np.sum(feet, axis=0) if feet else np.zeros(len(found.frequencies))
