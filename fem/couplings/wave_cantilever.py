"""Frequencies of a prismatic cantilever by waves of 3-D elasticity, with ends free to warp.

The frequencies are computed from the section alone and are exact along the leg. Three models of the
same section are compared. In the first, sections move as in Saint-Venant's states: this is
Timoshenko's beam. In the second (`prism_waves`), waves on the section's mesh replace those of the
beam. In them the section also contracts, warps by shear, and its walls bend. The tractions of these
waves on the end faces differ from Saint-Venant's, which are the boundary condition. In the third,
all other fields e^{γx} of the section are therefore added, which satisfy this condition: a section
distorts at a free end. The ratio of the frequencies with and without these effects applies to any
beam theory with the same section constants.
"""

from dataclasses import replace

import numpy as np
import scipy
from scipy.linalg import eig, eigh, eigvalsh, lu_factor, lu_solve

from fem.couplings.section_fields import saint_venant_states
from fem.couplings.wave_stiffness import PrismWaves, beam_wave
from lumped.arrays import Array
from lumped.errors import ComputationError

# Phase (rad) of a travelling wave over one piece of the leg. A piece with fixed ends vibrates by
# itself from a phase of π (shear, tension, torsion) to 4.73 (slender bending).
_PHASE = 0.5 * np.pi
# Relative step of the search for a change of sign, and largest number of steps (a factor of 6).
_STEP, _STEPS = 0.03, 60
# Relative accuracy of a frequency between two changes of sign.
_ACCURACY = 1e-10
# Largest number of secant steps for the frequency with all fields (four to six are needed),
# relative size of the first step, and relative step that ends the search: γ² of long waves in
# slender legs is accurate to 1e-8.
_SECANTS, _FIRST, _CONVERGED = 20, 1e-4, 1e-7
# Steps of inverse iteration for the forces that border the matrix. The frequency does not depend on
# them, but the steps of its search do; after eight, the forces change by round-off only.
_INVERSE_STEPS = 8
# Relative distance from the estimate beyond which a frequency belongs to another mode.
_ANOTHER = 0.1


def cut_off(kind: PrismWaves) -> float:
    """Lowest frequency (Hz) of a mode in which all sections of the leg distort or shear in phase.

    Only modes with the symmetry of `kind` are considered. Below this frequency a single wave of
    this kind travels along the leg: the wave of a beam.
    """
    # The first eigenvalue is the rigid motion: tension, torsion or the translation of bending.
    squares = eigh(kind.fields.E2, kind.fields.mass, subset_by_index=[1, 1], eigvals_only=True)
    return float(np.sqrt(squares[0]) / (2.0 * np.pi))


def wave_frequency(kind: PrismWaves, length: float, order: int, near: float) -> float:
    """Natural frequency (Hz) number `order` (1, 2, …) of a cantilever of `length` (m).

    It is computed from the waves of one `kind`, with Saint-Venant's resultants at the ends. `near`
    (Hz) is an estimate. Raises ComputationError if a wave does not resemble that of a beam, or if
    no frequency is found near the estimate.
    """
    start = 2.0 * np.pi * near

    def eigenvalue(omega: float) -> float:
        """Eigenvalue number `order` of the dynamic stiffness. It is zero at the natural frequency.

        It decreases with ω, except where a piece resonates with its ends fixed.
        """
        return float(eigvalsh(_cantilever(kind, length, omega))[order - 1])

    value, omega = eigenvalue(start), start
    factor = 1.0 + _STEP if value > 0.0 else 1.0 / (1.0 + _STEP)
    for _ in range(_STEPS):
        before, omega = omega, omega * factor
        if eigenvalue(omega) * value <= 0.0:
            bracket = sorted((before, omega))
            root = scipy.optimize.brentq(eigenvalue, *bracket, rtol=_ACCURACY)
            return float(root) / (2.0 * np.pi)
    raise ComputationError(
        f"waves in a prism: the search for frequency {order} of {kind.fields.name} started at "
        f"{near:.4g} Hz and found none; the leg is too short for its section"
    )


