"""Graphics card simulated by SciPy: the calls of CuPy and nvmath by `fem.solvers.backends.cudss`.

Arrays of the card refuse arrays of the host, as CuPy does. The library counts by dense eigenvalues,
solves by SuperLU and replaces zero pivots without pairing them.
"""

import ctypes
import sys
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import count
from types import ModuleType, SimpleNamespace

import numpy as np
from scipy.sparse import csr_array, diags_array, issparse, triu
from scipy.sparse.linalg import splu

from fem.solvers.backends import cudss

MEMORY = 8_000_000_000


class OutOfMemoryError(MemoryError):
    """Error of cupy.cuda.memory."""


class CUDARuntimeError(RuntimeError):
    """Error of cupy.cuda.runtime."""


class CuDSSError(Exception):
    """Error of nvmath.bindings.cudss."""


class CardArray(np.ndarray):
    """Array in the memory of the card."""

    @property
    def data(self):
        return SimpleNamespace(ptr=self.ctypes.data)

    def get(self):
        return np.array(self.view(np.ndarray))

    def set(self, values):
        assert type(values) is np.ndarray
        assert (values.shape, values.dtype) == (self.shape, self.dtype)
        self.view(np.ndarray)[...] = values

    def __getitem__(self, key):
        refuse_host(key if isinstance(key, tuple) else (key,))
        return self.view(np.ndarray)[on_host(key)].view(CardArray)

    def __setitem__(self, key, value):
        refuse_host((*(key if isinstance(key, tuple) else (key,)), value))
        self.view(np.ndarray)[on_host(key)] = on_host(value)

    def __array_ufunc__(self, ufunc, method, *inputs, out=None, **options):
        refuse_host(inputs)
        if out is not None:
            options["out"] = tuple(array.view(np.ndarray) for array in out)
        result = getattr(ufunc, method)(*map(on_host, inputs), **options)
        return out[0] if out is not None else np.asarray(result).view(CardArray)

    def __array_function__(self, function, _types, inputs, options):
        refuse_host(inputs)
        result = function(*map(on_host, inputs), **options)
        return np.asarray(result).view(CardArray)


def refuse_host(inputs):
    for value in inputs:
        if type(value) is np.ndarray:
            raise TypeError("Unsupported type <class 'numpy.ndarray'>")


def on_host(value):
    if isinstance(value, tuple):
        return tuple(map(on_host, value))
    return value.view(np.ndarray) if isinstance(value, CardArray) else value


class CardMatrix:
    """Sparse matrix in the memory of the card."""

    def __init__(self, content, shape=None):
        if isinstance(content, tuple):
            content = csr_array(tuple(map(on_host, content)), shape=shape)
        assert issparse(content)
        self.content = content
        self.shape = content.shape

    @property
    def data(self):
        return on_card(self.content.data)

    def __matmul__(self, block):
        assert isinstance(block, CardArray)
        return on_card(self.content @ on_host(block))

    @property
    def T(self):
        return CardMatrix(self.content.T)

    def diagonal(self):
        return on_card(self.content.diagonal())


def on_card(values, dtype=None, order=None):
    return np.array(on_host(values), dtype=dtype, order=order).view(CardArray)


class Phase(IntEnum):
    ANALYSIS = 3
    FACTORIZATION = 4
    REFACTORIZATION = 8
    SOLVE = 1008


class DataParam(IntEnum):
    INFO = 0
    NPIVOTS = 2
    INERTIA = 3
    MEMORY_ESTIMATES = 13


