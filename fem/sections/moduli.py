"""Elasticity and density in a section of several materials.

Elasticity matrices (6×6, Pa) relate the stresses (xx, yy, zz, yz, xz, xy) to the strains (εxx, εyy,
εzz, γyz, γxz, γxy) in the axes of the leg.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fem.sections.saint_venant import SectionQuadrature
from fem.sections.waveguide import elasticity
from lumped.arrays import Array, IntArray
from lumped.legs import ConstantLeg, Material, SectionedLeg
from lumped.sections import Composite, Laminate, LaminateBox, Layer
from meshes.section.section_mesh import SectionMesh


@dataclass(frozen=True, eq=False)
class Moduli:
    """Elasticity and density of the M cells of a section mesh.

    `at` is a function of the numbers (m) of m cells and of Q points in each cell (m×Q×2; y and z in
    m). It returns elasticity matrices (m×Q×6×6, in Pa). `densities` (M) are in kg/m³. `inclined` is
    True if fibres are inclined to the axis of the leg, so that planes across the leg are not planes
    of symmetry of the material.
    """

    at: Callable[[IntArray, Array], Array]
    densities: Array
    inclined: bool = False

    def on(self, quad: SectionQuadrature) -> Array:
        """Elasticity matrices (M×Q×6×6, in Pa) at the Q quadrature points of each cell."""
        points = quad.points + quad.centroid[:, None, None]
        return self.at(np.arange(len(self.densities)), np.moveaxis(points, 0, -1))


def part_moduli(mesh: SectionMesh, materials: Sequence[Material]) -> Moduli:
    """Moduli of a section of several parts, from the material of each part.

    The `regions` of the mesh are indices in `materials`. A mesh without regions has one material.
    """
    cells = len(mesh.cells)
    regions = np.zeros(cells, dtype=int) if mesh.regions is None else mesh.regions
    matrices = np.array([elasticity(material) for material in materials])[regions]
    densities = np.array([material.rho for material in materials])[regions]

    def at(cells: IntArray, points: Array) -> Array:
        return np.broadcast_to(matrices[cells, None], (*points.shape[:2], 6, 6))

    return Moduli(at, densities)


# Pairs of axes of the six strains. The last three are shear angles, twice the tensor's components.
_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
# Signs of these strains in the axes of a wall after a mirroring at a plane across it.
_MIRRORED = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
# Distance from the diagonal at a corner of a box, relative to the size of the box, up to which a
# point belongs to both walls.
_ON_DIAGONAL = 1e-9


def layer_elasticity(layer: Layer) -> Array:
    """Elasticity matrix (6×6, Pa) of a layer in its own axes.

    Axis 1 is along the fibres, axis 2 across them in the wall, and axis 3 normal to the wall. The
    layer is isotropic across its fibres: E3 = E2, G13 = G12, ν13 = ν12. Its ratio ν23 is taken as
    ν12 (1 − ν21)/(1 − ν12), which is ν12 in an isotropic layer. It only affects stresses across the
    wall.
    """
    E1, E2, nu12 = layer.E1, layer.E2, layer.nu12
    nu23 = nu12 * (1.0 - nu12 * E2 / E1) / (1.0 - nu12)
    flexibility = np.diag(
        [1.0 / E1, 1.0 / E2, 1.0 / E2, 2.0 * (1.0 + nu23) / E2, 1.0 / layer.G12, 1.0 / layer.G12]
    )
    flexibility[0, 1] = flexibility[1, 0] = flexibility[0, 2] = flexibility[2, 0] = -nu12 / E1
    flexibility[1, 2] = flexibility[2, 1] = -nu23 / E2
    return np.asarray(np.linalg.inv(flexibility))


def turned(matrices: Array, axes: Array) -> Array:
    """Elasticity matrices (…×6×6) in common axes, from those in the materials' own axes.

    `matrices` (…×6×6) are in the materials' own axes. The columns of `axes` (…×3×3) are the
    materials' own axes in the common axes.
    """
    own_from_leg = np.empty((*axes.shape[:-2], 6, 6))
    for row, (a, b) in enumerate(_PAIRS):
        twice = 2.0 if a != b else 1.0
        for column, (i, j) in enumerate(_PAIRS):
            both = axes[..., i, a] * axes[..., j, b] + axes[..., j, a] * axes[..., i, b]
            own_from_leg[..., row, column] = 0.5 * twice * both
    return np.asarray(np.swapaxes(own_from_leg, -1, -2) @ matrices @ own_from_leg)


def in_wall(layer: Layer) -> Array:
    """Elasticity matrix (6×6, Pa) of a layer in the axes (x, s, n) of its wall.

    x is the leg's axis, s the circumference, n the normal of the wall.
    """
    c, s = np.cos(np.radians(layer.angle)), np.sin(np.radians(layer.angle))
    return turned(layer_elasticity(layer), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def laminate_moduli(mesh: SectionMesh, laminate: Laminate, *, mirrored: bool = False) -> Moduli:
    """Moduli of a wall of layers. The `regions` of the mesh are indices of layers.

    If `mirrored` is True, the moduli of each layer at an angle θ are the mean of those at θ and at
    −θ.
    """
    regions = mesh.regions
    if regions is None:
        raise ValueError("the mesh of a laminate must have the numbers of the layers as regions")
    matrices = np.array([in_wall(layer) for layer in laminate.layers])
    if mirrored:
        matrices *= np.outer(_MIRRORED, _MIRRORED) > 0.0
    walls = matrices[regions]
    densities = np.array([layer.rho for layer in laminate.layers])[regions]

    def at(cells: IntArray, points: Array) -> Array:
        of_walls = walls[cells, None]
        if isinstance(laminate, LaminateBox):
            return _box_moduli(of_walls, points, laminate.extent)
        return turned(of_walls, _wall_axes(points))

    return Moduli(at, densities, inclined=not mirrored)


def _box_moduli(walls: Array, points: Array, extent: tuple[float, float]) -> Array:
    """Elasticity matrices (leg axes) at `points` of a box: at each point, that of the nearest wall.

    `points` (m×Q×2) are y and z in m. On the diagonals at the corners of the box, the matrix is the
    mean of both walls. `walls` contains the elasticity matrices in wall axes (x, s, n). `extent`
    are the outer dimensions (m) of the box along y and z.
    """
    inside = 0.5 * np.array(extent) - np.abs(points)
    beyond = inside[..., 0] - inside[..., 1]
    beyond[np.abs(beyond) <= _ON_DIAGONAL * max(extent)] = 0.0
    normals = np.zeros((2, *points.shape))
    normals[0, ..., 0], normals[1, ..., 1] = np.moveaxis(np.where(points < 0.0, -1.0, 1.0), -1, 0)
    side, top = (turned(walls, _wall_axes(normal)) for normal in normals)
    share = 0.5 * (1.0 - np.sign(beyond))[..., None, None]
    return np.asarray(share * side + (1.0 - share) * top)


def _wall_axes(normals: Array) -> Array:
    """Axes (…×3×3, columns x, s, n) of walls with `normals` (…×2; y, z) of any length."""
    n_y, n_z = np.moveaxis(normals / np.linalg.norm(normals, axis=-1, keepdims=True), -1, 0)
    axes = np.zeros((*n_y.shape, 3, 3))
    axes[..., 0, 0] = 1.0
    axes[..., 1, 1], axes[..., 2, 1] = -n_z, n_y
    axes[..., 1, 2], axes[..., 2, 2] = n_y, n_z
    return axes


def leg_moduli(leg: SectionedLeg, mesh: SectionMesh) -> Moduli | None:
    """Moduli on the section mesh of a leg of several materials. None for other legs."""
    if isinstance(leg, ConstantLeg) and isinstance(leg.section, Laminate):
        return laminate_moduli(mesh, leg.section)
    if materials := part_materials(leg):
        return part_moduli(mesh, materials)
    return None


def mirrored_moduli(leg: SectionedLeg, mesh: SectionMesh) -> Moduli | None:
    """Moduli of a leg of several materials, for theories in which sections are planes of symmetry.

    They are those of `leg_moduli`, except in a wall of inclined fibres. There the moduli of each
    layer are the mean of its own and those of its mirror image. In a balanced layup, layers at +θ
    and −θ have nearly the same strains, so that their moduli are averaged in any case. The layers
    are at different radii, which causes couplings. Neglecting these couplings changes frequencies
    and torsion by (thickness/radius)², relative. None for legs of one material.
    """
    if isinstance(leg, ConstantLeg) and isinstance(leg.section, Laminate):
        return laminate_moduli(mesh, leg.section, mirrored=True)
    return leg_moduli(leg, mesh)


def part_materials(leg: SectionedLeg) -> tuple[Material, ...]:
    """Materials of the parts of a composite leg. () for other legs."""
    if not isinstance(leg, ConstantLeg) or not isinstance(leg.section, Composite):
        return ()
    return tuple(Material.isotropic(part.E, part.nu, part.rho) for part in leg.section.parts)
