"""Couplings of faces of a solid to an interface: rigid, averaged, pin, or Saint-Venant tractions.

rigid    u = R q on the faces: they move as one body with the interface's twist q.
average  q = (RᵀWR)⁻¹RᵀWu with the faces' consistent area weights W (∫N_a N_b dA); a wrench loads
         the nodes by the transpose. The faces deform freely.
pin      each point of a bore moves radially with q and slides freely along and about the axis. The
         remaining two components of q are the bore's mean motions. Freedom of a joint along and
         about the axis is modelled by the joint, not by the coupling.
saint-venant  q = Bᵀu with the nodal loads B of the tractions of Saint-Venant's solution for unit
         wrenches, BᵀR = I: an end of a prism free to warp and to contract.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import csr_array

from fem.sections.saint_venant import saint_venant
from fem.sections.section_constants import poisson_shear_ratio
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.legs import Material
from lumped.screws import shift
from meshes.part.boundary import Facets
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import EndFace

Kind: TypeAlias = Literal["rigid", "average", "pin", "saint-venant"]

# Twice the order of second-order facets, and two more for their curvature.
_FACE_DEGREE = 6
# Own unknowns of an interface before those of the nodes.
OWN: dict[Kind, int] = {"rigid": 6, "average": 0, "pin": 4, "saint-venant": 0}


def unknowns(nodes: IntArray) -> IntArray:
    """Unknowns 3·node + component (3n) of `nodes` (n), node by node."""
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()


def rigid_motions(points: Array, reference: Array) -> Array:
    """Displacements (3n×6) of `points` (n×3, m) for unit twists at `reference` (3, m)."""
    x, y, z = (np.asarray(points) - reference).T
    motions = np.zeros((len(points), 3, 6))
    motions[:, :, :3] = np.eye(3)
    motions[:, 0, 4], motions[:, 0, 5] = z, -y
    motions[:, 1, 3], motions[:, 1, 5] = -z, x
    motions[:, 2, 3], motions[:, 2, 4] = y, -x
    return motions.reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class Grip:
    """Faces of a solid with their coupling to one interface.

    `facets` on its nodes, reference `point` (3, m); `axis` (unit vector) of a pin's bore and a
    point `on_axis` (3, m) of it; `tractions` (3n×6): Saint-Venant's nodal loads.
    """

    kind: Kind
    facets: Facets
    point: Array
    axis: Array | None = None
    on_axis: Array | None = None
    tractions: Array | None = None

    @property
    def nodes(self) -> IntArray:
        """The held nodes, ascending."""
        return self.facets.nodes

    @property
    def own(self) -> Array:
        """Its own unknowns (k×6) from the twist at its point.

        All of it for a rigid interface; for a pin the translations and rotations across the bore's
        axis, of a point on it.
        """
        if self.kind != "pin":
            return np.eye(OWN[self.kind], 6)
        return _across(self.bore_axis) @ shift(self.centre - self.point)

    @property
    def centre(self) -> Array:
        """A point of the bore's axis, or the reference point if there is no bore."""
        return self.point if self.on_axis is None else self.on_axis

    @property
    def bore_axis(self) -> Array:
        """Axis (unit vector) of the bore. Raises ValueError if there is none."""
        if self.axis is None:
            raise ValueError("a pin needs the axis of its bore")
        return self.axis

    def local_axes(self, nodes: Array) -> Array:
        """Radial, tangential and axial unit vectors (n×3×3, columns) at a pin's nodes."""
        offsets = nodes[self.nodes] - self.centre
        offsets = offsets - np.outer(offsets @ self.bore_axis, self.bore_axis)
        radial = offsets / np.linalg.norm(offsets, axis=1)[:, None]
        axial = np.broadcast_to(self.bore_axis, radial.shape)
        return np.stack([radial, np.cross(axial, radial), axial], axis=2)

    def motions(self, nodes: Array) -> Array:
        """Displacements (3n×6) of its nodes for unit twists at its point."""
        return rigid_motions(nodes[self.nodes], self.point)

    def loads(self, nodes: Array) -> Array:
        """Nodal loads (3n×6) of six independent wrenches on freely deforming faces."""
        if self.tractions is not None:
            return self.tractions
        count = len(self.nodes)
        moments = area_weights(nodes, self.facets) @ self.motions(nodes).reshape(count, -1)
        return np.asarray(moments.reshape(-1, 6))

    def radial_motions(self, nodes: Array) -> Array:
        """Radial displacements (n×4) of a pin's nodes for its own unknowns."""
        fields = rigid_motions(nodes[self.nodes], self.centre).reshape(-1, 3, 6)
        radial = self.local_axes(nodes)[:, :, 0]
        along = np.einsum("ni,nij->nj", radial, fields)
        return np.asarray(along @ _across(self.bore_axis).T)


def _across(axis: Array) -> Array:
    """Components (4×6) of a twist along and about two directions across an axis."""
    rows = np.zeros((4, 6))
    rows[:2, :3] = rows[2:, 3:] = np.linalg.svd(axis[None])[2][1:]
    return rows


def area_weights(nodes: Array, facets: Facets) -> SparseMatrix:
    """W = ∫N_a N_b dA (csr n×n, m²) on the n nodes of `facets`, ascending."""
    points, weights = quadrature(facets.element, _FACE_DEGREE)
    shapes, slopes = values(facets.element, points), gradients(facets.element, points)
    tangents = np.einsum("fki,kjq->fqij", nodes[facets.cells], slopes)
    areas = np.linalg.norm(np.cross(tangents[..., 0], tangents[..., 1]), axis=-1) * weights
    blocks = np.einsum("fq,aq,bq->fab", areas, shapes, shapes, optimize=True)
    local = np.searchsorted(facets.nodes, facets.cells)
    rows, columns = np.broadcast_arrays(local[:, :, None], local[:, None, :])
    size = len(facets.nodes)
    places = (rows.ravel(), columns.ravel())
    return csr_array((blocks.ravel(), places), shape=(size, size))


def saint_venant_loads(face: EndFace, points: Array, reference: Array, material: Material) -> Array:
    """Consistent nodal loads (3n×6) of unit wrenches at `reference` (3, m) on an end face.

    Tractions of Saint-Venant's solution: uniform for Fx, flexural shear for Fy and Fz, torsion's
    shear for Mx, linear σxx for My and Mz. `points` (n×3, m) are the face's nodes, rows of the
    result 3·(place in face.nodes) + component. BᵀR = I to rounding for the rigid motions R.
    """
    ratio = poisson_shear_ratio(material.nu, material.G / material.E)
    section = saint_venant(face.mesh, ratio)
    quad = section.quadrature
    y, z = quad.points
    # σxx = M·(c·s) with the bending moments Mz = −∫y σxx and My = +∫z σxx.
    along_y, along_z = (slope[0] * y + slope[1] * z for slope in section.slopes)
    loads = np.zeros((len(points), 3, 6))
    axial = {0: np.full_like(y, 1.0 / section.area), 4: along_z, 5: -along_y}
    for wrench, traction in axial.items():
        loads[:, 0, wrench] = quad.load(traction)
    force_y, force_z = section.centroid_force_stress()
    for wrench, tractions in {1: force_y, 2: force_z, 3: section.torsion_stress()}.items():
        for component, traction in enumerate(tractions, start=1):
            loads[:, component, wrench] = quad.load(traction)
    at_centroid = loads.reshape(-1, 6)
    # Moves the wrenches from the mesh's own centroid to the reference point.
    work = at_centroid.T @ rigid_motions(points, reference)
    return np.asarray(np.linalg.solve(work, at_centroid.T).T)
