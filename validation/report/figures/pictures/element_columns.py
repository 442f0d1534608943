"""Beams and segments side by side: where the middles of their elements go, as columns."""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.models.options import DEFAULT_OPTIONS
from validation.report.figures.pictures.robot_shape import centreline_points
from validation.studies.quantities import MICRO, RobotModes


def segments_like(
    robot: Biglide, x: float, segments: RobotModes, beam: RobotModes, mode: int
) -> tuple[Array, Array]:
    """Middles of the segments (m) and their displacements in the sense of the beam's mode."""
    points, lumped = centrelines(robot, x, segments, mode)
    return points, lumped * sense(robot, x, segments, beam, mode)


def sense(robot: Biglide, x: float, segments: RobotModes, beam: RobotModes, mode: int) -> float:
    """Sign that turns the segments' mode into the sense of the beam's."""
    _, lumped = centrelines(robot, x, segments, mode)
    _, fine = centrelines(robot, x, beam, mode)
    return 1.0 if np.sum(lumped * fine) >= 0.0 else -1.0


def centrelines(robot: Biglide, x: float, found: RobotModes, mode: int) -> tuple[Array, Array]:
    """Middles of the elements (n×3, m) and their displacements in a mode, both legs."""
    return centreline_points(
        robot,
        x,
        found.system,
        found.legs,
        found.modes.shapes[:, mode],
        DEFAULT_OPTIONS.elements,
    )


def shape_columns(
    robot: Biglide,
    x: float,
    beam: RobotModes,
    segments: RobotModes,
    mode: int,
    largest: float,
) -> Mapping[str, Array]:
    """Columns of a mode: where the elements are, and where beams and segments go."""
    points, fine = centrelines(robot, x, beam, mode)
    _, lumped = segments_like(robot, x, segments, beam, mode)
    columns = {f"{axis} (m)": points[:, i] for i, axis in enumerate("xyz")}
    for model, moved in (("beam FE", fine), ("segments", lumped)):
        columns |= {
            f"{model}: mode {mode + 1} along {axis} (largest of the beam model = 1)": column
            for axis, column in zip("xyz", moved.T / largest, strict=True)
        }
    return columns


def load_columns(
    robot: Biglide, x: float, beam: RobotModes, unknowns: Array, load: str
) -> Mapping[str, Array]:
    """Columns of a load case: where the elements are, and where they go (µm)."""
    points, moved = centreline_points(
        robot, x, beam.system, beam.legs, unknowns, DEFAULT_OPTIONS.elements
    )
    columns = {f"{axis} (m)": points[:, i] for i, axis in enumerate("xyz")}
    return columns | {
        f"load along {load}: displacement along {axis} (µm)": column
        for axis, column in zip("xyz", moved.T * MICRO, strict=True)
    }
