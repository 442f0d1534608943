"""Names for the array types that all models exchange, and what is done to any of them.

Matrices are dense or sparse, as the models have them that they come from; shapes of modes stand
in columns.
"""

import sys
from importlib.util import LazyLoader, find_spec, module_from_spec
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray


def _loaded_when_used(name: str) -> None:
    """Load a part of numpy only once something of it is used."""
    spec = find_spec(f"numpy.{name}")
    if spec is None or spec.loader is None or spec.name in sys.modules:
        return
    spec.loader = LazyLoader(spec.loader)
    module = sys.modules[spec.name] = module_from_spec(spec)
    spec.loader.exec_module(module)
    setattr(np, name, module)


# scipy takes over all that numpy has. A third of the time of loading it went into these two, which
# wrap Fortran and test, and which nobody here uses.
_loaded_when_used("f2py")
_loaded_when_used("testing")
from scipy.linalg import LinAlgError  # noqa: E402
from scipy.sparse import issparse  # noqa: E402

Array: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]
IntArray: TypeAlias = NDArray[np.int64]
# scipy.sparse carries no usable static types; the alias says what is meant.
SparseMatrix: TypeAlias = Any


def dense(matrix: SparseMatrix) -> Array:
    """The matrix as a dense array."""
    return np.asarray(matrix.toarray() if issparse(matrix) else matrix)


def unit_diagonal(matrix: Array) -> Array:
    """Scales d (n) that give d_i A_ij d_j ones on its diagonal.

    Raises LinAlgError where an entry there is not positive: A is not positive definite then.
    """
    diagonal = np.diag(matrix)
    if not (diagonal > 0.0).all():
        raise LinAlgError("an entry on the diagonal is not positive")
    return np.asarray(1.0 / np.sqrt(diagonal))


def fix_signs(shapes: Array) -> Array:
    """Shapes (n×m) with each column's largest entry made positive, so that runs repeat."""
    largest = np.argmax(np.abs(shapes), axis=0)
    signed: Array = shapes * np.sign(shapes[largest, np.arange(shapes.shape[1])])
    return signed
