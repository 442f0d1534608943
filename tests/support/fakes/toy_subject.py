"""Artificial subject of an assessment: two models whose errors are known.

`beam` is 4 % too soft in every direction of load and 4 % too high in every frequency. The
reference's f2 has a half-width of 2 %. `vjm` has the reference's statics and no frequencies.
"""

import numpy as np
from support.fakes.toy_responses import meshes, model, reference

from validation.references.reference import Subject
from validation.references.responses import Responses
from validation.responses.statics_and_modes import PathModes, Statics
from validation.verdicts import Coordinate

ERROR, OPEN = 0.04, 0.02
# The interval of f2's error: (1 + e)(1 ± u) − 1.
F2 = (ERROR - (1.0 + ERROR) * OPEN, ERROR + (1.0 + ERROR) * OPEN)
POSES = np.array([[0.3], [0.7]])


def toy_subject(count, robot=None):
    """Subject with `count` modes at two poses. `robot` is needed if a test uses its robot file."""
    compliances = np.array([np.diag([1.0, 2.0, 3.0, 40.0, 50.0, 60.0])] * len(POSES)) * 1e-8
    statics = Statics(compliances, np.zeros((len(POSES), 0, 6)))
    frequencies = np.array([100.0 * np.arange(1, count + 1)] * len(POSES))
    shapes = np.array([np.eye(count)] * len(POSES))
    weights, energy_shares = np.ones(count), np.ones_like(frequencies)
    modes = PathModes(frequencies, shapes, weights, energy_shares)
    unsure = np.zeros_like(frequencies)
    unsure[:, 1:2] = OPEN
    higher = PathModes((1.0 + ERROR) * frequencies, shapes, weights, energy_shares)
    return Subject(
        robot="toy",
        coordinates=(Coordinate("x", "m"),),
        poses=POSES,
        responses=Responses(robot),
        models=(model("vjm", statics), model("beam", (1.0 + ERROR) * statics, higher)),
        statics=reference("exact", {"": statics}),
        dynamics=reference("exact", {"": modes}, meshes(frequencies=unsure)),
    )
