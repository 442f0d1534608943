"""Stresses of beam theory in a section, at the nodes of its mesh.

    σxx = N/A + b·s,   Σ b = (−Mz, My),   s = (y, z) from the centroid,  Σ = ∫ s sᵀ dA
    τ = T τ_T + Qy τ_y + Qz τ_z        (Saint-Venant's torsion and flexure)
    σ_v = √(σxx² + 3 (τxy² + τxz²))

In an arc with the curvature (ky, kz) of its line, the length of the fibre at s is that of the line
times 1 − ξ with ξ = ky y + kz z. The strain of fibres is then hyperbolic (Winkler):

    σxx = p·P⁻¹(N, My, Mz)/(1 − ξ),   p = (1, z, −y),   P = ∫ p pᵀ/(1 − ξ) dA

The shear stresses of Qy and Qz have no moment about the centroid. In walls they are Jourawski's
QS/(It), in stout sections they vary across the wall. Stresses of restrained warping at end faces
and local stresses at joints are not included. The shear stress at a sharp re-entrant corner is
unbounded. Real corners have a fillet, and their notch factor must be applied there. Nodes nearer to
such a corner than half the mean thickness of the walls are therefore excluded from the largest
stress.
"""

from dataclasses import dataclass, replace
from math import pi
from typing import TypeAlias

import numpy as np

from fem.sections.saint_venant import saint_venant, section_quadrature
from fem.sections.section_constants import poisson_shear_ratio
from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from lumped.legs import Material
from lumped.memo import memo
from meshes.elements import ELEMENTS
from meshes.reentrant_edges import SHARP
from meshes.section.section_mesh import SectionMesh
from meshes.shape_functions import gradients

# Components (1/m) of the curvature of a line along the y and z axes of a section.
Curvature: TypeAlias = tuple[float, float]


@dataclass(frozen=True, eq=False)
class SectionStresses:
    """Stresses under unit section forces at N `points` (N×2; y and z in m), nodes of a mesh.

    The six section forces are N, Qy, Qz (1 N each), T, My and Mz (1 N m each). `normal` (N×6) is
    σxx and `shear` (2×N×6) are τxy and τxz (Pa). `regular` (N) is False near re-entrant corners.
    """

    points: Array
    normal: Array
    shear: Array
    regular: Array

    def von_mises(self, forces: Array) -> Array:
        """Von Mises stress (s×N, in Pa) at all nodes under s sets of section forces.

        `forces` (s×6) are multiples of the unit section forces.
        """
        normal = forces @ self.normal.T
        shear = self.shear @ forces.T
        return np.asarray(np.sqrt(normal**2 + 3.0 * (shear**2).sum(axis=0).T))


@memo(64)
def section_stresses(mesh: SectionMesh, material: Material) -> SectionStresses:
    """Stresses under unit section forces on a section `mesh` of one material.

    Raises ComputationError if the mesh is not connected or has inverted cells.
    """
    ratio = poisson_shear_ratio(material.nu, material.G / material.E)
    solution = saint_venant(mesh, ratio)
    quad = solution.quadrature
    y, z = places = mesh.nodes.T - quad.centroid[:, None]
    slope = NodalGradient(mesh)
    turning = np.stack([-z, y])
    twist = slope(solution.warping) + turning
    anticlastic = np.array([[(y**2 - z**2) / 2.0, y * z], [y * z, (z**2 - y**2) / 2.0]])
    shear = np.zeros((2, len(mesh.nodes), 6))
    shear[:, :, 3] = twist / solution.torsion_constant
    for axis in (0, 1):
        flexure = slope(solution.flexure[axis])
        flexure -= ratio * np.tensordot(solution.slopes[axis], anticlastic, axes=1)
        flexure -= solution.twist_shares[axis] * turning
        shear[:, :, 1 + axis] = flexure - solution.flexure_torque[axis] * shear[:, :, 3]
    normal = np.zeros((len(mesh.nodes), 6))
    normal[:, 0] = 1.0 / solution.area
    about_y, about_z = np.linalg.solve(solution.moments, [[0.0, -1.0], [1.0, 0.0]]).T
    normal[:, 4], normal[:, 5] = about_y @ places, about_z @ places
    regular = regular_nodes(mesh, solution.area / perimeter(mesh))
    return SectionStresses(mesh.nodes, normal, shear, regular)


