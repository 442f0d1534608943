"""Parts drawn and meshed on the spot by gmsh, and written as other programs write theirs."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

from lumped.errors import ComputationError
from lumped.mechanism.part import ByPlane, Coupling, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part.part_mesh import PartMesh
from meshes.part.reading.read import PartFile, read_part

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


def plane_ends(length: float, coupling: Coupling | None = None) -> dict[str, PartInterface]:
    """Interfaces A and B: the plane ends of what is `length` (m) long along x, from the origin."""
    return {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), coupling)
        for name, way, x in (("A", -1.0, 0.0), ("B", 1.0, length))
    }


def read_again(
    name: str, draw: Callable[[ModuleType], None], size: float, sides: float = 4.0
) -> tuple[PartFile, PartMesh]:
    """The same, written to a file `name`.msh and read as one in mm: the part, and its mesh."""
    with TemporaryDirectory(prefix=f"{name}-") as folder:
        part = read_part(meshed(Path(folder) / f"{name}.msh", draw, size, sides), "mm")
    if part.mesh is None:
        raise ComputationError(f"{name}: read as no mesh")
    return part, part.mesh
