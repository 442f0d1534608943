"""Statics of a leg of n equal slices in about log₂ n dense steps: condensation by doubling.

Two equal pieces joined and their common face condensed make a piece twice as long (substructures:
Przemieniecki, AIAA J. 1 (1963) 138; doubling of the interval: Zhong, J. Comput. Appl. Math. 163
(2004) 59). Done on the stiffness of the end faces this loses digits with length: the stiffness
EI/L³ that is looked for is the small difference of entries of the size of a node's. So the pieces
have a mixed form. Displacements of a face are split into its twist, the work conjugate of
Saint-Venant's loads B, and the deformation v that is left, u = R Bᵀu + N v with BᵀN = 0. For the
relative twist q of the ends, the wrench w that a piece carries and the loads g = Nᵀf of the faces

    q =  C w + H v        v = (v_root, v_tip), all of w and q at the middle of the piece
    g = −Hᵀw + S v

The force method for the six resultants, which statics alone carries through every face; the
displacement method for deformations, which decay along the piece (Saint-Venant's principle).
A common face has g = 0, hence v = M⁻¹(…) with M the sum of the two pieces' S on it, and

    C′ = X_a C_a X_aᵀ + X_b C_b X_bᵀ + H_m M⁻¹ H_mᵀ

only adds positive terms: nothing cancels, rigid motions are exact, and M has the condition of a
face's mesh for any length. C is the compliance with rigid ends (v = 0), C + H S⁻¹ Hᵀ with free
ends (g = 0). Slices far thinner than the section's size h cost digits, since S holds shear between
the faces, ~1/l, beside stretching in their planes, ~l: an error of at most (h/l)² roundings.

A piece is its own mirror image: with s (−1 on the v that are axial, +1 on those that lie in the
face) and Q = diag(−1, 1, 1, 1, −1, −1) for twists, S_tip,tip = s S_root,root s, S_root,tip s is
symmetric, and H_tip = −Q H_root s. In the middle of two equal pieces axial and in-face deformations
thus do not couple.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, qr, solve_triangular
from scipy.sparse import diags_array

from fem.bodies.solid import Ends
from fem.couplings.grips import rigid_motions, saint_venant_loads
from fem.elasticity import stiffness
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError, InputError, naming
from lumped.legs import ConstantLeg
from lumped.screws import shift
from meshes.prism import extrude
from meshes.section.section_mesh import SectionMesh, require_leg
from meshes.solid_mesh import SolidMesh

_TWIST_MIRROR = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class _FaceDeformations:
    """Deformations N (m×k, k = m − 6) of a face: orthonormal, and Saint-Venant's loads do no work.

    The first `axial` are along x, the others within the face.
    """

    fields: Array
    axial: int

    @property
    def mirror(self) -> Array:
        """Signs s (k) of the deformations mirrored in a plane x = constant."""
        return np.repeat([-1.0, 1.0], [self.axial, self.fields.shape[1] - self.axial])


@dataclass(frozen=True, eq=False)
class CondensedPiece:
    """A leg or a piece of it in the mixed form q = C w + H v, g = −Hᵀw + S v.

    With k deformations v per face. `compliance` C (6×6, SI), wrench and relative twist at the
    middle of the piece; `twists` the root's half of H (6×k); `own` the block S_root,root (k×k, N/m)
    and `across` S_root,tip s (k×k, symmetric). `mirror` s (k) gives the tip's from these.
    """

    length: float
    compliance: Array
    twists: Array
    own: Array
    across: Array
    mirror: Array

    @property
    def tip_twists(self) -> Array:
        """The tip's half of H (6×k)."""
        return np.asarray(-_TWIST_MIRROR[:, None] * self.twists * self.mirror)

    @property
    def tip_own(self) -> Array:
        """S_tip,tip (k×k)."""
        return np.asarray(self.mirror[:, None] * self.own * self.mirror)

    @property
    def root_tip(self) -> Array:
        """S_root,tip (k×k)."""
        return np.asarray(self.across * self.mirror)


def condensed_leg(leg: ConstantLeg, section: SectionMesh, slices: int) -> CondensedPiece:
    """`leg` as `slices` equal slices of hexahedra on `section` (quad9), condensed.

    The discrete model is that of `extrude(section, stations(length, slices))`. Raises InputError
    for an impossible leg or fewer than one slice, ComputationError for elements that
    are folded or a slice that is not stiff.
    """
    with naming(leg.name):
        require_leg(leg.section, leg.length, 1)
        if slices < 1:
            raise InputError(f"slices = {slices}: must be at least 1")
        mesh = extrude(section, np.array([0.0, leg.length / slices]))
        face = _face_deformations(mesh, leg)
        slice_piece = _slice(mesh, leg, face)
    piece = slice_piece
    # The binary digits of n after the first: double, and add one slice where the digit is 1.
    for digit in f"{slices:b}"[1:]:
        piece = doubled(piece)
        if digit == "1":
            piece = joined(piece, slice_piece)
    return piece


