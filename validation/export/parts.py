"""CAD parts as files for other programs: the mesh with deflections and modes, reduced matrices."""

from pathlib import Path

import numpy as np

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import held_body
from lumped.mechanism.body import Body
from validation.export.models import MODES, WRENCHES, write_matrix
from validation.export.vtk_files import grid, save
from validation.models.parts import UNKNOWNS, found_in, shape_of
from validation.parts.meshes import part_mesh


def write_part(body: Body, folder: Path) -> str:
    """Write a part on the finest mesh of its identification; in a line what its interfaces are.

    Raises InputError where it cannot be meshed, ComputationError where it cannot be solved,
    OSError where the disk refuses.
    """
    file, interfaces = found_in(body)
    mesh = part_mesh(file, interfaces, UNKNOWNS)
    meshed = meshed_part(mesh, shape_of(body).material)
    held = held_part(meshed, grips_of(mesh, interfaces), body.name)
    swung = held.modes(MODES)
    reduced = reduction(held_body(held), float(swung.frequencies[-1]))
    write_matrix(reduced.stiffness, folder / f"{body.name}_reduced_K")
    write_matrix(reduced.mass, folder / f"{body.name}_reduced_M")

    at_nodes = held.solid.transformation
    others = [one.name for one in interfaces[1:]]
    names = [f"displacement {name} {wrench}" for name in others for wrench in WRENCHES]
    fields = dict(zip(names, (at_nodes @ held.response).T, strict=True))
    fields |= {f"mode {k}": shape for k, shape in enumerate(swung.shapes.T, start=1)}
    data = grid(mesh)
    for name, field in fields.items():
        data.point_data[name] = np.asarray(field).reshape(-1, 3)
    data.field_data["frequencies"] = swung.frequencies
    save(data, folder / f"{body.name}_part.vtu")
    held_by = ", ".join(f"{one.name} ({one.coupling})" for one in interfaces)
    return f"{body.name}: {file.path.name}, interfaces {held_by}"
