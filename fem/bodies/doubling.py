"""Statics of a leg of n equal slices in about log₂ n dense steps: condensation by doubling.

Two equal pieces are joined and their common face is condensed, which gives a piece twice as long
(substructures: Przemieniecki, AIAA J. 1 (1963) 138; doubling of the interval: Zhong, J. Comput.
Appl. Math. 163 (2004) 59). With the stiffness of the end faces this would lose digits in proportion
to the length: the stiffness EI/L³ is a small difference of entries of the size of a node's
stiffness. Therefore the pieces have a mixed form. Displacements of a face are split into its twist,
which is work conjugate to Saint-Venant's loads B, and the remaining deformation v: u = R Bᵀu + N v
with BᵀN = 0. For the relative twist q of the ends, the wrench w transmitted by a piece and the
loads g = Nᵀf of the faces

    q =  C w + H v        v = (v_root, v_tip), w and q at the middle of the piece
    g = −Hᵀw + S v

This is the force method for the six resultants, which are determined by statics in every face, and
the displacement method for deformations, which decay along the piece (Saint-Venant's principle).

If a piece a and a piece b are joined, their common face has g = 0, so that v = M⁻¹(…) there, with M
the sum of the two pieces' S on this face. The compliance of the new piece is

    C′ = X_a C_a X_aᵀ + X_b C_b X_bᵀ + H_m M⁻¹ H_mᵀ

with the shifts X of twists to the middle of the new piece, and H_m = X_a H_a + X_b H_b on the
common face. All three terms are positive: nothing cancels, rigid motions are exact, and the
condition of M is that of a face's mesh for any length. C is the compliance with rigid ends (v = 0).
The compliance with free ends (g = 0) is C + H S⁻¹ Hᵀ. Slices much shorter than the section's size h
lose digits, because S contains two very different stiffnesses: shear between the faces,
proportional to 1/l for slices of length l, and stretching of the faces, proportional to l. The
error is at most (h/l)² times the round-off.

A reversal of the leg (`fem.sections.reversal`) maps each piece to itself. As a rule, the reversal
is a reflection. With s (−1 for odd v, which are axial, +1 for even v, in the face) and Q = diag(−1,
1, 1, 1, −1, −1) for twists, S_tip,tip = s S_root,root s, S_root,tip s is symmetric, and H_tip = −Q
H_root s. At the middle of two equal pieces, odd and even deformations are therefore uncoupled. For
a wall of inclined fibres, the reversal is half a turn about y, with Q = diag(−1, 1, −1, −1, 1, −1).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, cholesky, qr, solve_triangular

from fem.bodies.solid import solid_leg
from fem.couplings.grips import rigid_motions, saint_venant_loads
from fem.sections.composite import wrench_states
from fem.sections.moduli import leg_moduli
from fem.sections.reversal import Reversal, reversal_of
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError, InputError, naming
from lumped.legs import ConstantLeg
from lumped.model_choices import Ends
from lumped.screws import shift
from meshes.prism import extrude
from meshes.section.section_mesh import SectionMesh, require_leg
from meshes.solid_mesh import SolidMesh


@dataclass(frozen=True, eq=False)
class _FaceDeformations:
    """Deformations N (m×k) of a face with m unknowns, on which Saint-Venant's six loads do no work.

    There are k = m − 6 of them, and they are orthonormal. The first i are combinations `odd`
    (columns) of the odd fields of `reversal`, the other j are combinations `even` (columns) of its
    even fields.
    """

    reversal: Reversal
    odd: Array
    even: Array

    @property
    def mirror(self) -> Array:
        """Signs s (k values) of the deformations under a reversal of the leg."""
        return np.repeat([-1.0, 1.0], [self.odd.shape[1], self.even.shape[1]])


@dataclass(frozen=True, eq=False)
class CondensedPiece:
    """A leg or a piece of it in the mixed form q = C w + H v, g = −Hᵀw + S v.

    w is the wrench and q the relative twist of the ends, at the middle of the piece. v are the k
    deformations of each face and g the forces conjugate to v. `mirror` s (k) and `twist_mirror` Q
    (6) are the signs by which a reversal maps deformations and twists of the root to the tip.
    `compliance` is C (6×6, SI). `twists` (6×k) is the part of H for the root. `own` (k×k, in N/m)
    is the block S_root,root. `across` (k×k, in N/m) is the block S_root,tip times diag(s), which is
    symmetric. The other blocks follow by reversal. `length` is in m.
    """

    length: float
    compliance: Array
    twists: Array
    own: Array
    across: Array
    mirror: Array
    twist_mirror: Array

    @property
    def tip_twists(self) -> Array:
        """Relative twists (6×k) of the ends, one for each of the k deformations of the tip.

        The deformation has unit amplitude. The wrench and the deformations of the root are zero.
        """
        return np.asarray(-self.twist_mirror[:, None] * self.twists * self.mirror)

    @property
    def tip_own(self) -> Array:
        """Stiffness (k×k, in N/m) of the tip's deformations, with the root's deformations fixed."""
        return np.asarray(self.mirror[:, None] * self.own * self.mirror)

    @property
    def root_tip(self) -> Array:
        """Coupling stiffness (k×k, in N/m) between the deformations of root and tip."""
        return np.asarray(self.across * self.mirror)


def condensed_leg(leg: ConstantLeg, section: SectionMesh, slices: int) -> CondensedPiece:
    """Leg of `slices` equal slices of hexahedra on the mesh `section` (quad9), condensed.

    The finite element model is that of `extrude(section, stations(length, slices))`. Raises
    InputError if the leg is not valid or `slices` is below 1, ComputationError if elements are
    folded or the stiffness of a slice is not positive definite.
    """
    with naming(leg.name):
        require_leg(leg.section, leg.length, 1)
        if slices < 1:
            raise InputError(f"slices = {slices}: must be at least 1")
        mesh = extrude(section, np.array([0.0, leg.length / slices]))
        face = _face_deformations(mesh, leg)
        slice_piece = _slice(mesh, leg, face)
    piece = slice_piece
    # For each binary digit of n after the first: double, and add one slice if the digit is 1.
    for digit in f"{slices:b}"[1:]:
        piece = doubled(piece)
        if digit == "1":
            piece = joined(piece, slice_piece)
    return piece


def tip_compliance(piece: CondensedPiece, ends: Ends = "rigid") -> Array:
    """6×6 compliance (SI, leg axes) at the tip (L, 0, 0) with the root clamped.

    `ends` is the condition on both end faces: "rigid", or "free" to warp and contract.
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
    """Join two pieces of equal slices: the tip of `first` to the root of `second`."""
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
        twist_mirror=first.twist_mirror,
    )


