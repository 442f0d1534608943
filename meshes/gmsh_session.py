"""Access to gmsh, which has one global state, and conversion of gmsh's tags to arrays.

A session lasts from the start of gmsh to its end. It prints nothing, gives the same mesh on every
run, and is closed even if an error occurs.
"""

import ctypes
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock
from types import ModuleType

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from meshes.elements import ElementName

_OPTIONS = {
    "General.Terminal": 0,
    # One thread and fixed seeds: the same request gives the same node numbers on every run.
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.RandomFactor": 1e-9,
    "Mesh.Algorithm": 6,  # frontal Delaunay
    "Mesh.Algorithm3D": 1,  # Delaunay
    # Removes the flat tetrahedra of Delaunay's algorithm, which curved edges would fold.
    "Mesh.OptimizeNetgen": 1,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.SecondOrderIncomplete": 0,
    "Mesh.SecondOrderLinear": 0,
}

# Debian packages of the libraries that gmsh links to. Their dependencies include all others.
DEBIAN_PACKAGES = ("libgl1", "libglu1-mesa", "libxcursor1", "libxft2", "libxinerama1", "libgomp1")

_GMSH_TYPE: dict[ElementName, int] = {
    "tri3": 2,
    "tet4": 4,
    "tri6": 9,
    "quad9": 10,
    "tet10": 11,
}
# gmsh lists the edges (2,3) and (1,3) of a tetrahedron in reverse order.
_GMSH_TET10 = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]

# gmsh has one current model per process, so other threads wait.
_LOCK = RLock()


@contextmanager
def gmsh_model(part: str) -> Iterator[ModuleType]:
    """Context with a new, empty gmsh model. It provides the module gmsh.

    `part` is the name of the object to be meshed, for the model and for messages. The context works
    in any thread, one model at a time. Models may be nested: at the end the inner model is removed
    and the outer one becomes current again. Raises ComputationError, with `part` in its message, if
    gmsh fails.
    """
    try:
        import gmsh  # noqa: PLC0415  slow to load, and most answers need no mesh
    except ImportError as error:
        raise ComputationError(
            f"needs gmsh, which cannot be loaded ({error}); install its Python module with "
            "pip or with the package manager of your system",
            part=part,
        ) from error
    except OSError as error:
        raise ComputationError(
            f"needs gmsh, which cannot be loaded ({error}); install the system libraries "
            f"that it links to, on Debian and Ubuntu the packages {' '.join(DEBIAN_PACKAGES)}",
            part=part,
        ) from error

    with _LOCK:
        outermost = not gmsh.isInitialized()
        if outermost:
            # gmsh can set its signal handler only in the main thread, where it would interfere.
            gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False, interruptible=False)
            _restore_ignored_signals()
        outer = gmsh.model.getCurrent()
        try:
            for option, value in _OPTIONS.items():
                gmsh.option.setNumber(option, value)
            gmsh.model.add(part)
            yield gmsh
        except Exception as error:
            # gmsh raises plain Exception. More specific errors come from elsewhere.
            if type(error) is not Exception:
                raise
            raise ComputationError(f"gmsh failed: {error}", part=part) from error
        finally:
            if outermost:
                gmsh.finalize()
            else:
                gmsh.model.remove()
                gmsh.model.setCurrent(outer)


def _restore_ignored_signals() -> None:
    # gmsh resets these signals to their default action. Writing to a process that has just ended
    # would then end this process without a message, and so would a hang-up in spite of nohup. The
    # C function is called because Python's `signal.signal` works in the main thread only.
    for name in ("SIGPIPE", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_IGN:
            ctypes.CDLL(None).signal(number, ctypes.c_void_p(int(signal.SIG_IGN)))


def connectivity(gmsh: ModuleType, element: ElementName, entity: int = -1) -> IntArray:
    """Node tags (M×k) of the M elements of one type, in the node order of `meshes.elements`.

    `entity` is gmsh's tag of the curve, surface or volume that contains the elements. −1 stands for
    the whole model.
    """
    kind = _GMSH_TYPE[element]
    _, tags = gmsh.model.mesh.getElementsByType(kind, entity)
    _, _, _, count, _, _ = gmsh.model.mesh.getElementProperties(kind)
    cells = np.asarray(tags, dtype=np.int64).reshape(-1, count)
    return cells[:, _GMSH_TET10] if element == "tet10" else cells


def numbered(gmsh: ModuleType, cells: IntArray) -> tuple[IntArray, Array]:
    """The N different node tags in `cells`, ascending, and the coordinates (N×3) of these nodes.

    The index of a tag in the first array is the row of its node in the second.
    """
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    used = np.unique(cells)
    rows = order[np.searchsorted(tags[order], used)]
    return used, np.asarray(coordinates).reshape(-1, 3)[rows]
