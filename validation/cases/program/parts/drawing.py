"""Parts drawn and meshed on the spot by gmsh, and written as other programs write theirs."""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from meshes.gmsh_session import gmsh_model

SECTION = "Parts of the program"


def meshed(path: Path, draw: Callable[[ModuleType], None], size: float, sides: float) -> Path:
    """The mesh, in mm, of what `draw(kernel)` adds to an empty model, in mm.

    Second-order tetrahedra of that `size` (mm), shorter where they make up the `sides` of a circle.
    """
    with gmsh_model(path.stem) as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", sides)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    return path