def doubled(piece: CondensedPiece) -> CondensedPiece:
    """Join two equal pieces: the result of `joined(piece, piece)` with half the work, by symmetry.

    The deformations v of the middle face are odd or even, and both kinds are uncoupled. For each
    kind, with the sum M = LLᵀ of the stiffnesses of both pieces on this face, Y = L⁻¹ S_tip,root is
    computed. S_root,root decreases by the sum of YᵀY over both kinds. The new S_root,tip s is YᵀY
    of odd deformations minus that of even ones.
    """
    to_middle = shift(np.array([piece.length / 2.0, 0.0, 0.0]))
    from_middle = shift(np.array([-piece.length / 2.0, 0.0, 0.0]))
    middle_twists = to_middle @ piece.tip_twists + from_middle @ piece.twists
    compliance = to_middle @ piece.compliance @ to_middle.T
    compliance += from_middle @ piece.compliance @ from_middle.T
    twists = to_middle @ piece.twists
    root_block = piece.own
    across = np.zeros_like(root_block)
    for sign in (-1.0, 1.0):
        kind = np.flatnonzero(piece.mirror == sign)
        factor = _cholesky(2.0 * piece.own[np.ix_(kind, kind)], "face between slices")
        columns = np.hstack([sign * piece.across[kind], middle_twists[:, kind].T])
        solved = solve_triangular(factor, columns, lower=True, overwrite_b=True)
        to_root, to_wrench = solved[:, :-6], solved[:, -6:]
        lost = to_root.T @ to_root
        root_block = root_block - lost
        across -= sign * lost
        compliance += to_wrench.T @ to_wrench
        twists -= to_wrench.T @ to_root
    return replace(
        piece,
        length=2.0 * piece.length,
        compliance=compliance,
        twists=twists,
        own=root_block,
        across=across,
    )


