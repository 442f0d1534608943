"""Strain energy of a solid leg by kind: tension, torsion, bending in two planes, and the rest.

Between two planes of nodes a distance l apart let σ be Saint-Venant's stresses under the six
resultants w. They are in equilibrium, so the work of the actual strains on them is that of their
tractions on the planes, ∫ε:σ dV = wᵀΔq with q = Bᵀu, the work-conjugate twists of the planes, and
Δq their difference, both moved to the middle. There the resultants do not couple and have the
energy ½wᵀCw with the compliance C of that piece of beam, diagonal. So ½ΣΔqᵢ²/Cᵢᵢ is the energy of
the projection of the actual stresses on beam theory's: never more than all of it (Bessel's
inequality). What is left is warping and distortion of the section beyond beam theory.
"""

import numpy as np

from fem.bodies.solid import SolidLeg
from fem.couplings.end_coupling import saint_venant_loads
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.models.segments import KINDS
from lumped.screws import shift
from meshes.elements import ELEMENTS

DISTORTION = "section distortion"


def kind_energies(solid: SolidLeg, displacements: Array) -> dict[str, Array]:
    """Strain energy (J, m values each) of m displacement fields (3N×m, m, leg axes) by kind.

    "tension", "torsion", "bending y" and "bending z" with their shear as in LegMatrices, and
    "section distortion", all of which sum to ½uᵀKu. Raises InputError for a mesh that is not
    extruded.
    """
    mesh, material = solid.mesh, solid.leg.material
    if mesh.slices is None:
        raise InputError("energies by kind need an extruded mesh: tetrahedra have no slices")
    order = ELEMENTS[mesh.element].order
    face = mesh.root
    per_plane = len(face.nodes)
    planes = mesh.nodes[:: order * per_plane, 0]
    loads = saint_venant_loads(face, mesh.nodes[face.nodes], np.zeros(3), material)
    fields = displacements.reshape(-1, 3 * per_plane, displacements.shape[1])[::order]
    twists = np.einsum("ni,pnm->pim", loads, fields)

    constants = section_constants(face.mesh, material.nu, material.G / material.E)
    beam = beam_properties(constants, material)
    squares = np.zeros((6, displacements.shape[1]))
    for first, second, length in zip(twists[:-1], twists[1:], np.diff(planes), strict=True):
        half = np.array([0.5 * length, 0.0, 0.0])
        relative = shift(-half) @ second - shift(half) @ first
        squares += np.square(relative) / np.diag(beam.piece_compliance(length))[:, None]
    energies = {
        kind: 0.5 * squares[list(components)].sum(axis=0) for kind, components in KINDS.items()
    }
    whole = 0.5 * np.einsum("nm,nm->m", displacements, solid.stiffness @ displacements)
    return energies | {DISTORTION: whole - sum(energies.values())}
