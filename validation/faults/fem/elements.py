"""Mistakes in meshes and solid elements."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array, diags_array

from lumped.arrays import Array, SparseMatrix
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh
from meshes.solid_mesh import SolidMesh
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_in_value(
    "mesh.section-rotated", "Section mesh turned by 90°", "meshes.section.section_mesh.section_mesh"
)
def _turned_section(mesh: SectionMesh) -> SectionMesh:
    y, z = mesh.nodes.T
    return replace(mesh, nodes=np.column_stack([-z, y]))


@fault_around(
    "mesh.layer-missing", "One layer of elements missing at the tip", "meshes.prism.extrude.extrude"
)
def _layer_missing(sound: Faulty, section: Any, at: Array) -> SolidMesh:
    kept = at[:-1] if len(at) > 2 else at * (1.0, 0.5)
    found: SolidMesh = sound(section, kept)
    return found


@fault_in_value("mesh.element-missing", "One element missing", "meshes.prism.extrude.extrude")
def _cells_missing(mesh: SolidMesh) -> SolidMesh:
    return replace(mesh, cells=mesh.cells[1:])


@fault_in_value(
    "mesh.node-order",
    "Wrong node order of the solid element: two nodes exchanged",
    "meshes.prism.extrude.extrude",
)
def _other_node_order(mesh: SolidMesh) -> SolidMesh:
    """The middle nodes of opposite edges of the first face exchanged."""
    order = np.arange(mesh.cells.shape[1])
    if len(order) == 27:
        order[[4, 6]] = order[[6, 4]]
    else:
        order[[0, 1]] = order[[1, 0]]
    return replace(mesh, cells=mesh.cells[:, order])


@fault_around(
    "element.gradient-order",
    "Shape-function gradients in another node order than the mesh",
    "meshes.shape_functions.gradients",
)
def _stale_order(sound: Faulty, element: str, points: Array) -> Array:
    found: Array = sound(element, points)
    return found[::-1]


@fault_around(
    "element.quadrature",
    "Solid elements: integration two degrees too low",
    "fem.elements.elasticity._cubature",
)
def _lower_degree(sound: Faulty, element: Any, degree: int) -> Any:
    return sound(element, max(1, degree - 2))


def _with_material(change: Any) -> Any:
    def changed(sound: Faulty, products: Array, material: Material) -> Array:
        found: Array = sound(products, change(material))
        return found

    return changed


@fault(
    "element.lame-slip",
    "(1 − ν) for (1 − 2ν) in Lamé's constants",
    "fem.elements.elasticity._node_blocks",
)
def _lame_slip(products: Array, material: Material) -> Array:
    """(1 − ν) for (1 − 2ν) in the denominator of Lamé's constants."""
    nu = material.nu
    C12 = material.E * nu / ((1.0 + nu) * (1.0 - nu))
    C11 = C12 + material.E / (1.0 + nu)
    blocks = C12 * products + material.G * products.transpose(0, 2, 1)
    trace = np.einsum("pii->p", products)
    for i in range(3):
        blocks[:, i, i] = (C11 - material.G) * products[:, i, i] + material.G * trace
    return np.asarray(blocks)


@fault_around(
    "element.transposed",
    "Solid: C12 and C44 terms of the node blocks exchanged by a transpose",
    "fem.elements.elasticity._node_blocks",
)
def _untransposed(sound: Faulty, products: Array, material: Material) -> Array:
    found: Array = sound(products.transpose(0, 2, 1), material)
    return found


@fault_in_value(
    "element.lumped-mass",
    "Solid: row sums for the consistent mass",
    "fem.elements.elasticity._scalar_mass",
)
def _row_sums(mass: SparseMatrix) -> SparseMatrix:
    return csr_array(diags_array(np.asarray(mass.sum(axis=1)).ravel()))


@fault_around(
    "element.half-density", "Solid: half the density", "fem.elements.elasticity._scalar_mass"
)
def _half_density(sound: Faulty, mesh: Any, rho: float, *rest: Any) -> SparseMatrix:
    return sound(mesh, 0.5 * rho, *rest)


fault_around(
    "element.isotropic",
    "Solid: G = E/2(1+ν) for a cubic material",
    "fem.elements.elasticity._node_blocks",
)(_with_material(lambda m: Material.isotropic(m.E, m.nu, m.rho)))
fault_around(
    "element.young-for-shear-modulus", "Solid: E for G", "fem.elements.elasticity._node_blocks"
)(_with_material(lambda m: replace(m, G=m.E)))
fault_around(
    "element.poisson-zero",
    "Solid: Poisson's ratio left out of the normal stresses",
    "fem.elements.elasticity._node_blocks",
)(_with_material(lambda m: replace(m, nu=0.0)))
