"""Dynamic stiffness of a prism by waves of 3-D elasticity.

At an angular frequency ω a beam moves in twelve fields e^{γx}: one wave of tension, one of torsion,
and two of bending in either plane (one travels, one decays), each in both directions. A prism on
the mesh of its section has many more fields (`fem.couplings.section_fields`). Twelve of them move
the section as a whole and correspond to those of the beam. The difference between the dynamic
stiffness of the prism with these fields and that of the beam is the part that beam theory neglects
between ends that are free to warp: contraction by Poisson's ratio, warping by shear along the wave,
and walls that bend under their own inertia. At the ends, Saint-Venant's tractions act. The motions
of the ends are those conjugate to these tractions.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from fem.couplings.section_fields import SectionFields, saint_venant_states, section_fields
from fem.sections.moduli import Moduli
from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError, InputError
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Number of kinds of waves: tension, torsion, and bending in two planes.
_KINDS = 4
# Number of factorisations, each at the current estimate, and of iterations with each.
_SHIFTS, _ITERATIONS = 2, 20
# Relative distance of a shift from the current estimate: at an eigenvalue the matrix is singular.
_ASIDE = 1e-5
# Relative change of γ² below which the iteration has converged.
_CONVERGED = 1e-9


@dataclass(frozen=True, eq=False)
class PrismWaves:
    """Waves of one kind in a prism: of tension, of torsion, or of bending in one plane.

    `fields` are the displacement fields of this kind. `tractions` (n×m) are nodal forces of unit
    wrenches on a section. `rigidity` is EA (N), GJ or EI (N m²).
    """

    fields: SectionFields
    tractions: Array
    rigidity: float

    @property
    def signs(self) -> tuple[float, ...]:
        """Signs of γ² of the waves: −1 for travelling waves, 1 for decaying ones."""
        return (-1.0, 1.0) if self.fields.chain == 2 else (-1.0,)

    @property
    def ends(self) -> IntArray:
        """Indices (2m) of the motions of this kind among the twists of root and tip (12)."""
        return np.concatenate([self.fields.twists, np.add(self.fields.twists, 6)])

    def stiffness(self, length: float, omega: float) -> Array:
        """Dynamic stiffness (2m×2m, SI, leg axes) of a prism of `length` (m) at `omega` (rad/s).

        The unknowns are the motions with the indices `ends`. Raises ComputationError if a wave does
        not resemble that of a beam.
        """
        return _stiffness(self, length, omega)

    def wave_number(self, omega: float) -> float:
        """Wave number k (rad/m) of the travelling wave at `omega` (rad/s)."""
        return float(np.sqrt(-beam_wave(self, omega, -1.0)[0]))


def prism_waves(mesh: SectionMesh, material: Material | Moduli) -> tuple[PrismWaves, ...]:
    """Waves of tension, torsion, bending z and bending y of a section.

    Raises InputError if the section is not symmetric about both axes.
    """
    symmetries = section_fields(mesh, material)
    if len(symmetries) != _KINDS:
        raise InputError("waves: the section is not symmetric about both of its axes")
    kinds = []
    for fields in symmetries:
        forces = saint_venant_states(fields, 0.0).forces
        resultants = fields.rigid.T @ forces
        # The first state has unit axial strain, rate of twist or curvature.
        rigidity = float(abs(resultants[-1, 0]))
        kinds.append(PrismWaves(fields, forces @ np.linalg.inv(resultants), rigidity))
    return tuple(kinds)


def _stiffness(kind: PrismWaves, length: float, omega: float) -> Array:
    fields = kind.fields
    rates, columns = [], []
    for square, shape in (beam_wave(kind, omega, sign) for sign in kind.signs):
        for root in (np.sqrt(complex(square)), -np.sqrt(complex(square))):
            # Both signs of γ belong to γ², with u_x = p′/γ.
            wave_shape = shape.astype(complex)
            wave_shape[: fields.axial] /= root
            rates.append(root)
            columns.append(wave_shape)
    gamma, shapes = np.array(rates), np.column_stack(columns)
    forces = fields.E0 @ (shapes * gamma) + fields.E1 @ shapes
    motions, acting = [], []
    for x, outward in ((0.0, -1.0), (length, 1.0)):
        along = np.exp(gamma * x)
        motions.append(kind.tractions.T @ (shapes * along))
        acting.append(outward * (fields.rigid.T @ (forces * along)))
    stiffness = np.linalg.solve(np.vstack(motions).T, np.vstack(acting).T).T.real
    return np.asarray(0.5 * (stiffness + stiffness.T))


def beam_wave(kind: PrismWaves, omega: float, sign: float) -> tuple[float, Array]:
    """Value of γ² and shape of the wave in a prism that resembles the wave of a slender beam.

    The shape is (p′, q), see `SectionFields`. `sign` is the sign of γ²: −1 for the travelling wave,
    1 for the decaying one. `omega` is the angular frequency (rad/s). Inverse iteration starts from
    the wave of the beam, γ⁴ = ω²μ/EI or γ² = −ω²μ/EA, with a plane section. Raises ComputationError
    if it finds no such wave.
    """
    fields = kind.fields
    rigid = fields.rigid[:, 0]
    slowness = omega**2 * (rigid @ fields.mass @ rigid) / kind.rigidity
    shape = rigid
    if fields.chain == 2:
        slowness = np.sqrt(slowness)
        # The rotation is w′ with the sign of the twist, and p′ = γp.
        turned = 1.0 if fields.twists == (1, 5) else -1.0
        shape = rigid + sign * slowness * turned * fields.rigid[:, 1]
    left, right = fields.squares_problem(omega)
    square = float(sign * slowness)
    for _ in range(_SHIFTS):
        shift = (1.0 + _ASIDE) * square
        factor = lu_factor(left - shift * right)
        for _ in range(_ITERATIONS):
            following = lu_solve(factor, right @ shape)
            if not np.isfinite(following).all():
                # The term with the frequency is below the round-off of the section's stiffness.
                raise ComputationError(
                    f"waves: {fields.name} at {omega / (2.0 * np.pi):.4g} Hz is lost in "
                    "rounding; moduli or masses of the robot's parts differ by too much"
                )
            before, square = square, shift + float(shape @ shape) / float(shape @ following)
            shape = following / np.linalg.norm(following)
            if abs(square - before) <= _CONVERGED * abs(square):
                if square * sign > 0.0:
                    return square, shape
                break
    raise ComputationError(
        f"waves in a prism: at {omega / (2.0 * np.pi):.4g} Hz no wave of {fields.name} resembles "
        "that of a beam; near this frequency the walls of the section vibrate locally"
    )
