"""Memory that an array is in: the host's, or that of a graphics card."""

from typing import Any

import numpy as np

from fem.solvers.backends import cudss
from fem.solvers.backends.protocol import HOST, Space


def space_of(array: Any) -> Space:
    """Memory of an array: functions of arrays compute where these are."""
    return HOST if type(array) is np.ndarray else cudss.space()
