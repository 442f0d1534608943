"""One way into gmsh, which is a single library-wide state: silent, repeatable, always closed."""

import ctypes
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock
from types import ModuleType

import gmsh

from lumped.errors import ComputationError

_OPTIONS = {
    "General.Terminal": 0,
    # One thread and fixed seeds: the same request gives the same node numbers on every run.
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.RandomFactor": 1e-9,
    "Mesh.Algorithm": 6,  # frontal Delaunay
    "Mesh.Algorithm3D": 1,  # Delaunay
    # Removes the slivers that Delaunay leaves and that curved sides would fold.
    "Mesh.OptimizeNetgen": 1,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.SecondOrderIncomplete": 0,
    "Mesh.SecondOrderLinear": 0,
}

# gmsh has one current model per process; whoever meshes in another thread waits.
_LOCK = RLock()


@contextmanager
def gmsh_model(part: str) -> Iterator[ModuleType]:
    """A fresh, empty gmsh model; yields the gmsh module.

    Works in any thread, one model at a time, and may be nested: the inner model is removed and the
    outer one current again at the end. Raises ComputationError naming `part` where gmsh fails.
    """
    with _LOCK:
        outermost = not gmsh.isInitialized()
        if outermost:
            # gmsh's signal handler can only be set in the main thread, and is not wanted there.
            gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False, interruptible=False)
            _ignore_again()
        outer = gmsh.model.getCurrent()
        try:
            for option, value in _OPTIONS.items():
                gmsh.option.setNumber(option, value)
            gmsh.model.add(part)
            yield gmsh
        except Exception as error:
            # gmsh raises bare Exceptions; anything more specific is not gmsh's.
            if type(error) is not Exception:
                raise
            raise ComputationError(f"{part}: gmsh failed: {error}") from error
        finally:
            if outermost:
                gmsh.finalize()
            else:
                gmsh.model.remove()
                gmsh.model.setCurrent(outer)


def _ignore_again() -> None:
    # gmsh gives these signals back their default action. Writing to another process that has just
    # ended then ends this one without a word, and so does a hang-up that nohup had it ignore.
    # Python's own setter works in the main thread alone.
    for number in (signal.SIGPIPE, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            ctypes.CDLL(None).signal(number, ctypes.c_void_p(int(signal.SIG_IGN)))
