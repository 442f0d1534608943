"""A part's file and its three meshes, each read or made once and kept, for whoever asks."""

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
from meshes.part.volume import Grading, ladder, volume_mesh
from validation.run.cache import CacheEntry, key_of, require_shape
from validation.run.sources import program

# Sources that decide what is read and meshed of a part, and what is computed on its meshes.
_CACHE = ("validation/run/cache.py", "validation/run/sources.py")
MESHING = ("lumped", "meshes", "validation/parts/meshes.py", *_CACHE)
_ROOMS = ("validation/agreement", "validation/parts", "validation/models")
COMPUTING = ("lumped", "meshes", "fem", *_ROOMS, *_CACHE)
COARSE, MIDDLE, FINEST = 0, 1, 2
LEVELS = (COARSE, MIDDLE, FINEST)
# What is kept of each face beside its facets.
_OF_FACES = tuple(entry.name for entry in fields(Face) if entry.name != "facets")
_ANY = Material.isotropic(1.0, 0.0, 1.0)


def part_key(
    part: PartFile,
    interfaces: Sequence[Interface],
    material: Material,
    *more: object,
    sources: tuple[str, ...] = COMPUTING,
) -> str:
    """The key of what depends on a part's content, unit, interfaces, material, and `more`.

    And on the program: the libraries and these `sources` of it.
    """
    inputs = part.unit, tuple(interfaces), material
    return key_of("part", program(*sources), _content(part.path), *inputs, *more)


def part_file(path: Path, unit: str | None = None) -> PartFile:
    """The part in a file; a CAD file is read once: its surface is meshed to know its faces.

    Raises InputError as `read_part` does.
    """
    require_file(path)
    if path.suffix.lower() in MESHES:
        return read_part(path, unit)
    key = key_of("file", program(*MESHING), _content(path), unit)
    return CacheEntry(
        key, lambda: _file_packed(read_part(path, unit)), partial(_file_unpacked, path)
    ).value()


def _content(path: Path) -> str:
    return hashlib.sha256(part_content(path)).hexdigest()


def _mesh_key(part: PartFile, interfaces: Sequence[Interface], *more: object) -> str:
    """The key of what depends neither on the material nor on how interfaces are held.

    What is held in two ways is then held on one mesh: gmsh may make another one of the same input.
    """
    faces = [replace(one, coupling="rigid", because="") for one in interfaces]
    return part_key(part, faces, _ANY, *more, sources=MESHING)


def part_mesh(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int = FINEST
) -> PartMesh:
    """The part on one of three meshes, the finest of about so many `unknowns`; a mesh as it is.

    Raises InputError where no mesh can be made.
    """
    if part.mesh is not None:
        return part.mesh
    (entry,) = mesh_entries(part, interfaces, unknowns, [level])
    return entry.value()


def mesh_entries(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, levels: Sequence[int]
) -> tuple[CacheEntry[PartMesh], ...]:
    """Cache entries of the meshes of these levels; empty for a part that is a mesh itself."""
    if part.mesh is not None:
        return ()
    return tuple(
        CacheEntry(
            _mesh_key(part, interfaces, "mesh", unknowns, level),
            partial(_made, part, interfaces, unknowns, level),
            _unpacked,
            (_gradings_entry(part, interfaces, unknowns),),
        )
        for level in levels
    )


def gradings(part: PartFile, interfaces: Sequence[Interface], unknowns: int) -> tuple[Grading, ...]:
    """Gradings of the three meshes, by level; raises InputError as `part_mesh` does."""
    return _gradings_entry(part, interfaces, unknowns).value()


def _gradings_entry(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int
) -> CacheEntry[tuple[Grading, ...]]:
    return CacheEntry(
        _mesh_key(part, interfaces, "ladder", unknowns),
        lambda: {"steps": [(g.size, g.sides, g.cut) for g in ladder(part, interfaces, unknowns)]},
        _gradings,
    )


def _gradings(found: dict[str, Array]) -> tuple[Grading, ...]:
    coarse, middle, fine = found["steps"].tolist()
    return tuple(Grading(size, sides, bool(cut)) for size, sides, cut in (coarse, middle, fine))


def _made(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int
) -> dict[str, Any]:
    return _packed(volume_mesh(part, interfaces, gradings(part, interfaces, unknowns)[level]))


def _packed(mesh: PartMesh) -> dict[str, Any]:
    return {
        "nodes": mesh.nodes,
        "cells": mesh.cells,
        "straightened": mesh.straightened,
        "numbers": list(mesh.faces),
        "counts": [len(facets.cells) for facets in mesh.faces.values()],
        "facets": np.vstack([facets.cells for facets in mesh.faces.values()]),
    }


def _unpacked(found: dict[str, Array]) -> PartMesh:
    pieces = np.split(found["facets"], np.cumsum(found["counts"])[:-1])
    faces = {
        int(number): Facets(cells.astype(np.int64), "tri6")
        for number, cells in zip(found["numbers"], pieces, strict=True)
    }
    require_shape(found, nodes=(None, 3), cells=(None, 10), facets=(None, 6))
    return PartMesh(
        nodes=found["nodes"],
        cells=found["cells"].astype(np.int64),
        element="tet10",
        faces=faces,
        straightened=int(found["straightened"]),
    )


def _file_packed(part: PartFile) -> dict[str, Any]:
    faces = part.faces
    columns = {name: [getattr(face, name) for face in faces] for name in _OF_FACES}
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


def _file_unpacked(path: Path, found: dict[str, Array]) -> PartFile:
    require_shape(found, surface=(None, 3), cells=(None, 3), extent=(3,), exact_inertia=(3, 3))
    pieces = np.split(found["cells"], np.cumsum(found["counts"])[:-1])
    # Numbers and names as Python's own; what is left is one vector for each face.
    columns = [found[name] for name in _OF_FACES]
    columns = [column.tolist() if column.ndim == 1 else column for column in columns]
    return PartFile(
        path,
        str(found["unit"]),
        found["extent"].tolist(),
        found["surface"],
        tuple(
            Face(**dict(zip(_OF_FACES, values, strict=True)), facets=Facets(cells, "tri3"))
            for cells, *values in zip(pieces, *columns, strict=True)
        ),
        VolumeProperties(
            float(found["exact_volume"]),
            found["exact_centre"],
            found["exact_inertia"],
            float(found["exact_error"]),
        ),
        None,
        float(found["gap"]),
        float(found["unknown_share"]),
        bool(found["by_curvature"]),
    )
