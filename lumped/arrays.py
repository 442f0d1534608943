"""Names for the array types that all models exchange."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
# scipy.sparse carries no usable static types; the alias says what is meant.
SparseMatrix: TypeAlias = Any