def tip_compliance(piece: CondensedPiece, ends: Ends = "rigid") -> Array:
    """6×6 compliance (SI, leg axes) at (L, 0, 0), root held.

    `ends` as in `fem.bodies.solid.coupled_leg`.
    """
    compliance = piece.compliance
    if ends == "free":
        S, H = _deformation_stiffness(piece), np.hstack([piece.twists, piece.tip_twists])
        relaxed = solve_triangular(_cholesky(S, "leg with free ends"), H.T, lower=True)
        compliance = compliance + relaxed.T @ relaxed
    to_tip = shift(np.array([piece.length / 2.0, 0.0, 0.0]))
    tip_matrix = to_tip @ compliance @ to_tip.T
    return np.asarray((tip_matrix + tip_matrix.T) / 2.0)


def joined(first: CondensedPiece, second: CondensedPiece) -> CondensedPiece:
    """The two pieces end to end, the tip of `first` on the root of `second`, of equal slices."""
    length = first.length + second.length
    from_first = shift(np.array([(length - first.length) / 2.0, 0.0, 0.0]))
    from_second = shift(np.array([(second.length - length) / 2.0, 0.0, 0.0]))
    middle_twists = from_first @ first.tip_twists + from_second @ second.twists
    factor = _cholesky(first.tip_own + second.own, "face between slices")
    k = len(first.own)
    columns = np.hstack([first.root_tip.T, second.root_tip, middle_twists.T])
    solved = solve_triangular(factor, columns, lower=True, overwrite_b=True)
    to_root, to_tip, to_wrench = solved[:, :k], solved[:, k : 2 * k], solved[:, 2 * k :]
    compliance = from_first @ first.compliance @ from_first.T + (
        from_second @ second.compliance @ from_second.T + to_wrench.T @ to_wrench
    )
    across = (to_root.T @ to_tip) * -first.mirror
    return CondensedPiece(
        length=length,
        compliance=(compliance + compliance.T) / 2.0,
        twists=from_first @ first.twists - to_wrench.T @ to_root,
        own=first.own - to_root.T @ to_root,
        across=(across + across.T) / 2.0,
        mirror=first.mirror,
    )


def doubled(piece: CondensedPiece) -> CondensedPiece:
    """`joined(piece, piece)` by symmetry: the middle face's axial and in-face v do not couple.

    With Y = L⁻¹ S_tip,root, M = LLᵀ: S_root,root loses Σ YᵢᵀYᵢ over both kinds of deformation, and
    S_root,tip s is their difference.
    """
    to_middle = shift(np.array([piece.length / 2.0, 0.0, 0.0]))
    from_middle = shift(np.array([-piece.length / 2.0, 0.0, 0.0]))
    middle_twists = to_middle @ piece.tip_twists + from_middle @ piece.twists
    compliance = to_middle @ piece.compliance @ to_middle.T
    compliance += from_middle @ piece.compliance @ from_middle.T
    twists = to_middle @ piece.twists
    own = piece.own
    across = np.zeros_like(own)
    for sign in (-1.0, 1.0):
        kind = np.flatnonzero(piece.mirror == sign)
        factor = _cholesky(2.0 * piece.own[np.ix_(kind, kind)], "face between slices")
        columns = np.hstack([sign * piece.across[kind], middle_twists[:, kind].T])
        solved = solve_triangular(factor, columns, lower=True, overwrite_b=True)
        to_root, to_wrench = solved[:, :-6], solved[:, -6:]
        lost = to_root.T @ to_root
        own = own - lost
        across -= sign * lost
        compliance += to_wrench.T @ to_wrench
        twists -= to_wrench.T @ to_root
    return CondensedPiece(2.0 * piece.length, compliance, twists, own, across, piece.mirror)


def _face_deformations(mesh: SolidMesh, leg: ConstantLeg) -> _FaceDeformations:
    points = mesh.nodes[mesh.root.nodes]
    loads = saint_venant_loads(mesh.root, points, np.zeros(3), leg.material)
    along = np.arange(0, len(loads), 3)
    within = np.setdiff1d(np.arange(len(loads)), along)
    # Fx, My and Mz are axial tractions, Fy, Fz and Mx tractions within the face.
    axial = _complement(loads, along, np.array([0, 4, 5]))
    in_face = _complement(loads, within, np.array([1, 2, 3]))
    return _FaceDeformations(np.hstack([axial, in_face]), axial.shape[1])


