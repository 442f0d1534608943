"""Couplings of faces of a solid to an interface: rigid, averaged, pin, or Saint-Venant's tractions.

u are the displacements of the nodes of the faces, q is the twist of the interface, and R are the
displacements of the nodes in the six rigid motions.

- rigid: u = R q on the faces, which move as one body with the interface.
- average: q = (RᵀWR)⁻¹RᵀWu with the consistent area weights W of the faces (∫N_a N_b dA). A wrench
  is distributed to the nodes by the transpose. The faces can deform freely.
- pin: each point of a bore moves radially with q and can slide along and about the axis. The
  remaining two components of q are the mean motions of the bore along and about the axis. If the
  joint is free along or about the axis, this is specified in the joint, not in the coupling.
- saint-venant: q = Bᵀu with the nodal loads B of Saint-Venant's tractions for unit wrenches, BᵀR =
  I. This is an end of a prism that is free to warp and to contract.
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

# Degree of quadrature on faces: twice the order of second-order facets, plus two for curvature.
_FACE_DEGREE = 6
# Number of unknowns of an interface in addition to the displacements of nodes, by kind of coupling.
OWN: dict[Kind, int] = {"rigid": 6, "average": 0, "pin": 4, "saint-venant": 0}


def unknowns(nodes: IntArray) -> IntArray:
    """Indices 3·node + component (3n) of the displacements of `nodes` (n), node by node."""
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()


def rigid_motions(points: Array, reference: Array) -> Array:
    """Displacements (3n×6) of `points` (n×3, in m) for unit twists at `reference` (3, in m)."""
    x, y, z = (np.asarray(points) - reference).T
    motions = np.zeros((len(points), 3, 6))
    motions[:, :, :3] = np.eye(3)
    motions[:, 0, 4], motions[:, 0, 5] = z, -y
    motions[:, 1, 3], motions[:, 1, 5] = -z, x
    motions[:, 2, 3], motions[:, 2, 4] = y, -x
    return motions.reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class Grip:
    """Faces of a solid and their coupling to one interface.

    `kind` is the kind of coupling. `facets` are the facets of the faces, with node numbers of the
    solid, and `point` (3, in m) is the reference point. `axis` (unit vector) is the axis of a bore,
    and `on_axis` (3, in m) is a point on this axis. Both are None if the faces are no bore.
    `tractions` (3n×6) are Saint-Venant's nodal loads. None except for the kind "saint-venant".
    """

    kind: Kind
    facets: Facets
    point: Array
    axis: Array | None = None
    on_axis: Array | None = None
    tractions: Array | None = None

    @property
    def nodes(self) -> IntArray:
        """Indices of the nodes of the faces, ascending."""
        return self.facets.nodes

    @property
    def own(self) -> Array:
        """Matrix (k×6) from the twist of the interface to its k unknowns.

        The unknowns of a rigid interface are its twist. The unknowns of a pin are translations and
        rotations perpendicular to the axis of the bore, at a point on the axis. Other interfaces
        have none.
        """
        if self.kind != "pin":
            return np.eye(OWN[self.kind], 6)
        return _across(self.bore_axis) @ shift(self.centre - self.point)

    @property
    def centre(self) -> Array:
        """A point on the axis of the bore, or the reference point if there is no bore."""
        return self.point if self.on_axis is None else self.on_axis

    @property
    def bore_axis(self) -> Array:
        """Axis (unit vector) of the bore. Raises ValueError if there is no bore."""
        if self.axis is None:
            raise ValueError(
                "a coupling by a pin is available only for a bore, whose axis it needs"
            )
        return self.axis

    def local_axes(self, nodes: Array) -> Array:
        """Radial, tangential and axial unit vectors (n×3×3, columns) at the nodes of a pin.

        `nodes` (N×3, in m) are those of the solid, as in the other methods.
        """
        offsets = nodes[self.nodes] - self.centre
        offsets = offsets - np.outer(offsets @ self.bore_axis, self.bore_axis)
        radial = offsets / np.linalg.norm(offsets, axis=1)[:, None]
        axial = np.broadcast_to(self.bore_axis, radial.shape)
        return np.stack([radial, np.cross(axial, radial), axial], axis=2)

    def motions(self, nodes: Array) -> Array:
        """Displacements (3n×6) of the nodes of the faces for unit twists at the reference point."""
        return rigid_motions(nodes[self.nodes], self.point)

    def loads(self, nodes: Array) -> Array:
        """Nodal loads (3n×6) with six independent resultants on faces that can deform freely.

        They are the tractions if there are any, otherwise uniform and linear loads on the area. In
        general their resultants are not unit wrenches.
        """
        if self.tractions is not None:
            return self.tractions
        count = len(self.nodes)
        moments = area_weights(nodes, self.facets) @ self.motions(nodes).reshape(count, -1)
        return np.asarray(moments.reshape(-1, 6))

    def radial_motions(self, nodes: Array) -> Array:
        """Radial displacements (n×4) of the nodes of a bore, for unit unknowns of its pin."""
        fields = rigid_motions(nodes[self.nodes], self.centre).reshape(-1, 3, 6)
        radial = self.local_axes(nodes)[:, :, 0]
        along = np.einsum("ni,nij->nj", radial, fields)
        return np.asarray(along @ _across(self.bore_axis).T)


def _across(axis: Array) -> Array:
    """Matrix (4×6) from a twist to its two translations and two rotations normal to `axis`."""
    rows = np.zeros((4, 6))
    rows[:2, :3] = rows[2:, 3:] = np.linalg.svd(axis[None])[2][1:]
    return rows


def area_weights(nodes: Array, facets: Facets) -> SparseMatrix:
    """Area weights W = ∫N_a N_b dA (csr n×n, in m²) of the n nodes of `facets`, ascending."""
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
    """Consistent nodal loads B (3n×6) of unit wrenches at `reference` (3, in m) on an end face.

    The tractions are those of Saint-Venant's solution: uniform for Fx, flexural shear for Fy and
    Fz, torsional shear for Mx, linear σxx for My and Mz. `points` (n×3, in m) are the nodes of the
    face in the order of `face.nodes`. BᵀR = I to round-off for the rigid motions R of the nodes.
    """
    ratio = poisson_shear_ratio(material.nu, material.G / material.E)
    section = saint_venant(face.mesh, ratio)
    quad = section.quadrature
    y, z = quad.points
    # σxx is linear in y and z, with the bending moments Mz = −∫y σxx dA and My = ∫z σxx dA.
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
    # The wrenches are transferred from the centroid of the mesh to the reference point.
    work = at_centroid.T @ rigid_motions(points, reference)
    return np.asarray(np.linalg.solve(work, at_centroid.T).T)