@dataclass
class FakeCard:
    """State of the card: objects by number, calls up to now, free bytes.

    `fails` contains the name of a call, the number of successful calls of this name, and the error
    that this and all later calls raise.
    """

    free: int = MEMORY
    fails: tuple[str, Exception, int] | None = None
    calls: list[str] = field(default_factory=list)
    _objects: dict[int, object] = field(default_factory=dict)
    _numbers: count = field(default_factory=lambda: count(1))

    def call(self, name):
        self.calls.append(name)
        if self.fails and self.calls.count(self.fails[0]) > self.fails[2]:
            raise self.fails[1]

    @property
    def alive(self):
        """Number of objects that have not been destroyed."""
        return len(self._objects)

    def make(self, content):
        number = next(self._numbers)
        self._objects[number] = content
        return number

    def destroy(self, *numbers):
        del self._objects[numbers[-1]]

    def matrix_create_csr(self, rows, _columns, entries, offsets, _end, indices, values, *_kinds):
        arrays = (
            array_at(values, entries, ctypes.c_double),
            array_at(indices, entries, ctypes.c_int32),
            array_at(offsets, rows + 1, ctypes.c_int32),
        )
        return self.make((arrays, rows))

    def matrix_create_dn(self, rows, columns, leading, values, _kind, _layout):
        assert leading == rows
        return self.make(array_at(values, rows * columns, ctypes.c_double).reshape(columns, rows).T)

    def execute(self, _handle, phase, _config, data, matrix, solution, right):
        phase = Phase(phase)
        self.call(phase.name)
        state, (arrays, rows) = self._objects[data], self._objects[matrix]
        if phase is Phase.ANALYSIS:
            state["analysed"] = True
        elif phase is Phase.SOLVE:
            self._objects[solution][...] = state["factor"].solve(np.array(self._objects[right]))
        else:
            assert state["analysed"]
            assert (phase is Phase.REFACTORIZATION) == ("factor" in state)
            upper = csr_array(arrays, shape=(rows, rows))
            full = (upper + triu(upper, 1).T).tocsc()
            values = np.linalg.eigvalsh(full.toarray())
            tiny = np.finfo(float).eps * np.abs(values).max()
            state["inertia"] = int((values > tiny).sum()), int((values < -tiny).sum())
            lifted = full.diagonal() == 0.0
            state["replaced"] = int(lifted.sum()) + int((np.abs(values) <= tiny).sum())
            singular = bool((np.abs(values) <= tiny).any())
            state["factor"] = splu(
                (full + diags_array(1e-3 * tiny * np.ones(rows) * singular)).tocsc()
            )

    def data_get(self, _handle, data, name, target, size, _written):
        state = self._objects[data]
        match DataParam(name):
            case DataParam.INERTIA:
                array_at(target, 2, ctypes.c_int32)[:] = state["inertia"]
            case DataParam.NPIVOTS:
                array_at(target, 1, ctypes.c_int32)[:] = state["replaced"]
            case DataParam.INFO:
                array_at(target, 1, ctypes.c_int32)[:] = 0
            case DataParam.MEMORY_ESTIMATES:
                assert size == 128
                array_at(target, 16, ctypes.c_uint64)[:4] = 10, 1_000_000, 10, 1000


def array_at(pointer, size, kind):
    return np.frombuffer((kind * size).from_address(pointer), dtype=kind)


def insert_card(monkeypatch):
    """Replace any real card by a fake one, and discard what was stored about the real one."""
    card = FakeCard()
    stream = SimpleNamespace(ptr=0, synchronize=lambda: card.call("synchronize"))
    runtime = SimpleNamespace(
        CUDARuntimeError=CUDARuntimeError,
        getDevice=lambda: 0,
        getDeviceCount=lambda: 1,
        getDeviceProperties=lambda _: {"name": b"fake card", "totalGlobalMem": MEMORY},
        memGetInfo=lambda: (card.free, MEMORY),
    )

    def empty(shape, order="C"):
        card.call("empty")
        return np.empty(shape, order=order).view(CardArray)

    modules = {
        "cupy": {
            "asarray": on_card,
            "asfortranarray": lambda values: np.asfortranarray(on_host(values)).view(CardArray),
            "empty": empty,
            "zeros": lambda shape, order="C": np.zeros(shape, order=order).view(CardArray),
            "abs": np.abs,
            "get_default_memory_pool": lambda: SimpleNamespace(free_all_blocks=lambda: None),
            "cuda": SimpleNamespace(
                get_current_stream=lambda: stream,
                memory=SimpleNamespace(OutOfMemoryError=OutOfMemoryError),
                runtime=runtime,
            ),
        },
        "cupyx": {},
        "cupyx.scipy": {},
        "cupyx.scipy.sparse": {"csr_matrix": CardMatrix},
        "cuda": {},
        "cuda.pathfinder": {
            "load_nvidia_dynamic_lib": lambda _: SimpleNamespace(abs_path="/nowhere/libcudss.so.0")
        },
        "nvmath": {},
        "nvmath.bindings": {},
    }
    for name, content in modules.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    library = SimpleNamespace(
        ConfigParam=IntEnum("ConfigParam", ["HOST_NTHREADS"]),
        DataParam=DataParam,
        DataType=IntEnum("DataType", ["R_32I", "R_64F"]),
        IndexBase=IntEnum("IndexBase", ["ZERO"]),
        Layout=IntEnum("Layout", ["COL_MAJOR"]),
        MatrixType=IntEnum("MatrixType", ["SYMMETRIC"]),
        MatrixViewType=IntEnum("MatrixViewType", ["UPPER"]),
        Phase=Phase,
        cuDSSError=CuDSSError,
        config_create=lambda: card.make({}),
        config_destroy=card.destroy,
        config_set=lambda *_: None,
        create=lambda: 0,
        data_create=lambda _: card.make({}),
        data_destroy=card.destroy,
        data_get=card.data_get,
        execute=card.execute,
        get_property=lambda index: (0, 8, 0)[index],
        matrix_create_csr=card.matrix_create_csr,
        matrix_create_dn=card.matrix_create_dn,
        matrix_destroy=card.destroy,
        set_stream=lambda *_: None,
        set_threading_layer=lambda *_: None,
    )
    sys.modules["nvmath.bindings"].cudss = library
    monkeypatch.setattr("fem.extras.find_spec", lambda _: True)
    discard_card()
    return card


def discard_card():
    """Discard the card found earlier and the library's context on it."""
    for remembered in (cudss._device_or_reason, cudss._handle):
        remembered.cache_clear()
