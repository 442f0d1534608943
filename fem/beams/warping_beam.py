"""A beam whose sections warp: the frame member of `fem.beams.beam` with non-uniform torsion.

Torsion of `fem.sections.nonuniform_torsion` in place of Saint-Venant's: besides its rotation every
section has a warping intensity χ, quadratic along each element, which end faces may hold. Where
ends are held (χ = 0) a leg is stiffer in torsion, and along a torsional wave in any case.
"""

import numpy as np
from scipy.sparse import block_array, block_diag, csr_array, csr_matrix, hstack
from skfem import Basis, ElementLineP2, MeshLine

from fem.beams.beam import beam_leg
from fem.sections.nonuniform_torsion import line_products, warping_rod
from fem.sections.section_constants import SectionConstants, beam_properties
from lumped.arrays import Array, SparseMatrix
from lumped.legs import Ends, Material
from lumped.mechanism.body_model import LegMatrices

# Round sections do not warp: below this share of G I_p warping has nothing to act against.
_NO_WARPING = 1e-4


def warping_beam_leg(
    constants: SectionConstants, material: Material, length: float, elements: int, ends: Ends
) -> LegMatrices:
    """Free Timoshenko leg of `length` (m) in `elements` beam elements, with warping.

    Unknowns as of `beam_leg`, then χ (1/m) at the nodes and inside the elements: all of them for
    `ends` = "free", all but those of both end faces for "rigid". Round sections have none.
    """
    leg = beam_leg(beam_properties(constants, material), length, elements)
    rod = warping_rod(constants, material)
    if rod.shear <= _NO_WARPING * rod.twist:
        return leg
    basis = Basis(MeshLine(np.linspace(0.0, length, elements + 1)), ElementLineP2())
    places = basis.doflocs[0]
    inside = (places > 0.0) & (places < length)
    kept = np.flatnonzero(inside) if ends == "rigid" else np.arange(len(places))
    # Rotation about x at the places of the quadratic shape functions, from the leg's unknowns.
    rotation = csr_array(leg.centreline(places))[3::6]
    gradients, coupling, products = line_products(basis)
    cross = csr_array(-rod.shear * (coupling[kept] @ rotation))
    warping = rod.shear * products[kept][:, kept] + rod.bimoment * gradients[kept][:, kept]
    torsion = csr_matrix(
        block_array([[rotation.T @ (rod.twist * gradients) @ rotation, cross.T], [cross, warping]])
    )

    def wide(matrix: SparseMatrix) -> SparseMatrix:
        return csr_matrix(block_diag([matrix, csr_array((len(kept), len(kept)))]))

    def centreline(stations: Array) -> SparseMatrix:
        own = leg.centreline(stations)
        return csr_matrix(hstack([own, csr_array((own.shape[0], len(kept)))]))

    others = {kind: wide(part) for kind, part in leg.parts.items() if kind != "torsion"}
    parts = {**others, "torsion": torsion}
    mass = block_diag([leg.mass, rod.warping * products[kept][:, kept]])
    return LegMatrices(
        model="beam with warping",
        length=length,
        stiffness=csr_matrix(sum(parts.values())),
        mass=csr_matrix(mass),
        centreline=centreline,
        parts=parts,
    )