def _face_deformations(mesh: SolidMesh, leg: ConstantLeg) -> _FaceDeformations:
    face = mesh.root.mesh
    moduli = leg_moduli(leg, face)
    if moduli:
        loads = wrench_states(face, moduli).tractions
    else:
        points = mesh.nodes[mesh.root.nodes]
        loads = saint_venant_loads(mesh.root, points, np.zeros(3), leg.material)
    reversal = reversal_of(face.nodes, moduli or leg.material)
    # Wrenches whose twists change sign, Fx, My and Mz as a rule, have odd tractions.
    odd, even = (
        _complement(basis.T @ loads[:, reversal.twists == sign])
        for basis, sign in ((reversal.odd, -1.0), (reversal.even, 1.0))
    )
    return _FaceDeformations(reversal, odd, even)


def _complement(loads: Array) -> Array:
    """Orthonormal displacements (n×(n − w)) on which w loads (n×w) do no work."""
    basis, _ = qr(loads)
    return np.asarray(basis[:, loads.shape[1] :])


def _slice(mesh: SolidMesh, leg: ConstantLeg, face: _FaceDeformations) -> CondensedPiece:
    """One slice of a leg in the mixed form, condensed to its two faces.

    Deformations of the faces are divided into a part (+), in which the tip mirrors the root, and a
    part (−), in which it mirrors the root with opposite sign. The two parts are not coupled: they
    give the stiffnesses `own` + `across` and `own` − `across`. With (+), the nodes in the middle
    plane have even motions, within this plane as a rule, and the relative twist has only the
    components that a reversal changes, conjugate to Fx, My and Mz. With (−), their motions are odd,
    and the relative twist has the other components. Both stiffnesses are averaged over root and
    tip, because round-off in K would otherwise resist rigid motions.
    """
    K = solid_leg(leg, mesh).stiffness
    reversal = face.reversal
    m = 3 * len(reversal.images)
    root, tip = slice(0, m), slice(K.shape[0] - m, None)
    between = np.arange(m, K.shape[0] - m)
    middle = np.array([mesh.length / 2.0, 0.0, 0.0])
    # Each end has half of the relative twist, so that the slice is its own mirror image.
    at_root = -0.5 * rigid_motions(mesh.nodes[mesh.root.nodes], middle)
    at_tip = 0.5 * rigid_motions(mesh.nodes[mesh.tip.nodes], middle)
    of_twist = K[:, root] @ at_root + K[:, tip] @ at_tip
    twist = at_root.T @ of_twist[root] + at_tip.T @ of_twist[tip]
    flip = reversal.matrix
    compliance, twists, halves = np.zeros((6, 6)), np.zeros((6, len(face.mirror))), []
    for sign, moving in ((1.0, reversal.even), (-1.0, reversal.odd)):
        components = np.flatnonzero(sign * reversal.twists < 0.0)
        columns_of_faces = (K[:, root] + sign * (K[:, tip] @ flip)).tocsr()
        ends = ((columns_of_faces[root] + sign * (flip @ columns_of_faces[tip])) / 2.0).tocsr()
        S = _by_deformations(_by_deformations(ends, face).T, face)
        q = twist[np.ix_(components, components)]
        to_root = _by_deformations(
            (of_twist[root] + sign * (flip @ of_twist[tip]))[:, components].T, face
        )
        if between.size:
            middle_plane = (moving.T @ K[between][:, between] @ moving).toarray()
            factor = _cholesky(middle_plane, "slice, plane of nodes in its middle")
            of_faces = _by_deformations((moving.T @ columns_of_faces[between]).tocsr(), face)
            v = solve_triangular(factor, of_faces, lower=True)
            of_twists = moving.T @ of_twist[np.ix_(between, components)]
            w = solve_triangular(factor, of_twists, lower=True)
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
        twist_mirror=reversal.twists,
    )


def _by_deformations(matrix: Array | SparseMatrix, face: _FaceDeformations) -> Array:
    """Product (r×k) of `matrix` (r×m) with the deformations N (m×k) of a face with m unknowns."""
    odd, even = matrix @ face.reversal.odd, matrix @ face.reversal.even
    return np.hstack([odd @ face.odd, even @ face.even])


def _deformation_stiffness(piece: CondensedPiece) -> Array:
    """Stiffness S (2k×2k, in N/m) of the deformations of root and tip, without a wrench."""
    across = piece.root_tip
    return np.block([[piece.own, across], [across.T, piece.tip_own]])


def _cholesky(matrix: Array, part: str) -> Array:
    try:
        return np.asarray(cholesky(matrix, lower=True))
    except LinAlgError as error:
        raise ComputationError(
            "the stiffness matrix is not positive definite; the slices are too thin or too long "
            "for their section",
            part=part,
        ) from error
