"""The first sixty modes of the robot with solid legs, and where their strain energy sits."""

from dataclasses import dataclass

import numpy as np

from fem.bodies.leg_energies import DISTORTION
from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.case import Absolute, Case, Measurement
from validation.cases.robot.solid import SECTION
from validation.context import Context, Preset
from validation.solids.legs import FORMAL_ORDER
from validation.solids.robots import strain_energy_shares, unreduced_robot
from validation.studies.convergence import step_factor

SIXTY = 60
DIVISIONS: dict[Preset, int] = {"quick": 1, "standard": 3, "fine": 4}
_COARSE = 1
# Share of the strain energy above which a mode is due to a part alone.
ALONE = 0.95


def cases() -> tuple[Case, ...]:
    """Whether the energies of all parts add up."""
    return (_energy_balance(),)


def paper_cases() -> tuple[Case, ...]:
    """The paper's statement on the actuators, by solids."""
    return (
        Case(
            id="paper.solid.none-due-to-the-actuators",
            title=f"None of the first {SIXTY} modes of the solid robot is due to the feet alone",
            quantity=f"modes with more than {100.0 * ALONE:g} % of the strain energy in the feet",
            unit="1",
            reference_kind="paper-statement",
            citation="paper §3.2, the 60 first modes",
            tolerance=Absolute(0.5),
            tolerance_reason="a count: nothing but none will do",
            compute=_actuators_alone,
            # A count needs a second mesh to be believed, which a quick answer has no time for.
            presets=("standard", "fine"),
            model="solid",
            section=SECTION,
            group="robot.solid.sixty",
            figure="robot.solid.sixty-modes",
            effort=8.0,
        ),
    )


def _energy_balance() -> Case:
    return Case(
        id="robot.solid.sixty.energy",
        title=f"The parts' energies of the first {SIXTY} modes are Rayleigh's",
        quantity="largest relative difference of the parts' strain energy from ω²/2",
        unit="1",
        reference_kind="closed-form",
        citation="Rayleigh's quotient of a mode of unit modal mass",
        tolerance=Absolute(1e-8),
        tolerance_reason="convergence of the modes, squared in their energy",
        compute=_balance,
        model="solid",
        section=SECTION,
        group="robot.solid.sixty",
        effort=3.0,
    )


@dataclass(frozen=True)
class SixtyModes:
    """Frequencies (Hz) of the first modes of the solid robot at the centre of its stroke.

    `shares` of the strain energy as in `strain_energy_shares`; `balance`: the parts' energy over
    ω²/2, less one (m values each).
    """

    x: float
    frequencies: Array
    shares: dict[str, Array]
    balance: Array


def sixty_modes(robot: Biglide, divisions: int) -> SixtyModes:
    """The first sixty modes, both legs as solids with rigid end faces, no reduction."""
    (whole,) = unreduced_robot(robot, (robot.centre,), divisions, SIXTY)
    shapes, frequencies = whole.modes.shapes, whole.modes.frequencies
    energy = np.einsum("ij,ij->j", shapes, whole.system.stiffness @ shapes)
    return SixtyModes(
        x=robot.centre,
        frequencies=frequencies,
        shares=strain_energy_shares(whole),
        balance=energy / np.square(2.0 * np.pi * frequencies) - 1.0,
    )


def sixty(context: Context) -> SixtyModes:
    """The first sixty modes on the preset's meshes."""
    return context.get(sixty_modes, context.robot, DIVISIONS[context.preset])


def in_the_feet(found: SixtyModes) -> Array:
    """Share of each mode's strain energy in both feet (m values)."""
    feet = [share for part, share in found.shares.items() if part.startswith("foot")]
    return np.sum(feet, axis=0) if feet else np.zeros(len(found.frequencies))


def _actuators_alone(context: Context) -> Measurement:
    found = sixty(context)
    feet = in_the_feet(found)
    most = int(np.argmax(feet))
    coarse = in_the_feet(context.get(sixty_modes, context.robot, _COARSE))
    factor = step_factor(DIVISIONS[context.preset] / _COARSE, FORMAL_ORDER)
    counts = [float(np.sum(shares > ALONE)) for shares in (feet, coarse)]
    return Measurement(
        counts[0],
        0.0,
        value_uncertainty=factor * abs(counts[0] - counts[1]),
        notes=(
            f"at most {100.0 * feet[most]:.2f} %, mode {most + 1} at "
            f"{found.frequencies[most]:.0f} Hz; at most {100.0 * coarse.max():.2f} % on the "
            "coarser mesh",
        ),
        table={
            "mode": tuple(float(k) for k in range(1, SIXTY + 1)),
            "frequency (Hz)": tuple(found.frequencies.tolist()),
        }
        | {f"{part} (%)": tuple((100.0 * share).tolist()) for part, share in found.shares.items()},
    )


def _balance(context: Context) -> Measurement:
    found = sixty(context)
    worst = int(np.argmax(np.abs(found.balance)))
    distortion = [float(share.min()) for part, share in found.shares.items() if DISTORTION in part]
    return Measurement(
        float(found.balance[worst]),
        0.0,
        exact=True,
        notes=(
            f"smallest share of a leg's section distortion {min(distortion):.2g}: never negative "
            "but for rounding (Bessel)",
        ),
    )
