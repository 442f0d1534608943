"""Types of the arrays that models exchange, and operations on these arrays.

Matrices are dense or sparse, depending on the model. Mode shapes are the columns of a matrix.
"""

import sys
from importlib.util import LazyLoader, find_spec, module_from_spec
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray


def _load_on_first_use(name: str) -> None:
    """Defer the import of the submodule `name` of numpy until one of its attributes is used."""
    spec = find_spec(f"numpy.{name}")
    if spec is None or spec.loader is None or spec.name in sys.modules:
        return
    spec.loader = LazyLoader(spec.loader)
    module = sys.modules[spec.name] = module_from_spec(spec)
    spec.loader.exec_module(module)
    setattr(np, name, module)


# scipy imports all submodules of numpy. These two, which wrap Fortran and run tests, took a third
# of the import time and are not used here.
_load_on_first_use("f2py")
_load_on_first_use("testing")
from scipy.linalg import LinAlgError  # noqa: E402
from scipy.sparse import issparse  # noqa: E402

Array: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]
# scipy.sparse has no usable static types; the alias documents the intent.
SparseMatrix: TypeAlias = Any


def dense(matrix: SparseMatrix) -> Array:
    """Dense array of a dense or sparse matrix."""
    return np.asarray(matrix.toarray() if issparse(matrix) else matrix)


def symmetric(matrix: Array) -> Array:
    """Symmetric part of a matrix (n×n), for matrices that are symmetric except for round-off."""
    return np.asarray(0.5 * (matrix + matrix.T))


def unit_diagonal(matrix: Array) -> Array:
    """Scale factors d (n) for which d_i A_ij d_j has a unit diagonal, with A = `matrix` (n×n).

    Raises LinAlgError if a diagonal entry of A is not positive: A is not positive definite then.
    """
    diagonal = np.diag(matrix)
    if not (diagonal > 0.0).all():
        raise LinAlgError("an entry on the diagonal of the matrix is not positive")
    return np.asarray(1.0 / np.sqrt(diagonal))


def fix_signs(shapes: Array) -> Array:
    """Mode shapes (n×m, columns) signed so that the entry of largest magnitude of each is positive.

    Repeated computations thus return the same shapes.
    """
    largest = np.argmax(np.abs(shapes), axis=0)
    signed: Array = shapes * np.sign(shapes[largest, np.arange(shapes.shape[1])])
    return signed


def distinct(values: Array, gap: float) -> Array:
    """Ascending `values` without those that are at most `gap` above the value before them."""
    return np.asarray(values[np.r_[True, np.diff(values) > gap]])