def beam_frequency(kind: PrismWaves, length: float, order: int) -> float:
    """Natural frequency (Hz) number `order` of a cantilever of `length` (m), by beam theory.

    The beam is that of `saint_venant_beam`.
    """
    beam = saint_venant_beam(kind)
    fields = beam.fields
    quarter = (2 * order - 1) * np.pi / (2.0 * length)
    stiffness, inertia = fields.E0[-1, -1], fields.mass[-1, -1]
    rod = quarter * np.sqrt(stiffness / inertia)
    if fields.chain == 1:
        return float(rod / (2.0 * np.pi))
    # Estimate by Dunkerley's formula: the rod in shear and the slender beam in series.
    slender = quarter**2 * np.sqrt(beam.rigidity / inertia)
    return wave_frequency(
        beam, length, order, 1.0 / np.hypot(1.0 / rod, 1.0 / slender) / (2.0 * np.pi)
    )


def saint_venant_beam(kind: PrismWaves) -> PrismWaves:
    """Beam with the inertia of the section and the stiffness of its Saint-Venant states.

    The unknowns of bending are the rotation θ (in place of axial displacements) and the deflection
    w, with ∫ε·σ dA = EI θ′² + κGA (w′ ∓ θ)². The sign is − in bending z and + in bending y.
    """
    fields = kind.fields
    inertia = np.diag(fields.rigid.T @ fields.mass @ fields.rigid)
    rigidity = kind.rigidity
    if fields.chain == 1:
        unit_matrix, zero_matrix = np.ones((1, 1)), np.zeros((1, 1))
        axial = int(fields.twists == (0,))
        section = replace(
            fields, E0=rigidity * unit_matrix, E1=zero_matrix, E2=zero_matrix, mass=inertia[0] *
            unit_matrix, axial=axial, rigid=unit_matrix,
        )  # fmt: skip
        return PrismWaves(section, unit_matrix, rigidity)
    shear = _shear_stiffness(kind)
    exchange = np.array([[0.0, 1.0], [1.0, 0.0]])
    section = replace(
        fields,
        E0=np.diag([rigidity, shear]),
        # A rotation φz belongs to a slope along +y, φy to one along −z.
        E1=np.array([[0.0, 0.0], [-shear if fields.twists == (1, 5) else shear, 0.0]]),
        E2=np.diag([shear, 0.0]),
        mass=np.diag([inertia[1], inertia[0]]),
        axial=1,
        rigid=exchange,
    )
    return PrismWaves(section, exchange, rigidity)


def _shear_stiffness(kind: PrismWaves) -> float:
    """Shear stiffness κGA (N) from the tip compliance L³/(3EI) + L/(κGA) of a short cantilever.

    The length L of this cantilever is the radius of gyration of the section.
    """
    fields = kind.fields
    inertia = np.diag(fields.rigid.T @ fields.mass @ fields.rigid)
    length = float(np.sqrt(inertia[1] / inertia[0]))
    root, tip = saint_venant_states(fields, 0.0), saint_venant_states(fields, length)
    unit = np.linalg.inv(fields.rigid.T @ tip.forces)
    work = tip.forces.T @ tip.fields - root.forces.T @ root.fields
    compliance = (unit.T @ work @ unit)[0, 0]
    return float(length / (compliance - length**3 / (3.0 * kind.rigidity)))


def _cantilever(kind: PrismWaves, length: float, omega: float) -> Array:
    """Dynamic stiffness of the clamped–free prism, divided into pieces, at `omega` (rad/s).

    The unknowns are the motions at the ends of all pieces except the root. Translations are in
    units of the length of a piece, so that signs of eigenvalues do not depend on the unit of
    length.
    """
    pieces = int(length * kind.wave_number(omega) / _PHASE) + 1
    piece = length / pieces
    piece_stiffness = kind.stiffness(piece, omega)
    motions = len(piece_stiffness) // 2
    if motions == 2:
        unit = np.array([piece, 1.0, piece, 1.0])
        piece_stiffness = piece_stiffness * np.outer(unit, unit)
    assembled = np.zeros(((pieces + 1) * motions,) * 2)
    for first in range(0, pieces * motions, motions):
        ends = slice(first, first + 2 * motions)
        assembled[ends, ends] += piece_stiffness
    return assembled[motions:, motions:]


