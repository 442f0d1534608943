"""Memory in which an array is stored: that of the host, or of a graphics card."""

from typing import Any

import numpy as np

from fem.solvers.backends import cudss
from fem.solvers.backends.protocol import HOST, Space


def space_of(array: Any) -> Space:
    """Memory in which an array is stored. Computations are carried out there."""
    return HOST if type(array) is np.ndarray else cudss.space()
