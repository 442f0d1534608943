"""
22 Pressure on a part
=====================

A lid as a mesh of quadratic tetrahedra, clamped at one end. A pressure on its upper face bends it.
Parts from STEP files are loaded likewise, their faces selected by number, cylinder or plane
(``examples/rocker``).
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import gmsh
import numpy as np

import flexproof as fp

length, width, height, pressure = 0.3, 0.03, 0.02, 2.0e5  # m, Pa
E, nu = 7.0e10, 0.33


def write_lid(path):
    """Write a mesh whose faces have names."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0.0, -0.5 * width, -0.5 * height, length, width, height)
    gmsh.model.occ.synchronize()
    for name, axis, place in (("root", 0, 0.0), ("tip", 0, length), ("top", 2, 0.5 * height)):
        faces = [
            face
            for _, face in gmsh.model.getEntities(2)
            if np.isclose(gmsh.model.occ.getCenterOfMass(2, face)[axis], place)
        ]
        gmsh.model.addPhysicalGroup(2, faces, name=name)
    gmsh.model.addPhysicalGroup(3, [1], name="lid")
    gmsh.option.setNumber("Mesh.MeshSizeMax", height)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(path))
    gmsh.finalize()


with TemporaryDirectory() as folder:
    mesh = Path(folder, "lid.msh")
    write_lid(mesh)
    lid = {
        "schema": 2,
        "name": "lid",
        "points": {"A": [0.0, 0.0, 0.0], "P": [length, 0.0, 0.0]},
        "bodies": {
            "lid": {
                "mesh": str(mesh),
                "material": {"E": E, "nu": nu, "rho": 2700.0},
                "interfaces": {"A": {"name": "root"}, "P": {"name": "tip", "coupling": "average"}},
            }
        },
        "joints": {"hinge": {"type": "fixed", "between": ["ground", "lid"], "at": "A"}},
        "tool": {"body": "lid", "point": "P", "moves": []},
        "loads": [
            {
                "name": "gas",
                "pressures": [{"body": "lid", "name": "top", "pressure": pressure}],
            }
        ],
    }
    solution = fp.solve(lid, "solid", modes=0)
    hinge = fp.forces(lid, "solid").poses[0].loads["gas"].reactions[0]

solution.plot_loads()

# %%
# The hinge carries the pressure times the area of the face, and its moment:

print(f"{abs(hinge.wrench[2]):.0f} N, {abs(hinge.wrench[4]):.0f} N m")

# %%
# As a beam, the lid deflects by :math:`q L^4/8 EI + q L^2/2 \kappa G A` at its tip. The face that
# is held rigidly makes the solid a little stiffer.

q, shear = pressure * width, 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu) * E / (2.0 * (1.0 + nu))
beam = q * length**4 / (8.0 * E * width * height**3 / 12.0)
beam += q * length**2 / (2.0 * shear * width * height)
sag = -solution.answers[0].loads["gas"][2]
print(f"solid {1e6 * sag:.1f} µm, beam {1e6 * beam:.1f} µm")