def curved_stresses(mesh: SectionMesh, material: Material, curvature: Curvature) -> SectionStresses:
    """Stresses under unit section forces on a section `mesh` of an arc, by Winkler's theory.

    `curvature` (1/m) are the components of the line's curvature along the section's axes y and z.
    Shear stresses are those of a straight leg. Raises ComputationError if the centre of the arc
    lies in the section.
    """
    straight = section_stresses(mesh, material)
    if not any(curvature):
        return straight
    quad = section_quadrature(mesh)
    points = quad.points
    nodes = mesh.nodes.T - quad.centroid[:, None]
    lengths, lengths_at_nodes = (1.0 - np.tensordot(curvature, s, axes=1) for s in (points, nodes))
    if not (lengths_at_nodes > 0.0).all():
        raise ComputationError("section of an arc: the centre of the arc lies in the section")
    states, states_at_nodes = (np.stack([np.ones_like(s[0]), s[1], -s[0]]) for s in (points, nodes))
    matrix = quad.integral(states[:, None] * states / lengths)
    normal = straight.normal.copy()
    normal[:, [0, 4, 5]] = (np.linalg.solve(matrix, states_at_nodes) / lengths_at_nodes).T
    return replace(straight, normal=normal)


@memo(64)
def arc_stresses(
    mesh: SectionMesh, material: Material, curvature: Curvature, length: float
) -> Array:
    """Normal stresses (N×6, Pa) that Winkler's theory lacks on an arc, to first order.

    They are magnitudes at the N nodes under the unit section forces of `SectionStresses`, and a sum
    of three. The first two are due to changes of the shear forces along the arc, Q′ = −k N, and of
    the torque, T′ = k·(My, Mz), with the components k of the curvature. Cross-sections warp by ΨQ/G
    and ωT/GJ, and σ = E w′. Their force and moments are zero. In a rectangle under N the first is
    N k h²/5I at the faces. In the third, Poisson's contraction in bending displaces fibres towards
    the centre of the arc. Transverse stresses cancel its part along this direction.

    In thin open sections warping in torsion restrains the twist. On the `length` of a line (m) with
    free ends the bimoment is at most T′ L²/8 (B″ = B/λ² − T′, maximum principle).
    """
    ratio = poisson_shear_ratio(material.nu, material.G / material.E)
    solution = saint_venant(mesh, ratio)
    quad = solution.quadrature
    y, z = places = mesh.nodes.T - quad.centroid[:, None]
    states, at_points = (np.stack([np.ones_like(s[0]), *s]) for s in (places, quad.points))
    matrix = quad.integral(at_points[:, None] * at_points)

    def without_forces(field: Array) -> Array:
        forces = quad.integral(quad.value(field) * at_points)
        return np.asarray(field - np.linalg.solve(matrix, forces) @ states)

    k_y, k_z = curvature
    modulus = material.E / material.G
    lacking = np.zeros((len(y), 6))
    for k, warping in zip(curvature, solution.flexure, strict=True):
        lacking[:, 0] += modulus * np.abs(k * without_forces(warping))
    warping = without_forces(solution.warping)
    warping_constant = float(quad.integral(quad.value(warping) ** 2))
    restrained = length**2 * solution.torsion_constant / (8.0 * modulus * warping_constant)
    per_torque = modulus * min(1.0, restrained) * np.abs(warping) / solution.torsion_constant
    inwards = np.stack([k_z * y * z - 0.5 * k_y * z**2, k_y * y * z - 0.5 * k_z * y**2])
    # Slopes of the stress along y and z under unit moments My and Mz.
    slopes = np.linalg.solve(solution.moments, [[0.0, -1.0], [1.0, 0.0]]).T
    for column, k, slope in zip((4, 5), curvature, slopes, strict=True):
        of_contraction = material.nu * without_forces(slope @ inwards)
        lacking[:, column] = abs(k) * per_torque + np.abs(of_contraction)
    return lacking


