"""The three meshes of a part, each made once and kept, for identification and reduction alike."""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.legs import Material
from meshes.part.boundary import Facets, PartMesh
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from meshes.part.volume import Grading, ladder, volume_mesh
from validation.run.cache import kept, key_of, require_shape

# Raised where the same input gives other numbers than before: meshes, elements, reduction.
_EDITION = 13
COARSE, MIDDLE, FINEST = 0, 1, 2
LEVELS = (COARSE, MIDDLE, FINEST)
_ANY = Material.isotropic(1.0, 0.0, 1.0)


def part_key(
    part: PartFile, interfaces: Sequence[Interface], material: Material, *more: object
) -> str:
    """The key of what depends on a part's content, unit, interfaces, material, and `more`."""
    content = hashlib.sha256(part.path.read_bytes()).hexdigest()
    program = _EDITION, version("gmsh")
    return key_of("part", program, content, part.unit, tuple(interfaces), material, *more)


def _mesh_key(part: PartFile, interfaces: Sequence[Interface], *more: object) -> str:
    """The key of what depends neither on the material nor on how interfaces are held.

    What is held in two ways is then held on one mesh: gmsh may make another one of the same input.
    """
    faces = [replace(one, coupling="rigid", because="") for one in interfaces]
    return part_key(part, faces, _ANY, *more)


def part_mesh(
    part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int = FINEST
) -> PartMesh:
    """The part on one of three meshes, the finest of about so many `unknowns`; a mesh as it is.

    Raises InputError where no mesh can be made.
    """
    if part.mesh is not None:
        return part.mesh
    key = _mesh_key(part, interfaces, "mesh", unknowns, level)
    return kept(key, lambda: _packed(_made(part, interfaces, unknowns, level)), _unpacked)


def gradings(part: PartFile, interfaces: Sequence[Interface], unknowns: int) -> tuple[Grading, ...]:
    """Those of the three meshes, by level; raises InputError as `part_mesh` does."""
    key = _mesh_key(part, interfaces, "ladder", unknowns)
    return kept(
        key,
        lambda: {"steps": [(g.size, g.sides, g.cut) for g in ladder(part, interfaces, unknowns)]},
        _gradings,
    )


def _gradings(found: dict[str, Array]) -> tuple[Grading, ...]:
    coarse, middle, fine = found["steps"].tolist()
    return tuple(Grading(size, sides, bool(cut)) for size, sides, cut in (coarse, middle, fine))


def _made(part: PartFile, interfaces: Sequence[Interface], unknowns: int, level: int) -> PartMesh:
    return volume_mesh(part, interfaces, gradings(part, interfaces, unknowns)[level])


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