def _complement(loads: Array, rows: IntArray, wrenches: IntArray) -> Array:
    """Orthonormal displacements (m×(rows − 3)) of the unknowns `rows` on which no load works."""
    basis, _ = qr(loads[np.ix_(rows, wrenches)])
    columns = np.zeros((len(loads), len(rows) - 3))
    columns[rows] = basis[:, 3:]
    return columns


def _slice(mesh: SolidMesh, leg: ConstantLeg, face: _FaceDeformations) -> CondensedPiece:
    """One slice in the mixed form, its nodes in between the faces condensed.

    A tip deformed as the root's mirror image (+) does not couple with one deformed in the opposite
    sense (−): S splits into own ± across. With + the plane of nodes in the middle moves within
    itself and the twist is of Fx, My, Mz; with − it moves along the leg. Each is summed over both
    ends: mirrored alone, rounding in K would hold a rigid motion.
    """
    K = stiffness(mesh, leg.material)
    m = len(face.fields)
    root, tip = slice(0, m), slice(K.shape[0] - m, None)
    between = np.arange(m, K.shape[0] - m)
    middle = np.array([mesh.length / 2.0, 0.0, 0.0])
    # Half the relative twist to either end: the slice stays its own mirror image.
    at_root = -0.5 * rigid_motions(mesh.nodes[mesh.root.nodes], middle)
    at_tip = 0.5 * rigid_motions(mesh.nodes[mesh.tip.nodes], middle)
    of_twist = K[:, root] @ at_root + K[:, tip] @ at_tip
    twist = at_root.T @ of_twist[root] + at_tip.T @ of_twist[tip]
    flip = diags_array(np.where(np.arange(m) % 3 == 0, -1.0, 1.0), format="csr")
    compliance, twists, halves = np.zeros((6, 6)), np.zeros((6, face.fields.shape[1])), []
    for sign in (1.0, -1.0):
        kind = between[(between % 3 == 0) == (sign < 0.0)]
        components = np.flatnonzero(sign * _TWIST_MIRROR < 0.0)
        columns_of_faces = (K[:, root] + sign * (K[:, tip] @ flip)).tocsr()
        ends = ((columns_of_faces[root] + sign * (flip @ columns_of_faces[tip])) / 2.0).tocsr()
        S = _by_deformations(_by_deformations(ends, face).T, face)
        q = twist[np.ix_(components, components)]
        to_root = _by_deformations(
            (of_twist[root] + sign * (flip @ of_twist[tip]))[:, components].T, face
        )
        if kind.size:
            factor = _cholesky(K[kind][:, kind].toarray(), "slice, plane of nodes in its middle")
            v = solve_triangular(factor, _by_deformations(columns_of_faces[kind], face), lower=True)
            w = solve_triangular(factor, of_twist[np.ix_(kind, components)], lower=True)
            S, q, to_root = S - v.T @ v / 2.0, q - w.T @ w, to_root - w.T @ v
        factor = _cholesky(q, "slice with rigid faces")
        coupling = solve_triangular(factor, to_root, lower=True)
        inverse = solve_triangular(factor, np.eye(len(components)), lower=True)
        compliance[np.ix_(components, components)] = inverse.T @ inverse
        twists[components] = -0.5 * inverse.T @ coupling
        S -= coupling.T @ coupling / 2.0
        halves.append((S + S.T) / 4.0)
    return CondensedPiece(
        length=mesh.length,
        compliance=compliance,
        twists=twists,
        own=halves[0] + halves[1],
        across=halves[0] - halves[1],
        mirror=face.mirror,
    )


def _by_deformations(matrix: Array | SparseMatrix, face: _FaceDeformations) -> Array:
    """matrix·N of a matrix with a column for each unknown of a face; N is zero across its kinds."""
    along = np.arange(len(face.fields)) % 3 == 0
    axial, in_face = face.fields[along, : face.axial], face.fields[~along, face.axial :]
    return np.hstack([matrix[:, along] @ axial, matrix[:, ~along] @ in_face])


def _deformation_stiffness(piece: CondensedPiece) -> Array:
    """S (2k×2k, N/m) of the deformations of root and tip, no wrench carried."""
    across = piece.root_tip
    return np.block([[piece.own, across], [across.T, piece.tip_own]])


def _cholesky(matrix: Array, part: str) -> Array:
    try:
        return np.asarray(cholesky(matrix, lower=True))
    except LinAlgError as error:
        raise ComputationError(
            "not positive definite; the slices are too thin or too long for their section",
            part=part,
        ) from error
