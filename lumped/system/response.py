"""Harmonic response of a damped mechanism, at its tool or between any two points.

A part with the loss factor η has the stiffness (1 + iη) K under forces with exp(iωt): it dissipates
2πη times its stored energy in every cycle (hysteretic damping). The sum of these stiffnesses over
bodies, joints and drives is K*. The receptance is H = T (K* − ω²M)⁻¹ Tᵀ. The matrix T maps the
unknowns to the outputs: the twist of the tool, and the displacements of other points.

H is computed in a basis V of motions. They are the real modes up to a cut-off frequency, and static
responses to unit loads on the outputs and to the dissipative forces, minus the part that the modes
contain already. With A = T V, S = VᵀK*V and C = VᵀMV,

    H = A (S − ω²C)⁻¹ Aᵀ = Σ g / (1 − ω²μ),    S⁻¹C = P diag(μ) P⁻¹

with the complex modes 1/μ = ω_r² (1 + iη_r). A modal damping ratio ζ adds 2iζωω_r to 1/μ − ω², so
that the denominator is 1 − ω²μ + 2iζωω_rμ. For one mass on a spring this corresponds to k(1 + iη) −
mω² + 2iζω√(km). The effect of the loss factor of a drive in series with the compliance of its joint
is exact to first order. Viscous dashpots with the matrix D add iωD to K*. The terms of the sum are
then those of `lumped.dense.poles`.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from lumped.arrays import Array, ComplexArray
from lumped.dense.modes import Modes
from lumped.dense.poles import Terms, partial_fractions
from lumped.errors import ComputationError
from lumped.mechanism.free_twists import drive_in
from lumped.mechanism.load import Excitation
from lumped.screws import turn
from lumped.system.assembly import System
from lumped.system.joint_motion import Portion
from lumped.system.motions import frames_of
from lumped.system.solution import Solved, modes_with_mass, with_idle, without_idle

# Ratio of the cut-off frequency of the real modes to the highest requested frequency. Modes above
# the cut-off respond almost statically: the error is a few thousandths of their small contribution.
_CUT_OFF_RATIO = 2.0
# Number of modes that are computed at first. It is doubled until the cut-off frequency is passed.
_FIRST_MODE_COUNT = 16
# Values below this fraction of the compliance, or of the largest 1/ω², are round-off.
_ROUNDING = 1e-12
# Ratio of a receptance to those of its two points alone below which it is round-off.
_ROUND_OFF = 1e-11
# Ratio of a frequency near a resonance to the resonance. The receptance is finite there without
# damping.
_BESIDE_RESONANCE = 1.05
# A static response is linearly dependent on the other motions of the basis if the energy of its
# independent part is below this fraction.
_DEPENDENT = 1e-10
# Loss factor below which a mode counts as undamped.
_SMALLEST_LOSS = 1e-9
# Displacement of a point by an idle motion, relative to the mechanism's size, that is round-off.
_IDLE = 1e-9
# Relative change of dashpots that damp a motion critically, where terms of second order degenerate.
_OFF_CRITICAL = 1e-6
# Number of frequencies at which the peak is searched, in addition to those of the modes.
_PEAK_SAMPLES = 100


@dataclass(frozen=True, eq=False)
class DampedModes:
    """The r complex modes of a mechanism, as terms of its receptance.

    Each term is (g + iωh) / (1 − ω²μ + 2iζωω_rμ + iωκ), as in the module docstring. `inverses` (r)
    are μ (s²), the inverse squares of the complex natural frequencies. `residues` (r×…) are g, the
    contributions of the modes to the static compliance of the outputs (k×k for k outputs, or one
    number for one direction). `ratio` is the damping ratio ζ, one for all modes or one for each.
    `rates` are κ (r, in s) and `rate_residues` are h (same shape as `residues`). κ and h are due to
    viscous dashpots.
    """

    inverses: ComplexArray
    residues: ComplexArray
    ratio: float | Array
    rates: ComplexArray
    rate_residues: ComplexArray

    @cached_property
    def frequencies(self) -> Array:
        """Natural frequencies (r values, in Hz). Infinite for motions without mass."""
        massive = np.abs(self.inverses) > _ROUNDING * np.abs(self.inverses).max(initial=0.0)
        squares = np.divide(
            1.0, self.inverses, out=np.full_like(self.inverses, np.inf), where=massive
        )
        return np.asarray(np.sqrt(squares.real) / (2.0 * np.pi))

    @cached_property
    def losses(self) -> Array:
        """Loss factors (r values) of the modes.

        Each is the sum of the loss factor due to parts and dashpots, and twice the damping ratio.
        """
        finite = np.isfinite(self.frequencies)
        of_parts = np.divide(
            -self.inverses.imag, self.inverses.real, out=np.zeros(len(finite)), where=finite
        )
        natural = 2.0 * np.pi * np.where(finite, self.frequencies, 0.0)
        return np.asarray(of_parts + self.rates.real * natural + 2.0 * self.ratio)

    def along(self, direction: Array) -> "DampedModes":
        """The same modes, with the receptance of the tool along `direction`.

        Both displacement and force are along this unit vector (base axes).
        """
        return self.between(slice(3), direction, slice(3), direction)

    def between(self, moved: slice, direction: Array, loaded: slice, force: Array) -> "DampedModes":
        """The same modes, with the receptance for one displacement and one force.

        The displacement is along `direction`, the force along `force` (unit vectors, base axes).
        `moved` selects the translations of the displaced point among the rows of the residues, and
        `loaded` those of the point where the force acts among the columns.
        """
        residues, rate_residues = (
            np.einsum("i,rij,j->r", direction, terms[:, moved, loaded], force)
            for terms in (self.residues, self.rate_residues)
        )
        component = replace(self, residues=residues, rate_residues=rate_residues)
        return component if self._moves(component, moved, loaded) else component._without_terms()

    def _moves(self, component: "DampedModes", moved: slice, loaded: slice) -> bool:
        """True if `component`, the receptance for one displacement and force, exceeds round-off.

        It is compared with the receptances of both points, at zero frequency and near all
        resonances. The terms themselves are not compared, because terms of equal frequencies may
        cancel.
        """
        finite = self.frequencies[np.isfinite(self.frequencies)]
        samples = np.append(0.0, _BESIDE_RESONANCE * finite)
        moved_size, loaded_size = (
            np.linalg.norm(self._rows(rows).receptance(samples), axis=(1, 2))
            for rows in (moved, loaded)
        )
        sizes = np.abs(component.receptance(samples))
        return bool((sizes > _ROUND_OFF * np.sqrt(moved_size * loaded_size)).any())

    def _rows(self, rows: slice) -> "DampedModes":
        """The same modes with only the rows and columns `rows` of the residues."""
        return replace(
            self,
            residues=self.residues[:, rows, rows],
            rate_residues=self.rate_residues[:, rows, rows],
        )

    def _without_terms(self) -> "DampedModes":
        """The same modes with a receptance of zero. The force does not cause the displacement."""
        zeros = np.zeros_like(self.residues)
        return replace(self, residues=zeros, rate_residues=zeros)

    def receptance(self, frequencies: Array) -> ComplexArray:
        """Receptance (displacement per force, n×…, SI) at n `frequencies` (Hz)."""
        speeds = 2.0 * np.pi * np.asarray(frequencies, dtype=float)[:, None]
        natural = 2.0 * np.pi * np.where(np.isfinite(self.frequencies), self.frequencies, 0.0)
        denominator = 1.0 - speeds**2 * self.inverses
        denominator = denominator + 2j * self.ratio * speeds * natural * self.inverses
        denominator = denominator + 1j * speeds * self.rates
        rate_responses = np.tensordot(1j * speeds / denominator, self.rate_residues, axes=1)
        return np.asarray(np.tensordot(1.0 / denominator, self.residues, axes=1) + rate_responses)

    def size(self, frequency: float) -> float:
        """Magnitude (m/N) of the receptance for one displacement and force at `frequency` (Hz)."""
        return float(np.abs(self.receptance(np.array([frequency]))[0]))

    def peak(self, first: float, last: float) -> tuple[float, float]:
        """Largest magnitude (m/N) of the receptance in a frequency range, and its frequency (Hz).

        The range is from `first` to `last` (Hz). The residues must be those for one displacement
        and one force. The magnitude is infinite if a mode that contributes in this range is
        undamped. The result is (0, NaN) if the force causes no displacement.
        """
        natural = 2.0 * np.pi * np.where(np.isfinite(self.frequencies), self.frequencies, 0.0)
        sizes = np.abs(self.residues) + natural * np.abs(self.rate_residues)
        if not sizes.any():
            return 0.0, np.nan
        inside = (self.frequencies >= first) & (self.frequencies <= last)
        inside &= sizes > _ROUNDING * sizes.sum()
        natural, losses = self.frequencies[inside], self.losses[inside]
        if (losses < _SMALLEST_LOSS).any():
            return np.inf, float(natural[np.argmin(losses)])
        around = np.concatenate([natural * (1.0 + side * losses) for side in (-1.0, 0.0, 1.0)])
        samples = np.concatenate([np.geomspace(first, last, _PEAK_SAMPLES), around])
        samples = np.unique(np.clip(samples, first, last))
        top = int(np.argmax(np.abs(self.receptance(samples))))
        low, high = samples[max(top - 1, 0)], samples[min(top + 1, len(samples) - 1)]
        optimum = scipy.optimize.minimize_scalar(
            lambda frequency: -self.size(frequency),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-9 * high},
        )
        peak_frequency = max((float(samples[top]), float(optimum.x)), key=self.size)
        return self.size(peak_frequency), peak_frequency


@dataclass(frozen=True, eq=False)
class HarmonicResponse:
    """Response of a point to a harmonic force.

    `receptance` (n, complex, in m/N) is given at the n frequencies of the `excitation`. `judged`
    are the values whose names are `Excitation.judged`: height (m/N) and frequency (Hz) of the peak,
    and the magnitude (m/N) at the frequency `excitation.at` unless that is None.
    """

    excitation: Excitation
    receptance: ComplexArray
    judged: tuple[float, ...]


def harmonic_responses(solution: Solved) -> tuple[HarmonicResponse, ...]:
    """Responses to all harmonic forces of a mechanism in one posture.

    Raises ComputationError if an idle motion moves the point of a force or displacement. No spring
    resists such a motion, so that the response has no bound at low frequencies.
    """
    system = solution.system
    excitations = system.motions.structure.mechanism.excitations
    if not excitations:
        return ()
    ends = [end for excitation in excitations for end in (excitation.loaded, excitation.moved)]
    points = list(dict.fromkeys(end for end in ends if end is not None))
    rows = np.vstack([system.tool, *(_translations(solution, *point) for point in points)])
    modes = damped_modes(solution, max(excitation.last for excitation in excitations), rows)

    def rows_of(point: tuple[str, str] | None) -> slice:
        first = 0 if point is None else len(system.tool) + 3 * points.index(point)
        return slice(first, first + 3)

    responses = []
    for excitation in excitations:
        modes_between = modes.between(
            rows_of(excitation.moved),
            excitation.displacement_direction,
            rows_of(excitation.loaded),
            excitation.direction,
        )
        responses.append(_response(modes_between, excitation))
    return tuple(responses)


def _translations(solution: Solved, body: str, point: str) -> Array:
    """Matrix (3×n) that maps the n unknowns to the displacement (base axes) of an interface.

    Raises ComputationError if an idle motion moves the interface.
    """
    system = solution.system
    position = frames_of([system.posture]).interface(body, point)[0]
    rows = np.zeros((3, system.size))
    rows[:, : system.outer] = system.motions.at(body, point, position)[:3]
    idle = np.abs(rows @ solution.motions).max(initial=0.0)
    if idle > _IDLE * system.motions.structure.length:
        raise ComputationError(
            f"{system.name}: an idle motion moves point {point} of {body}; a response there has no "
            "bound at low frequencies"
        )
    return rows


def _response(modes: DampedModes, excitation: Excitation) -> HarmonicResponse:
    size_at = () if excitation.at is None else (modes.size(excitation.at),)
    judged = (*modes.peak(excitation.first, excitation.last), *size_at)
    return HarmonicResponse(excitation, modes.receptance(excitation.frequencies), judged)


def modal_damping(solution: Solved, modes: Modes) -> Array:
    """Viscous damping matrix (m×m, 1/s) for m real modes with unit modal mass.

    Dashpots couple the modes. Loss factors contribute to the diagonal only, which is exact to first
    order: the damping of each mode is equivalent at its natural frequency. The modal damping ratio
    is added to the diagonal.
    """
    system, speeds = solution.system, 2.0 * np.pi * modes.frequencies
    dissipation = np.sum(modes.shapes * _dissipative_forces(system, modes.shapes), axis=0)
    ratio = system.motions.structure.mechanism.damping
    strains = _dashpot_rows(system) @ modes.shapes[: system.outer]
    return np.asarray(np.diag(dissipation / speeds + 2.0 * ratio * speeds) + strains.T @ strains)


def damped_modes(solution: Solved, highest: float, outputs: Array | None = None) -> DampedModes:
    """Complex modes of a mechanism in one posture, accurate up to the frequency `highest` (Hz).

    The residues are k×k for the k rows of `outputs` (k×n), each of which maps the n unknowns to one
    output. If `outputs` is None, the outputs are the six components of the twist of the tool. Modes
    are in ascending order of their frequencies. Motions that do not oscillate follow.
    """
    system = solution.system
    outputs = system.tool if outputs is None else outputs
    dashpots = _dashpot_rows(system)
    motions = _response_basis(solution, _CUT_OFF_RATIO * highest, outputs.T, dashpots)
    damped_idle = _damped_idle_motions(solution, dashpots)
    motions = np.hstack([motions, damped_idle])
    output_motions = outputs @ motions
    dissipation = _dissipative_forces(system, motions)
    elastic = motions.T @ (system.stiffness @ motions) + 1j * (motions.T @ dissipation)
    inertia = motions.T @ (system.mass @ motions)
    if len(dashpots):
        strains = dashpots @ motions[: system.outer]
        shift = 2.0 * np.pi * highest if damped_idle.shape[1] else 0.0
        terms = _viscous_terms(elastic, strains.T @ strains, inertia, output_motions, shift)
    else:
        terms = _hysteretic_terms(elastic, inertia, output_motions)
    order = np.argsort(-np.abs(terms.inverses), kind="stable")
    ratio = system.motions.structure.mechanism.damping
    return DampedModes(
        terms.inverses[order],
        terms.residues[order],
        ratio,
        terms.rates[order],
        terms.rate_residues[order],
    )


def _hysteretic_terms(elastic: ComplexArray, inertia: Array, outputs: Array) -> Terms:
    """Terms of the receptance without dashpots, from the eigenvalues and eigenvectors of S⁻¹C.

    S is `elastic`, C is `inertia` and A is `outputs`, as in the module docstring.
    """
    inverses, shapes = np.linalg.eig(np.linalg.solve(elastic, inertia))
    participations = np.linalg.solve(shapes, np.linalg.solve(elastic, outputs.T))
    residues = np.einsum("ir,rj->rij", outputs @ shapes, participations)
    return Terms(inverses, np.zeros_like(inverses), residues, np.zeros_like(residues))


def _viscous_terms(
    elastic: ComplexArray, viscous: Array, inertia: Array, outputs: Array, shift: float
) -> Terms:
    """Terms of the receptance with dashpots. Arguments are those of `partial_fractions`.

    If a motion is critically damped, the dashpots are made slightly stronger. Raises
    ComputationError if this is not sufficient.
    """
    for change in (0.0, _OFF_CRITICAL):
        terms = partial_fractions(elastic, (1.0 + change) * viscous, inertia, outputs, shift)
        if terms is not None:
            return terms
    raise ComputationError(
        "dashpots: several modes are critically damped, so that they cannot be separated; change "
        "the damping constants by 1 %"
    )


def _dashpot_rows(system: System) -> Array:
    """Matrix R (k × unknowns of the nodes) of all dashpots.

    They dissipate the power |R ẏ|² (W) at the rates ẏ of the unknowns.
    """
    mechanism = system.motions.structure.mechanism
    frames = frames_of([system.posture])
    rows = [np.zeros((0, system.outer))]
    for joint in mechanism.joints:
        drive = drive_in(system.posture, joint)
        if drive is not None and drive.damping and drive.stiffness is not None:
            springs = system.motions.springs[Portion(joint.name, "drive")]
            rows.append(np.sqrt(drive.damping / drive.stiffness) * springs)
        if joint.damping is not None:
            position = frames.interface(joint.first.body, joint.first.point)[0]
            first, second = (
                system.motions.at(side.body, side.point, position)
                for side in (joint.first, joint.second)
            )
            axes = turn(frames.since_reference(joint.first.body)[0])
            values, directions = np.linalg.eigh(joint.damping)
            damped = values > _ROUNDING * values[-1]
            root = np.sqrt(values[damped])[:, None] * (axes @ directions[:, damped]).T
            rows.append(root @ (second - first))
    return np.vstack(rows)


def _damped_idle_motions(solution: Solved, dashpots: Array) -> Array:
    """Idle motions (n×k) with unit modal mass, if a dashpot resists any of them.

    Otherwise k is 0. `dashpots` is the matrix of `_dashpot_rows`.
    """
    motions = solution.motions
    if not solution.idle or not len(dashpots):
        return motions[:, :0]
    outer = solution.system.outer
    viscous = np.square(dashpots @ motions[:outer]).sum(axis=0)
    sizes = np.square(dashpots).sum() * np.square(motions[:outer]).sum(axis=0)
    if not (viscous > _ROUNDING * sizes).any():
        return motions[:, :0]
    mass = motions.T @ (solution.system.mass @ motions)
    values, combinations = np.linalg.eigh(mass)
    with_mass = values > _ROUNDING * values[-1]
    return np.asarray(motions @ (combinations[:, with_mass] / np.sqrt(values[with_mass])))


def _response_basis(solution: Solved, highest: float, loads: Array, dashpots: Array) -> Array:
    """Basis (n×r) for responses to `loads` (n×m) up to the frequency `highest` (Hz).

    The basis contains the real modes up to that frequency, the static responses to the loads minus
    the part that these modes contain, and the static responses to the dissipative forces in all
    these motions. With the responses to the dissipative forces, the error is of second order in the
    loss factors. Forces of `dashpots` (matrix of `_dashpot_rows`) may be large, so that the static
    response to the force of each dashpot is added, too.
    """
    real_modes = _modes_up_to(solution, highest)
    motions = real_modes.shapes / (2.0 * np.pi * real_modes.frequencies)
    motions = _with_residual_responses(solution, motions, without_idle(solution, loads))
    dissipation = _dissipative_forces(solution.system, motions)
    motions = _with_residual_responses(solution, motions, dissipation)
    if not len(dashpots):
        return motions
    forces = np.zeros((solution.system.size, len(dashpots)))
    forces[: solution.system.outer] = dashpots.T
    return _with_residual_responses(solution, motions, without_idle(solution, forces))


def _with_residual_responses(solution: Solved, motions: Array, loads: Array) -> Array:
    """Add static responses to `loads` (n×m), minus the part that `motions` (n×r) contain already.

    With the stiffness K, `motions` V must be normalised to VᵀKV = 1, and the result is, too.
    """
    stiffness = solution.system.stiffness
    static = with_idle(solution, solution.displacements(loads))
    energies = np.sum(static * (stiffness @ static), axis=0)
    static = static[:, energies > 0.0] / np.sqrt(energies[energies > 0.0])
    # Round-off of an energy, in which the terms of stiff directions cancel.
    terms = np.sum(np.abs(static) * (np.abs(stiffness) @ np.abs(static)), axis=0)
    rounding = np.finfo(float).eps * terms.max(initial=0.0)
    static -= motions @ (motions.T @ (stiffness @ static))
    energy_values, combinations = np.linalg.eigh(static.T @ (stiffness @ static))
    independent = energy_values > max(_DEPENDENT, rounding)
    return np.hstack(
        [motions, static @ (combinations[:, independent] / np.sqrt(energy_values[independent]))]
    )


def _modes_up_to(solution: Solved, highest: float) -> Modes:
    count = _FIRST_MODE_COUNT
    while True:
        modes = modes_with_mass(solution, count)
        below = int(np.sum(modes.frequencies <= highest))
        if below < count:
            return Modes(modes.frequencies[:below], modes.shapes[:, :below])
        count *= 2


def _dissipative_forces(system: System, motions: Array) -> Array:
    """Dissipative forces Σ η K V (n×r), summed over all parts, for the motions V (n×r)."""
    mechanism, outer = system.motions.structure.mechanism, motions[: system.outer]
    losses = {Portion(joint.name, "compliance"): joint.loss for joint in mechanism.joints}
    losses |= {Portion(j.name, "drive"): j.drive.loss for j in mechanism.joints if j.drive}
    forces = np.zeros_like(motions)
    for part, rows in system.motions.springs.items():
        forces[: system.outer] += losses[part] * (rows.T @ (rows @ outer))
    for name, model in system.models.items():
        body_forces = mechanism.bodies[name].loss * (
            model.stiffness @ system.body_unknowns(name, motions)
        )
        ends = system.ends[name]
        forces[: system.outer] += ends.T @ body_forces[: len(ends)]
        forces[system.inside[name]] += body_forces[len(ends) :]
    return forces
