"""Factors by cuDSS, on a graphics card.

cuDSS factorises PᵀAP = L D Lᵀ with diagonal pivots, in an order by nested dissection that is
computed on the host. It replaces pivots that are too small and counts them. Pivots are not paired
as in the method of Bunch and Kaufman. Each factor is therefore checked by the backward error of a
solution. Among the matrices with one sparsity pattern, only the factor of the last one is on the
card. An earlier factor is computed again if it is needed.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from fem.extras import missing_message
from fem.machine import threads
from fem.solvers.backends.factor_checks import is_accurate
from fem.solvers.backends.protocol import HOST, DeviceError, Space
from lumped.arrays import Array, SparseMatrix

# Number of right-hand sides solved together. The deterministic mode of the library solves one at a
# time and is 20 times slower per column. It is not used, so that bits differ between factors.
_COLUMNS_AT_ONCE = 32
# Classes of errors that the libraries of the card raise. cuBLAS, cuSPARSE and CUDA raise
# RuntimeError.
_FAILURES = (RuntimeError, OSError, ImportError, TypeError, ValueError, NotImplementedError)
# Fraction of the free memory that the estimate for a factorisation may reach.
_USABLE = 0.95
# Number of spare columns of a growing basis, as a fraction of those in use.
_GROWTH = 0.5


@dataclass(frozen=True)
class Device:
    """A graphics card with its name and memory (bytes)."""

    name: str
    memory: int


@cache
def _device_or_reason() -> Device | str:
    """The graphics card on which CUDA computes, or the reason why there is none."""
    if message := missing_message("gpu"):
        return message
    try:
        import cupy  # noqa: PLC0415  takes a second, and small matrices do not need it

        if not cupy.cuda.runtime.getDeviceCount():
            return "CUDA finds no graphics card"
        properties = cupy.cuda.runtime.getDeviceProperties(cupy.cuda.runtime.getDevice())
    except Exception as error:  # noqa: BLE001  drivers fail in many ways
        reason = " ".join(str(error).split()) or type(error).__name__
        return f"CUDA finds no graphics card ({reason})"
    return Device(properties["name"].decode(), int(properties["totalGlobalMem"]))


def device() -> Device | None:
    """Graphics card on which CUDA computes. None without a card or without the extra `gpu`."""
    card_or_reason = _device_or_reason()
    return card_or_reason if isinstance(card_or_reason, Device) else None


def device_fault() -> str:
    """The reason why no graphics card can be used: packages, driver or card.

    "" if a card can be used.
    """
    card_or_reason = _device_or_reason()
    return card_or_reason if isinstance(card_or_reason, str) else ""


def title() -> str:
    """Name and version of the library, and name of the card."""
    card = device()
    return f"cuDSS {_version()} on {card.name if card else 'no device'}"


def _version() -> str:
    from nvmath.bindings import cudss  # noqa: PLC0415

    return ".".join(str(cudss.get_property(component)) for component in range(3))


@contextmanager
def _device_errors() -> Iterator[None]:
    """Context that converts each error of the card and of its libraries to DeviceError."""
    import cupy  # noqa: PLC0415
    from nvmath.bindings import cudss  # noqa: PLC0415

    try:
        yield
    except cupy.cuda.memory.OutOfMemoryError as error:
        raise DeviceError("out of memory on the card") from error
    except (cudss.cuDSSError, *_FAILURES) as error:
        raise DeviceError(" ".join(str(error).split()) or type(error).__name__) from error


class DeviceSpace:
    """Memory of the graphics card, see `Space`."""

    def errors(self) -> AbstractContextManager[None]:
        """Context in which errors of the graphics card are raised as DeviceError."""
        return _device_errors()

    def put(self, array: Any) -> Any:
        """Copy of a host array in the memory of the card."""
        import cupy  # noqa: PLC0415

        with _device_errors():
            return cupy.asarray(array, order="F")

    def get(self, array: Any) -> Array:
        """Copy of an array of the card in the memory of the host."""
        with _device_errors():
            return np.asarray(array.get())

    def matrix(self, matrix: SparseMatrix) -> Any:
        """Copy of a sparse matrix (csr) in the memory of the card."""
        from cupyx.scipy.sparse import csr_matrix  # noqa: PLC0415

        with _device_errors():
            return csr_matrix(matrix)

    def columns(self, size: int, count: int, filled: Any) -> Any:
        """Array of `size` rows that begins with the columns `filled` and has some spare columns.

        It has at most `count` columns. They are not all allocated at once, because they would take
        memory.
        """
        import cupy  # noqa: PLC0415

        used = int(filled.shape[1])
        with _device_errors():
            columns = cupy.empty((size, min(count, used + max(64, int(_GROWTH * used)))), order="F")
            columns[:, :used] = filled
        return columns


@cache
def space() -> DeviceSpace:
    """Memory of the graphics card."""
    return DeviceSpace()


def space_of(array: Any) -> Space:
    """Memory that contains an array: of the host, or of the graphics card."""
    return HOST if type(array) is np.ndarray else space()


@cache
def _handle() -> int:
    """Handle of the library cuDSS in this process.

    It is set up such that orderings are computed by several threads of the host.
    """
    from cuda.pathfinder import load_nvidia_dynamic_lib  # noqa: PLC0415
    from nvmath.bindings import cudss  # noqa: PLC0415

    handle = int(cudss.create())
    library = Path(load_nvidia_dynamic_lib("cudss").abs_path or "")
    for layer in sorted(library.parent.glob("libcudss_mtlayer_gomp.so*")):
        cudss.set_threading_layer(handle, str(layer))
    return handle


class CudssNumeric:
    """Factor on the graphics card, see `Numeric`."""

    def __init__(self, ordering: "CudssOrdering", values: Array, negative: int, zero: int) -> None:
        self._ordering, self._values = ordering, values
        self.negative, self.zero = negative, zero

    def solve(self, columns: Any) -> Any:
        """Solutions (n×k), on the host or on the card like the right-hand sides `columns`."""
        self._ordering.load(self._values)
        if type(columns) is not np.ndarray:
            return self._ordering.solved(columns)
        block = space().put(np.asarray(columns, dtype=np.float64))
        return np.ascontiguousarray(space().get(self._ordering.solved(block)))


class CudssOrdering:
    """Order of elimination for a lower triangle (csc n×n), see `Ordering`.

    cuDSS receives the upper triangle (csr), which has the same three arrays. Raises DeviceError.
    """

    def __init__(self, lower: SparseMatrix) -> None:
        import cupy  # noqa: PLC0415
        from nvmath.bindings import cudss  # noqa: PLC0415

        self.space = space()
        self._size = int(lower.shape[0])
        self._loaded: Array | None = None
        self._factorised = False
        integer = cudss.DataType.R_32I
        with _device_errors():
            self._offsets = cupy.asarray(lower.indptr, dtype=np.int32)
            self._columns = cupy.asarray(lower.indices, dtype=np.int32)
            self._entries = cupy.asarray(lower.data, dtype=np.float64)
            self._vector = cupy.zeros((self._size, 1), order="F")
            handle = _handle()
            self._config, self._data = cudss.config_create(), cudss.data_create(handle)
            self._matrix = cudss.matrix_create_csr(
                self._size,
                self._size,
                int(lower.nnz),
                self._offsets.data.ptr,
                0,
                self._columns.data.ptr,
                self._entries.data.ptr,
                integer,
                integer,
                cudss.DataType.R_64F,
                cudss.MatrixType.SYMMETRIC,
                cudss.MatrixViewType.UPPER,
                cudss.IndexBase.ZERO,
            )
            handles = self._config, self._data, self._matrix
            # At the end of the process the memory of the card is freed anyway.
            finalize(self, _destroy, cudss, handle, *handles).atexit = False
            self._configure(cudss.ConfigParam.HOST_NTHREADS, threads())
            self._execute(cudss.Phase.ANALYSIS, self._vector, self._vector)
            estimates = np.zeros(16, dtype=np.uint64)
            self._read(cudss.DataParam.MEMORY_ESTIMATES, estimates)
        self.device_bytes, self.peak_bytes = int(estimates[1]), int(estimates[3])

    def factorise(self, values: Array, part: str) -> CudssNumeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is not used. If the factor is not accurate, its `zero` is at least 1. Raises
        DeviceError.
        """
        del part
        self.load(values)
        negative, zero = self._signs()
        if not zero and not self._is_accurate():
            zero = 1
        return CudssNumeric(self, values, negative, zero)

    def load(self, values: Array) -> None:
        """Factorise the matrix with these `values`, unless its factor is on the card already."""
        import cupy  # noqa: PLC0415
        from nvmath.bindings import cudss  # noqa: PLC0415

        if self._loaded is values:
            return
        with _device_errors():
            if not self._factorised:
                self._require_memory()
            self._loaded = None
            self._entries.set(np.ascontiguousarray(values, dtype=np.float64))
            again = self._factorised
            phase = cudss.Phase.REFACTORIZATION if again else cudss.Phase.FACTORIZATION
            self._execute(phase, self._vector, self._vector)
            cupy.cuda.get_current_stream().synchronize()
        self._loaded, self._factorised = values, True

    def solved(self, columns: Any) -> Any:
        """Solutions (n×k, on the card) with the factor that is on the card."""
        import cupy  # noqa: PLC0415
        from nvmath.bindings import cudss  # noqa: PLC0415

        with _device_errors():
            right = cupy.asfortranarray(columns)
            solution = cupy.empty(columns.shape, order="F")
            for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE):
                some = slice(start, start + _COLUMNS_AT_ONCE)
                self._execute(cudss.Phase.SOLVE, solution[:, some], right[:, some])
            cupy.cuda.get_current_stream().synchronize()
        return solution

    def _require_memory(self) -> None:
        import cupy  # noqa: PLC0415

        cupy.get_default_memory_pool().free_all_blocks()
        free = int(_USABLE * cupy.cuda.runtime.memGetInfo()[0])
        if self.device_bytes > free:
            raise DeviceError(
                f"{self._size} unknowns need about {self.device_bytes / 1e9:.1f} GB of the card's "
                f"memory and {free / 1e9:.1f} GB are free"
            )

    def _signs(self) -> tuple[int, int]:
        """Numbers of negative entries of D in the factors LDLᵀ, and of replaced pivots."""
        from nvmath.bindings import cudss  # noqa: PLC0415

        inertia, replaced = np.zeros(2, dtype=np.int32), np.zeros(1, dtype=np.int32)
        failed = np.zeros(1, dtype=np.int32)
        with _device_errors():
            self._read(cudss.DataParam.INERTIA, inertia)
            self._read(cudss.DataParam.NPIVOTS, replaced)
            self._read(cudss.DataParam.INFO, failed)
        positive, negative = int(inertia[0]), int(inertia[1])
        unsigned = self._size - positive - negative
        return negative, max(int(replaced[0]), unsigned, int(failed[0] != 0))

    def _is_accurate(self) -> bool:
        """True if a solution with the factor has a small backward error."""
        from cupyx.scipy.sparse import csr_matrix  # noqa: PLC0415

        with _device_errors():
            arrays = self._entries, self._columns, self._offsets
            upper = csr_matrix(arrays, shape=(self._size, self._size))
            return is_accurate(upper, self.solved, space().put)

    def _execute(self, phase: int, solution: Any, right: Any) -> None:
        import cupy  # noqa: PLC0415
        from nvmath.bindings import cudss  # noqa: PLC0415

        handle, real, layout = _handle(), cudss.DataType.R_64F, cudss.Layout.COL_MAJOR
        cudss.set_stream(handle, cupy.cuda.get_current_stream().ptr)
        wrappers = [
            cudss.matrix_create_dn(
                self._size, block.shape[1], self._size, block.data.ptr, real, layout
            )
            for block in (solution, right)
        ]
        try:
            cudss.execute(handle, phase, self._config, self._data, self._matrix, *wrappers)
        finally:
            for matrix in wrappers:
                cudss.matrix_destroy(matrix)

    def _configure(self, name: int, value: int) -> None:
        from nvmath.bindings import cudss  # noqa: PLC0415

        setting = np.array([value], dtype=np.int32)
        cudss.config_set(self._config, name, setting.ctypes.data, setting.nbytes)

    def _read(self, name: int, target: NDArray[np.integer]) -> None:
        from nvmath.bindings import cudss  # noqa: PLC0415

        written = np.zeros(1, dtype=np.uint64)
        size = target.nbytes
        cudss.data_get(_handle(), self._data, name, target.ctypes.data, size, written.ctypes.data)


def _destroy(library: ModuleType, handle: int, config: int, data: int, matrix: int) -> None:
    """Free the memory of an ordering in the library. Errors of a lost card are ignored."""
    try:
        library.matrix_destroy(matrix)
        library.data_destroy(handle, data)
        library.config_destroy(config)
    except library.cuDSSError:
        return
