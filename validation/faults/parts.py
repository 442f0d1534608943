"""CAD parts while faults are tried: what they cost is spent once, and no copy meshes them.

OpenCASCADE samples the faces that a mesh is graded to with threads of its own, which a process
starts once. A copy of it does not have them, and would wait for them for ever.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from meshes.own_process import in_own_process
from meshes.part.interfaces import Interface
from meshes.part.part_mesh import PartMesh
from meshes.part.reading.read import PartFile
from validation.context import Context
from validation.faults.fault import Change, Fault, Faulty, around, replaced, sound_function
from validation.parts.meshes import RUNGS, part_mesh
from validation.store.cache import nothing_kept


def recalling(context: Context) -> dict[str, Change]:
    """Changes by which parts, once read, meshed and reduced, are entries of a context's memo.

    One mesh after the other: a context hears one thing at a time.
    """

    def kept(sound: Faulty, key: str, compute: Callable[[], Mapping[str, Any]]) -> Any:
        return context.recall(f"kept {key}", lambda: sound(key, compute))

    def read(sound: Faulty, path: Path, unit: str | None = None) -> Any:
        return context.recall(f"read {path} {unit}", lambda: sound(path, unit))

    return {
        "validation.parts.kept.kept": around(kept),
        "meshes.part.reading.read.read_part": around(read),
        "validation.parts.identify._meshes": around(_in_turn),
    }


def _in_turn(
    _sound: Faulty, part: PartFile, interfaces: Sequence[Interface], unknowns: int
) -> Iterator[PartMesh]:
    for rung in RUNGS if part.mesh is None else RUNGS[:1]:
        yield part_mesh(part, interfaces, unknowns, rung)


def meshed_elsewhere(fault: Fault) -> dict[str, Change]:
    """Changes by which volumes are meshed under the fault in fresh processes, not in this one."""
    places = ("meshes.part.volume.ladder", "meshes.part.volume.volume_mesh")
    return {place: around(partial(_asked, place, fault.id)) for place in places}


def _asked(place: str, identifier: str, _sound: Faulty, *args: Any) -> Any:
    return in_own_process(under_fault, place, identifier, args)


def under_fault(place: str, identifier: str, args: tuple[Any, ...]) -> Any:
    """What the function at `place` says under the fault, here in this process."""
    from validation.faults.catalogue import FAULTS  # noqa: PLC0415  it knows this module

    fault = next(one for one in FAULTS if one.id == identifier)
    with fault.inject(), replaced(IN_THIS_PROCESS), nothing_kept():
        return sound_function(place)(*args)


def _here(_sound: Faulty, function: Faulty, *args: Any) -> Any:
    return function(*args)


# Meshes are made where the fault is, and where it is seen which functions they take.
IN_THIS_PROCESS: dict[str, Change] = {"meshes.own_process.in_own_process": around(_here)}
