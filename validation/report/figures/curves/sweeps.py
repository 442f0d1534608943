"""Curves over the stroke, on postures that lie closer together towards its ends."""

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import ModelName, ModelOptions
from validation.studies.quantities import Deflections, deflections_of


def stations(robot: Biglide, count: int) -> Array:
    """`count` positions x of B (m) over the stroke, both ends included, cosine-spaced.

    Curves go like √(L² − x²) at the ends of the stroke, which is smooth in the angle.
    """
    first, last = robot.stroke
    angles = np.linspace(0.0, np.pi, count)
    x: Array = first + 0.5 * (last - first) * (1.0 - np.cos(angles))
    return np.clip(x, first, last)


def deflections_at(
    model: ModelName, robot: Biglide, x: Array, options: ModelOptions
) -> Deflections:
    """Deflections (µm) with B at each `x` (m)."""
    return deflections_of(
        np.array([robot_compliance(model, robot, float(value), options) for value in x])
    )


def frequencies_at(
    model: ModelName, robot: Biglide, x: Array, count: int, options: ModelOptions
) -> Array:
    """First `count` frequencies (Hz, len(x) × count) with B at each `x` (m)."""
    return np.array([robot_frequencies(model, robot, float(value), count, options) for value in x])
