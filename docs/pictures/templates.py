"""Draws docs/pictures/templates.png: the mechanisms of `flexproof new` without a page of their own.

python docs/pictures/templates.py
"""

from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.image import imread

from lumped.robot_file import load_robot
from validation.drawing.rendering import pictured
from validation.kinematics.picture import scene
from validation.kinematics.poses import postures_on_path

PICTURE = Path(__file__).resolve().parent / "templates.png"
ROBOTS = ("scara", "gantry", "stage", "5R", "tricept", "linear-delta")


def draw() -> None:
    """All robots in the middle of their paths, with the names of bodies and joints."""
    figure, axes = plt.subplots(2, 3, figsize=(12.0, 8.0), dpi=80, layout="constrained")
    for name, ax in zip(ROBOTS, axes.flat, strict=True):
        mechanism = load_robot(name).mechanism
        postures = postures_on_path(mechanism, mechanism.poses)
        drawn = pictured([scene(mechanism, postures, named=False)])
        PICTURE.write_bytes(drawn.png)
        ax.imshow(imread(PICTURE))
        ax.set_title(name)
        ax.set_axis_off()
    figure.savefig(PICTURE, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    draw()
