"""Errors of displacements by a plain rule: column by column, and over many directions of force."""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array

AXES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")


def directions(count: int) -> Array:
    """Unit vectors (n×3) evenly over half the sphere, along a spiral of Fibonacci's."""
    height = (np.arange(count) + 0.5) / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(count)
    radius = np.sqrt(1.0 - height**2)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])


def plain_errors(compliances: Array, references: Array) -> Mapping[str, Array]:
    """|u − u*|/|u*| under a unit load of every axis, and the largest over thousands of forces.

    Both p×6×6; p numbers for each quantity. Directions of force lie evenly on the sphere, and so
    that the displacements which they cause do.
    """
    even = directions(2000)
    found: dict[str, list[float]] = {name: [] for name in (*AXES, "any_force")}
    for own, due in zip(compliances, references, strict=True):
        for k, name in enumerate(AXES):
            part = range(3) if k < 3 else range(3, 6)
            off = sum((own[i, k] - due[i, k]) ** 2 for i in part)
            found[name].append(float(np.sqrt(off / sum(due[i, k] ** 2 for i in part))))
        tried = np.vstack([even, even @ np.linalg.pinv(due[:3, :3]).T])
        tried = tried / np.linalg.norm(tried, axis=1, keepdims=True)
        moved = np.linalg.norm(tried @ due[:3, :3].T, axis=1)
        off_by = np.linalg.norm(tried @ (own - due)[:3, :3].T, axis=1)
        # A force can cause as much as the largest singular value says.
        least = np.sqrt(np.linalg.eigvalsh(due[:3, :3].T @ due[:3, :3])[-1]) / 20.0
        found["any_force"].append(float(np.max(off_by / np.maximum(moved, least))))
    return {name: np.array(errors) for name, errors in found.items()}
