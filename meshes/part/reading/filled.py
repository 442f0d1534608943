"""Whether the tetrahedra of a CAD part fill what its faces enclose, as far as a mesh can tell."""

from pathlib import Path

import numpy as np

from lumped.errors import InputError
from meshes.elements import SIMPLEX_EDGES
from meshes.part.boundary import Facets, PartMesh, area_vectors
from meshes.part.reading.cad import CadModel
from meshes.shape_functions import gradients, quadrature

# Degree of the Jacobian of a curved tetrahedron.
_DEGREE = 3
# Share of the volume to which the kernel integrates over splines.
_ROUNDING = 1e-6


def require_filled(mesh: PartMesh, model: CadModel, path: Path) -> None:
    """Raise InputError where tet10 with middles on the surface have another volume than `model`.

    The kernel integrates over the faces, each with its own outline and outside; tetrahedra fill
    what lies between them. The mesh explains what lies between its curved facets and the flat ones
    of their corners: curved ones are nearer to the surface. The gap along all of the surface, too.
    """
    volume = model.properties().volume
    points, weights = quadrature("tet10", _DEGREE)
    slopes = gradients("tet10", points)
    jacobians = np.einsum("mki,kjq->mqij", mesh.nodes[mesh.cells], slopes, optimize=True)
    filled = float((np.linalg.det(jacobians) @ weights).sum())
    between = 0.0
    for facets in mesh.faces.values():
        places = mesh.nodes[facets.cells]
        rises = places[:, 3:] - places[:, SIMPLEX_EDGES[3]].mean(axis=2)
        vectors = area_vectors(mesh.nodes, Facets(facets.corners, "tri3"))
        # The shape function of a middle integrates to a third of the area.
        between += float(np.abs(np.einsum("fmi,fi->fm", rises, vectors)).sum()) / 3.0
    allowed = between + (model.unknown_share + _ROUNDING) * volume
    if not abs(filled - volume) <= allowed:
        raise InputError(
            f"{path}: its faces enclose {1e6 * volume:.6g} cm³, tetrahedra between them fill "
            f"{1e6 * filled:.6g} cm³, and the mesh explains a difference of "
            f"{1e6 * allowed:.2g} cm³: a face looks the wrong way or is bounded wrongly; export it "
            "anew from the CAD system"
        )