class NodalGradient:
    """Gradient (2×N, in 1/m) of nodal values at the N nodes: the mean over adjacent cells."""

    def __init__(self, mesh: SectionMesh) -> None:
        self._mesh = mesh
        local = gradients(mesh.element, ELEMENTS[mesh.element].nodes.T)
        jacobian = np.einsum("mki,kjq->mqij", mesh.nodes[mesh.cells], local, optimize=True)
        self._gradients = np.einsum("kjq,mqji->mkiq", local, np.linalg.inv(jacobian), optimize=True)
        self._counts = np.bincount(mesh.cells.ravel(), minlength=len(mesh.nodes))

    def __call__(self, nodal: Array) -> Array:
        """Derivatives (2×N) along y and z of the field with the values `nodal` (N)."""
        cells = self._mesh.cells
        by_cell = np.einsum("mkiq,mk->imq", self._gradients, nodal[cells], optimize=True)
        return np.array(
            [
                np.bincount(cells.ravel(), row.ravel(), minlength=len(self._counts)) / self._counts
                for row in by_cell
            ]
        )


def regular_nodes(mesh: SectionMesh, distance: float) -> Array:
    """Flags of the N nodes of a section mesh: False within `distance` (m) of re-entrant corners."""
    return apart_from(reentrant_corners(mesh), mesh.nodes, distance)


def reentrant_corners(mesh: SectionMesh) -> Array:
    """Positions (c×2; y and z in m) of the c re-entrant corners of a section mesh."""
    rim = rim_edges(mesh)
    on_rim = np.zeros(len(mesh.nodes), dtype=bool)
    on_rim[rim.ravel()] = True
    return np.asarray(mesh.nodes[on_rim & (_angles(mesh) > pi + SHARP)])


def apart_from(corners: Array, points: Array, distance: float) -> Array:
    """Flags of N `points` (N×2): False within `distance` (m) of one of the `corners` (c×2)."""
    if not len(corners):
        return np.ones(len(points), dtype=bool)
    distances = np.linalg.norm(points[:, None] - corners, axis=2).min(axis=1)
    return np.asarray(distances > distance)


def perimeter(mesh: SectionMesh) -> float:
    """Length (m) of the boundary of a section.

    In thin walls, twice the area divided by this length is the thickness.
    """
    return float(np.linalg.norm(np.diff(mesh.nodes[rim_edges(mesh)], axis=1), axis=2).sum())


def rim_edges(mesh: SectionMesh) -> IntArray:
    """Corner nodes (e×2) of the e edges on the boundary, each of which belongs to one cell only."""
    corners = mesh.cells[:, list(ELEMENTS[mesh.element].corner_nodes)]
    edges = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2))
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(unique[counts == 1])


def _angles(mesh: SectionMesh) -> Array:
    """Angle (rad) that the section fills about each of the N nodes.

    Zero for nodes that are not corners of cells.
    """
    kind = ELEMENTS[mesh.element]
    corners = list(kind.corner_nodes)
    places = kind.nodes[corners]
    local = gradients(mesh.element, places.T)
    jacobian = np.einsum("mki,kjq->mqij", mesh.nodes[mesh.cells], local, optimize=True)
    following, before = (np.roll(places, shift, axis=0) - places for shift in (-1, 1))
    first = np.einsum("mqij,qj->mqi", jacobian, following)
    last = np.einsum("mqij,qj->mqi", jacobian, before)
    cross = first[..., 0] * last[..., 1] - first[..., 1] * last[..., 0]
    angles = np.zeros(len(mesh.nodes))
    np.add.at(angles, mesh.cells[:, corners], np.arctan2(cross, (first * last).sum(axis=2)))
    return angles
