"""A robot's subject with two made-up models of which every error is known beforehand.

`beam` is 4 % too soft in every direction of load and 4 % too high in every frequency, f2 of its
reference is known to ± 2 % alone; `vjm` is right, and says nothing of frequencies.
"""

from dataclasses import replace

import numpy as np

from validation.adequacy.matrix import Coordinate
from validation.adequacy.response import (
    Alternative,
    Candidate,
    Reference,
    Response,
    Subject,
    Vibration,
)

ERROR, OPEN = 0.04, 0.02
# The interval of f2's error: (1 + e)(1 ± u) − 1.
F2 = (ERROR - (1.0 + ERROR) * OPEN, ERROR + (1.0 + ERROR) * OPEN)
POSES = np.array([[0.3], [0.7]])


def toy_subject(modes):
    """The subject with so many modes, at two poses."""
    compliance = np.array([np.diag([1.0, 2.0, 3.0, 40.0, 50.0, 60.0])] * len(POSES)) * 1e-8
    frequencies = np.array([100.0 * np.arange(1, modes + 1)] * len(POSES))
    shapes = np.array([np.eye(modes)] * len(POSES))
    truth = Response(compliance, Vibration(frequencies, shapes, np.ones_like(frequencies)))
    unsure = np.zeros_like(frequencies)
    unsure[:, 1:2] = OPEN
    beam = Response(
        (1.0 + ERROR) * compliance,
        Vibration((1.0 + ERROR) * frequencies, shapes, np.ones_like(frequencies)),
    )
    return Subject(
        robot="toy",
        coordinates=(Coordinate("x", "m"),),
        poses=POSES,
        weights=np.ones(modes),
        candidates=(
            Candidate("vjm", "virtual joints", replace(truth, vibration=None)),
            Candidate("beam", "beams", beam),
        ),
        statics=Reference("exact", (Alternative("", truth),)),
        dynamics=Reference("exact", (Alternative("", truth, dynamic=unsure),)),
    )
