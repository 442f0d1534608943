"""Parts that tests draw by gmsh's kernel: they and their meshes as files, and their plane ends."""

import pytest

from lumped.mechanism.body import ByPlane, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part import volume
from meshes.part.reading import read


def written(path, draw):
    """The file, in mm, of what `draw(kernel)` adds to an empty model, in mm."""
    with gmsh_model(path.stem) as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.option.setNumber("Geometry.OCCScaling", 1.0)
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def meshed(path, draw, size, sides=4.0):
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


def lug(kernel, length=200.0):
    """A bar `length` × 40 × 30 mm with bores along z, 20 mm from its ends, of radius 8 and 5."""
    bar, bores = kernel.addBox(0.0, -20.0, -15.0, length, 40.0, 30.0), ((20.0, 8), (length - 20, 5))
    tools = [(3, kernel.addCylinder(x, 0, -30, 0, 0, 60, radius)) for x, radius in bores]
    kernel.cut([(3, bar)], tools)


def without_processes(patch):
    """Files that do not end the CAD kernel are read and meshed without a process of their own."""
    for module in (read, volume):
        patch.setattr(module, "within_limits", lambda _, function, *rest: function(*rest))


def read_here(path, unit=None):
    with pytest.MonkeyPatch.context() as patch:
        without_processes(patch)
        return read.read_part(path, unit)


def plane_ends(length, coupling=None):
    """Interfaces A and B: the plane ends of what is `length` (m) long along x, from the origin."""
    return {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), coupling)
        for name, way, x in (("A", -1.0, 0.0), ("B", 1.0, length))
    }
