"""Geometric stiffness of a loaded leg.

The sections of the leg transmit a force n and a moment m. To second order in displacements u and
rotation vectors θ, with the unit tangent t of the leg's line and derivatives along it, they do the
work (Simo and Vu-Quoc, Comput. Methods Appl. Mech. Eng. 58 (1986) 79)

    ∫ −n·(θ × u′) + ½ n·(θ × (θ × t)) − ½ m·(θ × θ′) ds + ½ ∫ σ g² dA ds

This holds for straight, bent and curved legs, with the forces of the undeformed leg. In the axes of
a section, x along t, the last term contains the axial stress σ = N/A + My z/Iy − Mz y/Iz and the
shear strain g of a point of a rigid section, (γy − φx′ z, γz + φx′ y): Green's axial strain is that
of Reissner's beam plus ½ g² + ½ ε², of which ε² is small compared with the strain itself. If both
axes are axes of symmetry,

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

only the last one remains, which acts in the joints at both ends. The bend of a bent leg rotates
with it, so that none of these terms is omitted there.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import block_diag
from scipy.sparse import csr_array

from fem.beams.beam import beam_leg
from fem.beams.line_beam import line_beam
from fem.reduction.superelement import ENDS, held_leg
from lumped.arrays import Array, SparseMatrix, dense
from lumped.beam_properties import BeamProperties, prism_sections
from lumped.dense.modes import solve_modes
from lumped.line_sections import FIELDS, LineSections
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import skew
from lumped.system.line_loads import section_wrenches, spread_load

# Number of Gauss points per element of a straight leg: exact for a cubic moment (due to a linearly
# distributed load) times two quadratic rotations. On an arc fields are no polynomials: with eight
# points, integrals over 30° have an error of 1e-11.
_STRAIGHT, _BENT = 4, 8


@dataclass(frozen=True, eq=False)
class PrestressedLeg:
    """A leg reduced to the twists of its ends and the amplitudes of its modes with fixed ends.

    The leg has r unknowns: 12 components of the end twists, then the modal amplitudes. `matrices`
    are stiffness and mass on these unknowns. `fields` (s×9×r) is the matrix from the unknowns to
    u′, θ and θ′ (leg axes) at s `stations` (m from the root along the line), with the quadrature
    `weights` (m). `sections` are the sections of the leg. Sections at the stations lie at `points`
    (s×3, in m), with the `tangents` t (s×3). `gyration` (s) is the squared polar radius of gyration
    i² (m²) of these sections.
    """

    matrices: LegMatrices
    sections: LineSections
    stations: Array
    weights: Array
    fields: Array
    points: Array
    tangents: Array
    gyration: Array

    def geometric_stiffness(self, ends: Array, distributed: Array, *, spins: bool = False) -> Array:
        """Geometric stiffness (r×r, SI) of the leg under forces on its ends and along its length.

        `ends` (12, in N and N m, leg axes) are the end forces that the leg's stiffness balances:
        force and moment on the root, then on the tip. They include `distributed` (12), the end
        forces that are equivalent to the load along the length. `spins` is True if the leg can spin
        idly about its axis. The load varies linearly along a straight leg, and in proportion to
        the mass of a bent one, with the resultant of `distributed`.
        """
        line, tangents = self.sections.line, self.tangents
        load = spread_load(self.sections, distributed)
        at_root = ends[:6] - distributed[:6]
        wrenches = section_wrenches(line, at_root, [load], self.stations, self.points)
        force, moment = np.hsplit(wrenches, 2)
        force_cross = skew(force)
        work = np.zeros((len(force), 9, 9))
        work[:, 3:6, :3] = force_cross
        outer = force[:, :, None] * tangents[:, None]
        work[:, 3:6, 3:6] = 0.5 * (outer + np.swapaxes(outer, 1, 2))
        work[:, 3:6, 6:] = 0.5 * skew(moment)
        work[:, :3, 3:6] = np.swapaxes(force_cross, 1, 2)
        work[:, 6:, 3:6] = np.swapaxes(work[:, 3:6, 6:], 1, 2)
        across = np.eye(3) - tangents[:, :, None] * tangents[:, None]
        shear = np.concatenate([across, across @ skew(tangents), np.zeros_like(across)], axis=2)
        tension = np.einsum("si,si->s", force, tangents)[:, None, None]
        if spins and line.is_straight:
            spin_rows = np.einsum("si,sij->sj", np.cross(tangents, force), shear)
            spin_rows[:, 6:] += np.cross(tangents, moment)
            work[:, 3] -= spin_rows
            work[:, :, 3] -= spin_rows
        else:
            sheared = np.einsum("si,sij->sj", moment, shear)
            coupled = tangents[:, :, None] * sheared[:, None]
            work[:, 6:] -= coupled
            work[:, :, 6:] -= np.swapaxes(coupled, 1, 2)
        work[:, 3:6, 3:6] -= tension * np.eye(3)
        work += tension * (np.swapaxes(shear, 1, 2) @ shear)
        twist = tangents[:, :, None] * tangents[:, None]
        work[:, 6:, 6:] += self.gyration[:, None, None] * tension * twist
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
    edges = np.linspace(0.0, length, elements + 1)
    sections = prism_sections(properties, length)
    return _prestressed(beam_leg(properties, length, elements), sections, edges, modes)


def prestressed_line_leg(sections: LineSections, elements: int, modes: int) -> PrestressedLeg:
    """Leg along a line, reduced as in `prestressed_leg`.

    `modes` is the number of modes with fixed ends.
    """
    return _prestressed(line_beam(sections, elements), sections, sections.edges(elements), modes)


def _prestressed(
    beam: LegMatrices, sections: LineSections, edges: Array, modes: int
) -> PrestressedLeg:
    """Prestressed leg of a `beam` with `sections`, and with elements between `edges` (m).

    `modes` is the number of modes with fixed ends.
    """
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
        length=beam.length,
        line=beam.line,
        stiffness=block_diag(held_ends.stiffness, np.diag((2.0 * np.pi * inside.frequencies) ** 2)),
        mass=0.5 * (mass + mass.T),
        centreline=centreline,
    )
    count = _STRAIGHT if sections.line.is_straight else _BENT
    points, weights = legendre.leggauss(count)
    lengths = np.diff(edges)[:, None]
    stations = (edges[:-1, None] + 0.5 * lengths * (1.0 + points)).ravel()
    places, axes = sections.line.frames(stations)
    constants = sections.constants(sections.span_at(stations), stations)
    rho_J, mu = (constants[:, FIELDS.index(name)] for name in ("rho_J", "mu"))
    twists = dense(centreline(stations)).reshape(len(lengths), count, 6, -1)
    # Fields of a prism are cubic within an element: their derivatives follow from four values.
    values = legendre.legvander(points, count - 1)
    slopes = legendre.legval(points, legendre.legder(np.eye(count))).T @ np.linalg.inv(values)
    sloping = 2.0 / lengths[:, :, None, None] * np.einsum("pq,eqij->epij", slopes, twists)
    fields = np.concatenate([sloping[:, :, :3], twists[:, :, 3:], sloping[:, :, 3:]], axis=2)
    return PrestressedLeg(
        matrices=matrices,
        sections=sections,
        stations=stations,
        weights=(0.5 * lengths * weights).ravel(),
        fields=fields.reshape(len(stations), 9, -1),
        points=places,
        tangents=axes[:, :, 0],
        gyration=rho_J / mu,
    )


def between(leg: PrestressedLeg, ends: Array) -> LegMatrices:
    """Leg whose stiffness between its two ends is replaced by `ends` (12×12, SI, leg axes)."""
    stiffness = dense(leg.matrices.stiffness).copy()
    stiffness[:ENDS, :ENDS] = ends
    return replace(leg.matrices, stiffness=stiffness)
