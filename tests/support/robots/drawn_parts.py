"""Parts drawn by gmsh's kernel: files of the parts and of their meshes, and their plane ends."""

import pytest

from lumped.mechanism.body import ByPlane, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part import volume
from meshes.part.reading import read


def written(path, draw):
    """Write a CAD file, in mm, of the shapes that `draw(kernel)` adds to an empty model."""
    with gmsh_model(path.stem) as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.option.setNumber("Geometry.OCCScaling", 1.0)
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def meshed(path, draw, size, sides=4.0):
    """Write a mesh, in mm, of the shapes that `draw(kernel)` adds to an empty model.

    The mesh has second-order tetrahedra of `size` (mm), with at least `sides` sides per circle.
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


def lug(kernel, length=200.0):
    """Bar of `length` × 40 × 30 mm with bores of radius 8 and 5 mm along z, 20 mm from its ends."""
    bar, bores = kernel.addBox(0.0, -20.0, -15.0, length, 40.0, 30.0), ((20.0, 8), (length - 20, 5))
    tools = [(3, kernel.addCylinder(x, 0, -30, 0, 0, 60, radius)) for x, radius in bores]
    kernel.cut([(3, bar)], tools)


def without_processes(patch):
    """Read and mesh files in this process, which a crash of the CAD kernel would end."""
    for module in (read, volume):
        patch.setattr(module, "within_limits", lambda _, function, *arguments: function(*arguments))


def read_here(path, unit=None):
    with pytest.MonkeyPatch.context() as patch:
        without_processes(patch)
        return read.read_part(path, unit)


def plane_ends(length, coupling=None):
    """Interfaces A and B on the plane ends of a part from x = 0 to x = `length` (m)."""
    return {
        name: PartInterface(ByPlane((normal, 0.0, 0.0), (x, 0.0, 0.0)), coupling)
        for name, normal, x in (("A", -1.0, 0.0), ("B", 1.0, length))
    }
