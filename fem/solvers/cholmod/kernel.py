"""Which of its kernels the OpenBLAS that cvxopt brings computes with.

It is of 2021 and takes processors that it does not know for the oldest one there is: on those it
reaches a third to a fifth of what they can do. The kernel that fits the processor's instructions is
named to it while it is loaded, unless the user has named one (OPENBLAS_CORETYPE).
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numpy as np

from lumped.errors import ComputationError

VARIABLE = "OPENBLAS_CORETYPE"
# By the instructions that they need, in numpy's names, the fastest first.
_KERNELS = (("SkylakeX", ("AVX512_SKX",)), ("Haswell", ("AVX2", "FMA3")))
# Of products and factors of a small matrix, relative: some thousand roundings.
_ROUNDING = 1e-12
_SIZE = 96


@contextmanager
def naming_the_kernel() -> Iterator[None]:
    """OpenBLAS, loaded meanwhile, takes the kernel that fits; later ones choose their own."""
    # What numpy found out when it was loaded; show_runtime prints it.
    core = sys.modules.get("numpy._core._multiarray_umath")
    known = getattr(core, "__cpu_features__", {})
    fitting = [name for name, needed in _KERNELS if all(known.get(one, False) for one in needed)]
    if VARIABLE in os.environ or not fitting:
        yield
        return
    os.environ[VARIABLE] = fitting[0]
    try:
        yield
    finally:
        del os.environ[VARIABLE]


@cache
def kernel() -> str:
    """The kernel that cvxopt's OpenBLAS computes with; "" where it does not say.

    Raises ComputationError where it computes a product or a factor that numpy's does not.
    """
    from cvxopt import blas, cholmod, lapack, matrix  # noqa: PLC0415  named before it is loaded

    name = ""
    with suppress(AttributeError):
        said = ctypes.CDLL(str(Path(cholmod.__file__))).openblas_get_corename
        said.restype = ctypes.c_char_p
        name = str(said().decode())
    ours = np.random.default_rng(0).normal(size=(_SIZE, _SIZE))
    product = matrix(0.0, (_SIZE, _SIZE))
    blas.gemm(matrix(ours), matrix(ours), product, transB="T")
    factor = matrix(product)
    lapack.potrf(factor)
    due = ours @ ours.T
    lower = np.linalg.cholesky(due)
    off = max(
        np.abs(np.array(product) - due).max() / np.abs(due).max(),
        np.abs(np.tril(np.array(factor)) - lower).max() / np.abs(lower).max(),
    )
    if not off < _ROUNDING:
        raise ComputationError(
            "cvxopt's OpenBLAS computes wrong products on this processor with its kernel "
            f"{name or '(unnamed)'}; "
            f"set the environment variable {VARIABLE} to another one, Prescott being the safest"
        )
    return name
