"""CAD parts while faults are tried: what they cost is spent once, and no copy meshes them.

OpenCASCADE samples the faces that a mesh is graded to with threads of its own, which a process
starts once. A copy of it does not have them, and would wait for them for ever.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

from lumped.errors import ComputationError
from meshes.part.interfaces import Interface
from meshes.part.part_mesh import PartMesh
from meshes.part.reading.read import PartFile
from validation.context import Context
from validation.faults.fault import Change, Fault, Faulty, around
from validation.parts.meshes import RUNGS, part_mesh


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
    for rung in reversed(RUNGS if part.mesh is None else RUNGS[:1]):
        yield part_mesh(part, interfaces, unknowns, rung)


def meshed_elsewhere(fault: Fault) -> dict[str, Change]:
    """Changes by which volumes are meshed under the fault in fresh processes, not in this one."""
    places = ("meshes.part.volume.ladder", "meshes.part.volume.volume_mesh")
    return {place: around(partial(_asked, place, fault)) for place in places}


def _asked(place: str, fault: Fault, _sound: Faulty, *args: Any) -> Any:
    """What a fresh process with the same fault meshes; raises what it raises."""
    ours, theirs = Pipe()
    mesher = [sys.executable, "-m", "validation.faults.mesher", str(theirs.fileno())]
    paths = os.pathsep.join(filter(None, sys.path))
    with ours, theirs:
        process = subprocess.Popen(  # noqa: S603  this interpreter
            mesher, env={**os.environ, "PYTHONPATH": paths}, pass_fds=[theirs.fileno()]
        )
        theirs.close()
        try:
            ours.send((place, fault.id, args))
            answer = ours.recv()
        except (EOFError, ConnectionError):
            raise ComputationError("the meshing process ended without an answer") from None
        finally:
            process.kill()
            process.wait()
    if isinstance(answer, Exception):
        raise answer
    return answer
