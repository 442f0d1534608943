"""How the tool of a mechanism that loses energy answers a force that swings.

A part of loss factor η has the stiffness (1 + iη) K under forces that go with exp(iωt): of what it
stores it loses 2πη in every cycle (hysteretic damping). K* = Σ (1 + iη) K of bodies, joints and
drives gives the tool the receptance H = T (K* − ω²M)⁻¹ Tᵀ. It is found in the real modes up to some
frequency, and what these leave of static answers to unit wrenches at the tool and to what is lost.
In these motions V, with A = T V, S = VᵀK*V and C = VᵀMV,

    H = A (S − ω²C)⁻¹ Aᵀ = Σ g / (1 − ω²μ),    S⁻¹C = P diag(μ) P⁻¹

with the complex modes 1/μ = ω_r² (1 + iη_r). A modal damping ratio ζ adds 2iζωω_r to 1/μ − ω²: the
denominator is 1 − ω²μ + 2iζωω_rμ. For one mass on a spring that is k(1 + iη) − mω² + 2iζω√(km).
Where a drive stands in series with the joint's own give, what both lose together is exact to first
order.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from lumped.arrays import Array, ComplexArray
from lumped.dense.modes import Modes
from lumped.mechanism.load import Excitation
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from lumped.system.solution import Solved, modes_with_mass, with_idle, without_idle

# Real modes up to this many times the last frequency asked for: those beyond are static there but
# for a few thousandths of what little they give.
_BEYOND = 2.0
_FEWEST = 16
# Shares of the compliance, and of the largest 1/ω², below which there is rounding alone.
_ROUNDING = 1e-12
# Share of the energy of a static answer below which other motions have it in them.
_ALIKE = 1e-10
# A mode that loses less swings without bounds.
_LEAST_LOSS = 1e-9
# Frequencies at which the largest response is looked for, besides those of the modes.
_LOOKED_AT = 100


@dataclass(frozen=True, eq=False)
class DampedModes:
    """Complex modes of a mechanism, r of them, as its tool feels them.

    `inverses` (r) are μ (s²), `gives` (r×…) their part g in the static compliance of the tool (6×6,
    SI, base axes, or one direction of it). `ratio` is the damping ratio of all of them, or of each.
    """

    inverses: ComplexArray
    gives: ComplexArray
    ratio: float | Array

    @cached_property
    def frequencies(self) -> Array:
        """Natural frequencies (Hz, r); infinite where nothing has mass."""
        massive = np.abs(self.inverses) > _ROUNDING * np.abs(self.inverses).max(initial=0.0)
        squares = np.divide(
            1.0, self.inverses, out=np.full_like(self.inverses, np.inf), where=massive
        )
        return np.asarray(np.sqrt(squares.real) / (2.0 * np.pi))

    @cached_property
    def losses(self) -> Array:
        """Loss factors (r): of parts, and twice the damping ratio."""
        known = np.isfinite(self.frequencies)
        of_parts = np.divide(
            -self.inverses.imag, self.inverses.real, out=np.zeros(len(known)), where=known
        )
        return np.asarray(of_parts + 2.0 * self.ratio)

    def along(self, direction: Array) -> "DampedModes":
        """The same along a force in a direction (3, a unit vector, base axes)."""
        blocks = self.gives[:, :3, :3]
        gives = np.einsum("i,rij,j->r", direction, blocks, direction)
        # Where the tool is rigid there is rounding alone.
        yields = np.abs(gives).sum() > _ROUNDING * np.abs(blocks).sum()
        return replace(self, gives=gives * yields)

    def receptance(self, frequencies: Array) -> ComplexArray:
        """Displacement by force (n×…, SI) at frequencies (n, Hz)."""
        speeds = 2.0 * np.pi * np.asarray(frequencies, dtype=float)[:, None]
        natural = 2.0 * np.pi * np.where(np.isfinite(self.frequencies), self.frequencies, 0.0)
        swing = 1.0 - speeds**2 * self.inverses
        swing = swing + 2j * self.ratio * speeds * natural * self.inverses
        return np.asarray(np.tensordot(1.0 / swing, self.gives, axes=1))

    def size(self, frequency: float) -> float:
        """Size (m/N) of the receptance along a direction at a frequency (Hz)."""
        return float(np.abs(self.receptance(np.array([frequency]))[0]))

    def peak(self, first: float, last: float) -> tuple[float, float]:
        """The largest receptance along a direction (m/N) between two frequencies, and where (Hz).

        Infinite where a mode that takes part loses nothing, 0 and NaN where the tool is rigid.
        """
        sizes = np.abs(self.gives)
        if not sizes.any():
            return 0.0, np.nan
        inside = (self.frequencies >= first) & (self.frequencies <= last)
        inside &= sizes > _ROUNDING * sizes.sum()
        own, losses = self.frequencies[inside], self.losses[inside]
        if (losses < _LEAST_LOSS).any():
            return np.inf, float(own[np.argmin(losses)])
        around = np.concatenate([own * (1.0 + side * losses) for side in (-1.0, 0.0, 1.0)])
        looked_at = np.concatenate([np.geomspace(first, last, _LOOKED_AT), around])
        looked_at = np.unique(np.clip(looked_at, first, last))
        top = int(np.argmax(np.abs(self.receptance(looked_at))))
        low, high = looked_at[max(top - 1, 0)], looked_at[min(top + 1, len(looked_at) - 1)]
        found = scipy.optimize.minimize_scalar(
            lambda one: -self.size(one),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9 * high},
        )
        where = max((float(looked_at[top]), float(found.x)), key=self.size)
        return self.size(where), where


@dataclass(frozen=True, eq=False)
class ToolResponse:
    """The answer of the tool to an excitation, along its own force.

    `receptance` (n, complex, m/N) at the excitation's frequencies; `judged` are the numbers of
    that name: height (m/N) and frequency (Hz) of the peak, size (m/N) at one frequency.
    """

    excitation: Excitation
    receptance: ComplexArray
    judged: tuple[float, ...]


def tool_responses(solution: Solved) -> tuple[ToolResponse, ...]:
    """The answers to all excitations of a mechanism in one posture."""
    excitations = solution.system.motions.structure.mechanism.excitations
    if not excitations:
        return ()
    modes = damped_modes(solution, max(one.last for one in excitations))
    return tuple(_response(modes.along(one.direction), one) for one in excitations)


def _response(modes: DampedModes, asked: Excitation) -> ToolResponse:
    there = () if asked.at is None else (modes.size(asked.at),)
    judged = (*modes.peak(asked.first, asked.last), *there)
    return ToolResponse(asked, modes.receptance(asked.frequencies), judged)


def modal_losses(solution: Solved, found: Modes) -> Array:
    """Loss factors (m) of real modes to first order, from strain energies, and of their damping."""
    system = solution.system
    lost = np.sum(found.shapes * _lost(system, found.shapes), axis=0)
    ratio = system.motions.structure.mechanism.damping
    return np.asarray(lost / (2.0 * np.pi * found.frequencies) ** 2 + 2.0 * ratio)


def damped_modes(solution: Solved, highest: float, felt_at: Array | None = None) -> DampedModes:
    """Complex modes of a mechanism in one posture, good up to `highest` (Hz).

    They are told as the tool feels them, or as `felt_at` (k×n, motions by unknowns) are.
    """
    system = solution.system
    felt_at = system.tool if felt_at is None else felt_at
    motions = _motions(solution, _BEYOND * highest, felt_at.T)
    felt = felt_at @ motions
    elastic = motions.T @ (system.stiffness @ motions) + 1j * (motions.T @ _lost(system, motions))
    inertia = motions.T @ (system.mass @ motions)
    inverses, shapes = np.linalg.eig(np.linalg.solve(elastic, inertia))
    driven = np.linalg.solve(shapes, np.linalg.solve(elastic, felt.T))
    gives = np.einsum("ir,rj->rij", felt @ shapes, driven)
    order = np.argsort(-np.abs(inverses), kind="stable")
    ratio = system.motions.structure.mechanism.damping
    return DampedModes(inverses[order], gives[order], ratio)


def _motions(solution: Solved, highest: float, loads: Array) -> Array:
    """Motions (n×r) in which answers to loads (n×m) are sought: real modes up to `highest` (Hz).

    Then what these leave of static answers to the loads, and of those to what all of them lose: of
    second order in the losses.
    """
    real = _modes_up_to(solution, highest)
    motions = real.shapes / (2.0 * np.pi * real.frequencies)
    motions = _joined(solution, motions, without_idle(solution, loads))
    return _joined(solution, motions, _lost(solution.system, motions))


def _joined(solution: Solved, motions: Array, loads: Array) -> Array:
    """The motions (n×r) and what they leave of static answers to loads (n×m), of unit energy."""
    stiffness = solution.system.stiffness
    static = with_idle(solution, solution.displacements(loads))
    energies = np.sum(static * (stiffness @ static), axis=0)
    static = static[:, energies > 0.0] / np.sqrt(energies[energies > 0.0])
    static -= motions @ (motions.T @ (stiffness @ static))
    left, mix = np.linalg.eigh(static.T @ (stiffness @ static))
    kept = left > _ALIKE
    return np.hstack([motions, static @ (mix[:, kept] / np.sqrt(left[kept]))])


def _modes_up_to(solution: Solved, highest: float) -> Modes:
    count = _FEWEST
    while True:
        found = modes_with_mass(solution, count)
        below = int(np.sum(found.frequencies <= highest))
        if below < count:
            return Modes(found.frequencies[:below], found.shapes[:, :below])
        count *= 2


def _lost(system: System, motions: Array) -> Array:
    """Loads Σ η K V (n×r) of all that loses energy in motions V (n×r)."""
    mechanism, outer = system.motions.structure.mechanism, motions[: system.outer]
    losses = {Portion(joint.name, "compliance"): joint.loss for joint in mechanism.joints}
    losses |= {Portion(one.name, "drive"): one.drive.loss for one in mechanism.joints if one.drive}
    lost = np.zeros_like(motions)
    for part, rows in system.motions.springs.items():
        lost[: system.outer] += losses[part] * (rows.T @ (rows @ outer))
    for name, model in system.models.items():
        own = mechanism.bodies[name].loss * (model.stiffness @ system.own(name, motions))
        ends = system.ends[name]
        lost[: system.outer] += ends.T @ own[: len(ends)]
        lost[system.inside[name]] += own[len(ends) :]
    return lost
