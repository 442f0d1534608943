"""VTU file of the stress fields of all bodies as solids, for ParaView.

Input: `Forces` of one load in one pose, with stress fields. Output: the content of the file.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from fem.bodies.stresses import COMPONENTS, von_mises
from meshes.elements import ELEMENTS
from validation.forces.record import Forces
from validation.forces.solids import SolidStress

if TYPE_CHECKING:
    import pyvista


def vtu_of(forces: Forces) -> bytes:
    """Content of a VTU file with the stress fields of all bodies, in base axes.

    `forces` must have a single load and a single pose. Point data: "displacement" (m), "von Mises
    stress" and the stresses in the axes of the body (Pa). Cell data "body": number of the body in
    the order of the robot file.
    """
    ((forces_of_load,),) = (tuple(pose.loads.values()) for pose in forces.poses)
    solids = () if forces_of_load is None else tuple(forces_of_load.solids.values())
    # VTK takes seconds to load and needs system libraries.
    import pyvista  # noqa: PLC0415

    grids = [_grid(number, solid) for number, solid in enumerate(solids, start=1)]
    merged = pyvista.merge(grids, merge_points=False)
    with TemporaryDirectory(prefix="flexproof-vtu-") as folder:
        path = Path(folder) / "forces.vtu"
        merged.save(path)
        return path.read_bytes()


def _grid(number: int, solid: SolidStress) -> "pyvista.UnstructuredGrid":
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[solid.mesh.element]
    cells = {kind.vtk_type: solid.mesh.cells[:, list(kind.vtk_order)]}
    grid = pyvista.UnstructuredGrid(cells, solid.mesh.nodes)
    grid.point_data["displacement"] = solid.displacements
    grid.point_data["von Mises stress"] = von_mises(solid.stresses)
    for name, values in zip(COMPONENTS, solid.stresses.T, strict=True):
        grid.point_data[f"stress {name}"] = values
    grid.cell_data["body"] = np.full(grid.n_cells, number)
    return grid
