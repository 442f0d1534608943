"""File and three meshes of a CAD part, each read or made once and stored in the cache.

Input: the path of a part, its interfaces and the number of unknowns. Output: `PartFile` and
`PartMesh`. Rule: the cache key covers the content of the file and the sources of the program that
affect the result.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.legs import Material
from lumped.robot_file.included import part_content
from meshes.part.boundary import Facets, PartMesh
from meshes.part.enclosed import VolumeProperties
from meshes.part.faces import Face
from meshes.part.interfaces import Interface
from meshes.part.reading.given_mesh import MESHES
from meshes.part.reading.read import PartFile, read_part, require_file
from meshes.part.volume import Grading, refined_gradings, volume_mesh
from validation.run.cache import CacheEntry, key_of, program, require_shape

# Sources that affect reading and meshing of a part (MESHING), and all results computed on its
# meshes (COMPUTING).
MESHING = ("lumped", "meshes", "validation/parts/meshes.py", "validation/run/cache.py")
_ROOMS = ("validation/uncertainty", "validation/responses", "validation/parts", "validation/models")
COMPUTING = ("lumped", "meshes", "fem", *_ROOMS, "validation/run/cache.py")
COARSE, MIDDLE, FINEST = 0, 1, 2
LEVELS = (COARSE, MIDDLE, FINEST)
# Fields of faces, each of which is stored as a column over all faces. Facets are stored separately.
_FACE_FIELDS = tuple(entry.name for entry in fields(Face) if entry.name != "facets")
# Any material, for the cache keys of meshes, which do not depend on it.
_NO_MATERIAL = Material.isotropic(1.0, 0.0, 1.0)


def part_key(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    *inputs: object,
    sources: tuple[str, ...] = COMPUTING,
) -> str:
    """Cache key of a result computed from a part.

    It covers the part's content and unit, its interfaces, the material, further `inputs`, the
    versions of the libraries and the `sources` of the program.
    """
    part_inputs = part.unit, tuple(interfaces), material
    return key_of("part", program(*sources), _content(part.path), *part_inputs, *inputs)


def part_file(path: Path, unit: str | None = None) -> PartFile:
    """CAD part read from its file, or from the cache.

    To find its faces, the surface of a CAD file is meshed, which takes seconds. Raises InputError
    if the file cannot be read.
    """
    require_file(path)
    if path.suffix.lower() in MESHES:
        return read_part(path, unit)
    key = key_of("file", program(*MESHING), _content(path), unit)
    return CacheEntry(
        key, lambda: _file_arrays(read_part(path, unit)), partial(_file_from_arrays, path)
    ).value()


def _content(path: Path) -> str:
    return hashlib.sha256(part_content(path)).hexdigest()


def _mesh_key(part: PartFile, interfaces: Sequence[Interface], *inputs: object) -> str:
    """Cache key of a mesh, which depends neither on the material nor on the couplings.

    Parts that differ in their couplings only then share one mesh. Without a common key their meshes
    could differ, since gmsh can make different meshes from equal inputs.
    """
    faces = [replace(interface, coupling="rigid", by_default=False) for interface in interfaces]
    return part_key(part, faces, _NO_MATERIAL, *inputs, sources=MESHING)


def part_mesh(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int = FINEST
) -> PartMesh:
    """Mesh of a part at one of three levels, the finest with about `unknowns` unknowns.

    If the file of the part is a mesh, the result is that mesh. Raises InputError if gmsh cannot
    mesh the part.
    """
    if part.mesh is not None:
        return part.mesh
    (entry,) = mesh_entries(part, interfaces, unknowns, [level])
    return entry.value()


def mesh_entries(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, levels: Sequence[int]
) -> tuple[CacheEntry[PartMesh], ...]:
    """Cache entries for the meshes of the given `levels`. () if the file of the part is a mesh."""
    if part.mesh is not None:
        return ()
    return tuple(
        CacheEntry(
            _mesh_key(part, interfaces, "mesh", unknowns, level),
            partial(_meshed, part, interfaces, unknowns, level),
            _mesh_from_arrays,
            (_gradings_entry(part, interfaces, unknowns),),
        )
        for level in levels
    )


def gradings(part: PartFile, interfaces: Sequence[Interface], unknowns: int) -> tuple[Grading, ...]:
    """Element sizes over the part, for each of the three meshes from coarse to fine.

    Raises InputError if gmsh cannot mesh the part.
    """
    return _gradings_entry(part, interfaces, unknowns).value()


def _gradings_entry(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int
) -> CacheEntry[tuple[Grading, ...]]:
    return CacheEntry(
        _mesh_key(part, interfaces, "ladder", unknowns),
        lambda: {
            "steps": [
                (g.size, g.sides, g.cut) for g in refined_gradings(part, interfaces, unknowns)
            ]
        },
        _gradings_from_arrays,
    )


def _gradings_from_arrays(arrays: dict[str, Array]) -> tuple[Grading, ...]:
    coarse, middle, fine = arrays["steps"].tolist()
    return tuple(Grading(size, sides, bool(cut)) for size, sides, cut in (coarse, middle, fine))


def _meshed(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int
) -> dict[str, Any]:
    grading = gradings(part, interfaces, unknowns)[level]
    return _mesh_arrays(volume_mesh(part, interfaces, grading))


def _mesh_arrays(mesh: PartMesh) -> dict[str, Any]:
    return {
        "nodes": mesh.nodes,
        "cells": mesh.cells,
        "straightened": mesh.straightened,
        "numbers": list(mesh.faces),
        "counts": [len(facets.cells) for facets in mesh.faces.values()],
        "facets": np.vstack([facets.cells for facets in mesh.faces.values()]),
    }


def _mesh_from_arrays(arrays: dict[str, Array]) -> PartMesh:
    facets = np.split(arrays["facets"], np.cumsum(arrays["counts"])[:-1])
    faces = {
        int(number): Facets(cells.astype(np.int64), "tri6")
        for number, cells in zip(arrays["numbers"], facets, strict=True)
    }
    require_shape(arrays, nodes=(None, 3), cells=(None, 10), facets=(None, 6))
    return PartMesh(
        nodes=arrays["nodes"],
        cells=arrays["cells"].astype(np.int64),
        element="tet10",
        faces=faces,
        straightened=int(arrays["straightened"]),
    )


def _file_arrays(part: PartFile) -> dict[str, Any]:
    faces = part.faces
    columns = {name: [getattr(face, name) for face in faces] for name in _FACE_FIELDS}
    volume = {} if part.exact is None else {f"exact_{k}": v for k, v in vars(part.exact).items()}
    return (
        columns
        | volume
        | {
            "unit": part.unit,
            "extent": part.extent,
            "surface": part.surface,
            "counts": [len(face.facets.cells) for face in faces],
            "cells": np.vstack([face.facets.cells for face in faces]),
            "gap": part.gap,
            "unknown_share": part.unknown_share,
            "by_curvature": part.by_curvature,
        }
    )


def _file_from_arrays(path: Path, arrays: dict[str, Array]) -> PartFile:
    require_shape(arrays, surface=(None, 3), cells=(None, 3), extent=(3,), exact_inertia=(3, 3))
    facets = np.split(arrays["cells"], np.cumsum(arrays["counts"])[:-1])
    # Columns of numbers and names become Python's own types. Columns of vectors stay arrays.
    columns = [arrays[name] for name in _FACE_FIELDS]
    columns = [column.tolist() if column.ndim == 1 else column for column in columns]
    return PartFile(
        path,
        str(arrays["unit"]),
        arrays["extent"].tolist(),
        arrays["surface"],
        tuple(
            Face(**dict(zip(_FACE_FIELDS, values, strict=True)), facets=Facets(cells, "tri3"))
            for cells, *values in zip(facets, *columns, strict=True)
        ),
        VolumeProperties(
            float(arrays["exact_volume"]),
            arrays["exact_centre"],
            arrays["exact_inertia"],
            float(arrays["exact_error"]),
        ),
        None,
        float(arrays["gap"]),
        float(arrays["unknown_share"]),
        bool(arrays["by_curvature"]),
    )
