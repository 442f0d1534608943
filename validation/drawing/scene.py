"""Data records of 3-D scenes: bodies, lines, marks, labels and a camera.

Input: surfaces and points (m). Output: a `Scene`, which `rendering` draws as a picture and
`turnable` encodes for a browser.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array, IntArray
from validation.drawing.style import WIDTH
from validation.drawing.surfaces import Surface

GREY, DARK = "#b8bcc2", "#4a4f57"
_MARGIN = 0.07  # empty share of a picture on each side
# Camera above the x-y plane: direction towards the viewer, and upward direction.
ABOVE = (np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]))

# Animation of displacements: a mode swings to both sides, a load pushes to one side and releases.
Motion: TypeAlias = Literal["swing", "push"]
MarkKind: TypeAlias = Literal["square", "dot", "cross", "ground"]


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """Surface in one colour, or coloured by `values` (n) at its points.

    `motion` (n×3, m): displacement of each point in the extreme position of the animation. None if
    the body does not move.
    """

    surface: Surface
    colour: str = GREY
    values: Array | None = None
    motion: Array | None = None


@dataclass(frozen=True, eq=False)
class Wire:
    """Straight lines between pairs (e×2 indices) of points (n×3, m). `width` in pixels.

    `motion` (n×3, m): displacement of each point in the extreme position of the animation. None if
    the lines do not move.
    """

    points: Array
    pairs: IntArray
    colour: str = DARK
    width: float = 1.5
    motion: Array | None = None


@dataclass(frozen=True, eq=False)
class Marks:
    """Symbols of one kind at points (n×3, m), in front of all bodies."""

    points: Array
    kind: MarkKind
    colour: str = DARK


@dataclass(frozen=True, eq=False)
class Arrow:
    """Arrow from `tail` to `head` (3 each, m)."""

    tail: Array
    head: Array
    colour: str


@dataclass(frozen=True, eq=False)
class Label:
    """Text at a `point` (3, m). If `movable`, it is placed beside the point, with least overlap."""

    text: str
    point: Array
    colour: str = "black"
    slanted: bool = False
    movable: bool = True


@dataclass(frozen=True, eq=False)
class Scene:
    """Contents of one panel, with `camera`: directions to the viewer (3) and upwards (3).

    `limits`: values at both ends of the colour map. `bar`: label of its colour bar. `turned`:
    bodies and lines that only the scene in the browser contains. `motion`: animation in the
    browser; "swing" moves bodies to both sides of the position at rest, "push" to one side.
    `inside` (arrays n×3, m): further points that must lie within the picture.
    """

    bodies: Sequence[DrawnBody]
    camera: tuple[Array, Array]
    wires: Sequence[Wire] = ()
    title: str = ""
    limits: tuple[float, float] = (0.0, 1.0)
    bar: str = ""
    marks: Sequence[Marks] = ()
    arrows: Sequence[Arrow] = ()
    labels: Sequence[Label] = ()
    turned: Sequence[DrawnBody | Wire] = ()
    motion: Motion = "swing"
    inside: Sequence[Array] = ()

    def view(self, size: tuple[int, int]) -> "View":
        """View in which the scene fills a picture of `size` pixels."""
        points = np.vstack([*(body.surface.points for body in self.bodies), *self.inside])
        return fitted_view(points, *self.camera, size)


@dataclass(frozen=True, eq=False)
class View:
    """Parallel projection onto a picture of `size` pixels (width, height).

    `right`, `up`, `toward` (to the viewer): unit vectors. `centre` (3, m): point in the middle of
    the picture, which extends `half_height` (m) above and below it.
    """

    right: Array
    up: Array
    toward: Array
    centre: Array
    half_height: float
    size: tuple[int, int]

    def pixels(self, points: Array) -> Array:
        """Positions of points (n×3, m) in the picture (n×2, pixels from the left and the top)."""
        offset = np.asarray(points, dtype=float) - self.centre
        scale = self.size[1] / (2.0 * self.half_height)
        x = self.size[0] / 2.0 + scale * (offset @ self.right)
        y = self.size[1] / 2.0 - scale * (offset @ self.up)
        return np.column_stack([x, y])


def fitted_view(points: Array, toward: Array, up: Array, size: tuple[int, int]) -> View:
    """View that contains all `points` (n×3, m), with `toward` (3) to the viewer and `up` (3)."""
    toward = np.asarray(toward, dtype=float) / np.linalg.norm(toward)
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    upwards = np.cross(toward, right)
    plane = points @ np.column_stack([right, upwards])
    low, high = plane.min(axis=0), plane.max(axis=0)
    middle = (low + high) / 2.0
    width, height = size
    half = np.maximum((high - low) / 2.0, 1e-9) / (1.0 - 2.0 * _MARGIN)
    depth = float(np.mean(points @ toward))
    return View(
        right=right,
        up=upwards,
        toward=toward,
        centre=middle[0] * right + middle[1] * upwards + depth * toward,
        half_height=float(max(half[1], half[0] * height / width)),
        size=size,
    )


def readable_factor(largest: float, target: float) -> float:
    """Largest factor 1, 2 or 5 · 10ᵏ for which factor · `largest` is at most `target`.

    `largest` and `target` have the same unit. 1 if `largest` is zero.
    """
    if not largest > 0.0:
        return 1.0
    exact = target / largest
    decade = 10.0 ** np.floor(np.log10(exact))
    steps = np.array([1.0, 2.0, 5.0])
    # Round-off must not turn an exact 5 into 2.
    return float(steps[steps * decade <= exact * (1.0 + 1e-12)][-1] * decade)


@dataclass(frozen=True, eq=False)
class SceneGrid:
    """Scenes with a caption, in `columns`, in a picture of `width` (inches).

    `height`: height of each scene (inches). If it is None, it follows from the proportions of the
    first scene. If `turned`, each scene can be turned in the page. `data`: numbers of the scenes as
    CSV. `title` replaces the title of the planned figure if it is not "".
    """

    caption: str
    scenes: Sequence[Scene]
    columns: int = 1
    height: float | None = None
    width: float = WIDTH
    turned: bool = True
    data: str = ""
    title: str = ""
