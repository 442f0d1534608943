"""Geometric stiffness of a loaded leg.

The sections of the leg transmit a force n and a moment m. To second order in displacements u and
rotation vectors θ, with x along the leg, they do the work (Simo and Vu-Quoc, Comput. Methods Appl.
Mech. Eng. 58 (1986) 79)

    ∫ −n·(θ × u′) + ½ n·(θ × (θ × eₓ)) − ½ m·(θ × θ′) dx + ½ ∫ σ g² dA dx

with the axial stress σ = N/A + My z/Iy − Mz y/Iz and the shear strain g of a point of a rigid
section, (γy − φx′ z, γz + φx′ y): Green's axial strain is that of Reissner's beam plus ½ g² + ½ ε²,
of which ε² is small compared with the strain itself. If both axes are axes of symmetry,

    ½ ∫ σ g² dA = ½ N γ² + ½ N i² φx′² − φx′ (My γy + Mz γz).

The first term is Engesser's: with Green's strains and the shear modulus of solids, columns with
Euler's load P buckle at P/(1 + P/κGA) (Bažant, J. Appl. Mech. 38 (1971) 919, on Haringx, who omits
it). The second is Wagner's term of sections that rotate about the leg, with the polar radius of
gyration i. The third reduces the lateral buckling load of stout legs with shear deformation, which
would otherwise increase this load. A rigid rotation of the whole leg only rotates its forces.

Bending before buckling is neglected, as in any linear theory of buckling. A leg that can spin idly
about its axis needs a correction of this theory. Its bent shape does not rotate with it, and the
torsion due to a bending moment is proportional to the difference of EIy and EIz (Kirchhoff's rod).
For a round rod this torsion is zero. For other sections it would turn the leg over under the
smallest load, if there were no friction. For any leg that spins idly, the work of bending moments
and shear forces on the twist is therefore omitted. Of the terms above with φx,

    φx (θ′·(eₓ × m) + γ·(eₓ × n)) − φx′ m·γ − ½ [φx θ·(eₓ × m)]′,

only the last one remains, which acts in the joints at both ends.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import block_diag
from scipy.sparse import csr_array

from fem.beams.beam import beam_leg
from fem.beams.line_beam import line_beam
from fem.reduction.superelement import ENDS, held_leg
from lumped.arrays import Array, SparseMatrix, dense
from lumped.beam_properties import BeamProperties
from lumped.dense.modes import solve_modes
from lumped.line_sections import FIELDS, LineSections
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import skew
from lumped.system.line_loads import linear_load
from lumped.system.members import section_forces

# Number of Gauss points per element: exact for a cubic moment (due to a linearly distributed load)
# times two quadratic rotations.
_POINTS = 4
_ALONG = np.array([1.0, 0.0, 0.0])
_ACROSS = np.diag([0.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False)
class PrestressedLeg:
    """A leg reduced to the twists of its ends and the amplitudes of its modes with fixed ends.

    The leg has r unknowns: 12 components of the end twists, then the modal amplitudes. `matrices`
    are stiffness and mass on these unknowns. `fields` (s×9×r) is the matrix from the unknowns to
    u′, θ and θ′ at s `stations` (m from the root), with the quadrature `weights` (m). `gyration`
    (s) is the squared polar radius of gyration i² (m²) of the sections at the stations.
    """

    matrices: LegMatrices
    stations: Array
    weights: Array
    fields: Array
    gyration: Array

    def geometric_stiffness(self, ends: Array, distributed: Array, *, spins: bool = False) -> Array:
        """Geometric stiffness (r×r, SI) of the leg under forces on its ends and along its length.

        `ends` (12, in N and N m, leg axes) are the end forces that the leg's stiffness balances:
        force and moment on the root, then on the tip. They include `distributed` (12), the end
        forces that are equivalent to the load along the length. `spins` is True if the leg can spin
        idly about its axis.
        """
        load = linear_load(distributed[:6], distributed[6:], self.matrices.length)
        at_root = ends[:6] - distributed[:6]
        force, moment = np.hsplit(section_forces(at_root, [load], self.stations), 2)
        force_cross = skew(force)
        work = np.zeros((len(force), 9, 9))
        work[:, 3:6, :3] = force_cross
        outer = force[:, :, None] * _ALONG
        work[:, 3:6, 3:6] = 0.5 * (outer + np.swapaxes(outer, 1, 2))
        work[:, 3:6, 6:] = 0.5 * skew(moment)
        work[:, :3, 3:6] = np.swapaxes(force_cross, 1, 2)
        work[:, 6:, 3:6] = np.swapaxes(work[:, 3:6, 6:], 1, 2)
        shear = np.hstack([_ACROSS, _ACROSS @ skew(_ALONG), np.zeros((3, 3))])
        if spins:
            spin_rows = np.cross(_ALONG, force) @ shear
            spin_rows[:, 6:] += np.cross(_ALONG, moment)
            work[:, 3] -= spin_rows
            work[:, :, 3] -= spin_rows
        else:
            sheared = moment @ shear
            work[:, 6] -= sheared
            work[:, :, 6] -= sheared
        tension = force[:, 0, None, None]
        work[:, 3:6, 3:6] -= tension * np.eye(3)
        work += tension * (shear.T @ shear)
        work[:, 6, 6] += self.gyration * force[:, 0]
        rows = self.fields.shape[2]
        worked = (self.weights[:, None, None] * (work @ self.fields)).reshape(-1, rows)
        stiffness = self.fields.reshape(-1, rows).T @ worked
        return np.asarray(0.5 * (stiffness + stiffness.T))


def prestressed_leg(
    properties: BeamProperties, length: float, elements: int, modes: int
) -> PrestressedLeg:
    """Beam with `elements` elements, reduced to its ends and its lowest modes with fixed ends.

    `modes` is the number of these modes. If there are fewer, all are kept. Buckling loads converge
    with the fourth power of the element length.
    """
    beam = beam_leg(properties, length, elements)
    edges = np.linspace(0.0, length, elements + 1)
    gyration = properties.rho_J / properties.mu
    return _prestressed(beam, edges, lambda stations: np.full(len(stations), gyration), modes)


def prestressed_line_leg(sections: LineSections, elements: int, modes: int) -> PrestressedLeg:
    """Straight leg of varying section, reduced as in `prestressed_leg`.

    `modes` is the number of modes with fixed ends.
    """
    mu, rho_J = FIELDS.index("mu"), FIELDS.index("rho_J")

    def gyration(stations: Array) -> Array:
        constants = sections.constants(sections.span_at(stations), stations)
        return np.asarray(constants[:, rho_J] / constants[:, mu])

    return _prestressed(line_beam(sections, elements), sections.edges(elements), gyration, modes)


def _prestressed(
    beam: LegMatrices, edges: Array, gyration: Callable[[Array], Array], modes: int
) -> PrestressedLeg:
    """Prestressed leg of a straight `beam` with elements between `edges` (m).

    `gyration` returns the squared polar radii of gyration i² (m²) of the sections at given stations
    (m). `modes` is the number of modes with fixed ends.
    """
    length = float(edges[-1])
    held_ends = held_leg(beam)
    inner = beam.size - ENDS
    inside = solve_modes(
        dense(beam.stiffness)[ENDS:, ENDS:],
        dense(beam.mass)[ENDS:, ENDS:],
        min(modes, inner),
        beam.model,
    )
    recovery = np.hstack(
        [
            held_ends.constraint_modes,
            np.vstack([np.zeros((ENDS, inside.shapes.shape[1])), inside.shapes]),
        ]
    )
    mass = recovery.T @ (beam.mass @ recovery)

    def centreline(stations: Array) -> SparseMatrix:
        return csr_array(beam.centreline(stations) @ recovery)

    matrices = LegMatrices(
        model="prestressed beam",
        length=length,
        stiffness=block_diag(held_ends.stiffness, np.diag((2.0 * np.pi * inside.frequencies) ** 2)),
        mass=0.5 * (mass + mass.T),
        centreline=centreline,
    )
    points, weights = legendre.leggauss(_POINTS)
    lengths = np.diff(edges)[:, None]
    stations = (edges[:-1, None] + 0.5 * lengths * (1.0 + points)).ravel()
    twists = dense(centreline(stations)).reshape(len(lengths), _POINTS, 6, -1)
    # Fields are cubic within an element, so that their derivatives follow from four values.
    values = legendre.legvander(points, _POINTS - 1)
    slopes = legendre.legval(points, legendre.legder(np.eye(_POINTS))).T @ np.linalg.inv(values)
    sloping = 2.0 / lengths[:, :, None, None] * np.einsum("pq,eqij->epij", slopes, twists)
    fields = np.concatenate([sloping[:, :, :3], twists[:, :, 3:], sloping[:, :, 3:]], axis=2)
    return PrestressedLeg(
        matrices=matrices,
        stations=stations,
        weights=(0.5 * lengths * weights).ravel(),
        fields=fields.reshape(len(stations), 9, -1),
        gyration=gyration(stations),
    )


def between(leg: PrestressedLeg, ends: Array) -> LegMatrices:
    """Leg whose stiffness between its two ends is replaced by `ends` (12×12, SI, leg axes)."""
    stiffness = dense(leg.matrices.stiffness).copy()
    stiffness[:ENDS, :ENDS] = ends
    return replace(leg.matrices, stiffness=stiffness)