def prism_frequency(kind: PrismWaves, length: float, near: float) -> float:
    """Natural frequency (Hz) of a cantilever of `length` (m), from all fields of its section.

    At the root, the mean motion is zero and Saint-Venant's tractions act. At the tip there are no
    tractions. At a natural frequency these boundary conditions have a solution, and the implicit
    determinant is zero (A. Spence, C. Poulton, J. Comput. Phys. 204 (2005) 65). `near` (Hz) is an
    estimate. Raises ComputationError if there is no such frequency near it.
    """
    first = 2.0 * np.pi * near
    boundary = _boundary(kind, length, first)
    forces = _unbalanced_forces(boundary[0])
    before, omega = first, first * (1.0 + _FIRST)
    value = _implicit_determinant(*boundary, forces)
    for _ in range(_SECANTS):
        last, value = value, _implicit_determinant(*_boundary(kind, length, omega), forces)
        if value == last:
            break
        step = (value * (omega - before) / (value - last)).real
        before, omega = omega, omega - step
        if not abs(omega / first - 1.0) < _ANOTHER:
            break
        if abs(step) <= _CONVERGED * first:
            return omega / (2.0 * np.pi)
    raise ComputationError(
        f"waves in a prism: no frequency of {kind.fields.name} with free ends near {near:.4g} Hz"
    )


def _unbalanced_forces(matrix: Array) -> Array:
    """Unit column (n×1) that is nearly a left null vector of the nearly singular `matrix` (n×n).

    It is computed by inverse iteration. Each step solves with `matrix` and with its adjoint.
    """
    factor = lu_factor(matrix)
    forces = np.linspace(1.0, 2.0, len(matrix)).astype(complex)
    for _ in range(_INVERSE_STEPS):
        forces = lu_solve(factor, lu_solve(factor, forces), trans=2)
        forces /= np.linalg.norm(forces)
    return forces[:, None]


def _implicit_determinant(matrix: Array, tip: Array, forces: Array) -> complex:
    """Factor on the column `forces` that balances the boundary conditions.

    The motion of the tip is 1. The factor is zero at a natural frequency. `matrix` and `tip` are
    the results of `_boundary`.
    """
    bordered = np.block([[matrix, forces], [tip[None], np.zeros((1, 1))]])
    unit = np.zeros(len(bordered), complex)
    unit[-1] = 1.0
    return complex(np.linalg.solve(bordered, unit)[-1])


def _boundary(kind: PrismWaves, length: float, omega: float) -> tuple[Array, Array]:
    """Matrix of the boundary conditions on a cantilever, and the row that gives its tip motion.

    Each column belongs to the amplitude of a field or to a component of the wrench on the root.
    Columns are normalised. The tip motion (m or rad) is the one on which the first unit wrench of
    this `kind` does work. `length` (m) is that of the cantilever, `omega` (rad/s) the angular
    frequency.
    """
    fields, tractions = kind.fields, kind.tractions
    left, right = fields.squares_problem(omega)
    squares, shapes = eig(np.linalg.solve(right, left))
    squares, shapes = squares.astype(complex), shapes.astype(complex)
    # Long waves lose digits beside fields that decay within a wall. They are computed separately.
    for square, shape in (beam_wave(kind, omega, sign) for sign in kind.signs):
        nearest = int(np.argmin(np.abs(squares - square)))
        squares[nearest], shapes[:, nearest] = square, shape / np.linalg.norm(shape)
    rates = np.sqrt(squares)
    rates = np.where(rates.real < 0.0, -rates, rates)
    from_tip = shapes
    from_tip[: fields.axial] /= rates
    from_root = from_tip.copy()
    from_root[: fields.axial] *= -1.0
    faded = np.exp(-rates * length)
    at_tip = fields.E0 @ (from_tip * rates) + fields.E1 @ from_tip
    at_root = fields.E0 @ (from_root * -rates) + fields.E1 @ from_root
    count, motions = tractions.shape
    mean_motions = np.linalg.norm(fields.E0) * tractions.T
    system = np.block(
        [
            [at_root, at_tip * faded, tractions],
            [at_root * faded, at_tip, np.zeros((count, motions))],
            [
                mean_motions @ from_root,
                mean_motions @ (from_tip * faded),
                np.zeros((motions, motions)),
            ],
        ]
    )
    tip = tractions[:, 0] @ np.hstack([from_root * faded, from_tip])
    norms = np.linalg.norm(system, axis=0)
    return system / norms, np.append(tip, np.zeros(motions)) / norms
