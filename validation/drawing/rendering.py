"""Pictures of scenes: VTK draws the bodies, matplotlib the marks, labels and colour bars.

Input: a list of `Scene`. Output: a PNG, or the reason why this machine cannot draw it.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Canvas
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from lumped.arrays import Array
from validation.drawing.opengl import MESSAGE, can_draw
from validation.drawing.scene import DARK, DrawnBody, Label, MarkKind, Marks, Scene, View
from validation.drawing.style import COLOUR_MAP, ORANGE, VERMILLION, WIDTH, plot_style

DOTS_PER_INCH = 180
_PER_POINT = DOTS_PER_INCH / 72.0
# Heights (inches) of a title, and of a colour bar with its label.
_TITLE, _BAR = 0.3, 0.5
# Colours whose channels are all at least this value are replaced by white.
_NEARLY_WHITE = 246
# Colours of marks and arrows.
_MARK_COLOURS = (DARK, ORANGE, VERMILLION)
# Characters of a title per inch; size (pt) of labels in a picture.
_LETTERS, _TEXT = 14.0, 7.5
# Symbol of ground: a triangle with its tip just below the point, and hatching. Corners and codes of
# matplotlib paths (1: move, 2: line).
_FOOT = mpl.path.Path(
    [(0.0, -0.15), (-0.5, -0.8), (0.5, -0.8), (0.0, -0.15)]
    + [end for x in (-0.3, -0.05, 0.2, 0.45) for end in ((x, -0.8), (x - 0.18, -1.0))],
    [1, 2, 2, 2, *(1, 2) * 4],
)
_MARKS: dict[MarkKind, dict[str, Any]] = {
    "square": {"marker": "s", "ms": 3.4, "mec": "black", "mew": 0.5},
    "dot": {"marker": ".", "ms": 4.0},
    "cross": {"marker": "P", "ms": 8.0, "mec": "white", "mew": 0.8},
    "ground": {"marker": _FOOT, "ms": 34.0, "mfc": "none", "mew": 0.8},
}
# Possible origins of the coordinate triad, in order of preference (fractions of width and height).
_CORNERS = ((0.08, 0.92), (0.78, 0.92), (0.08, 0.3), (0.78, 0.3))
# Length of the triad's axes, and smallest distance of its centre from bodies (pt).
_TRIAD, _CLEARANCE = 24.0, 26.0


@dataclass(frozen=True)
class Picture:
    """Picture as PNG. `left_out` is the reason if there is none."""

    png: bytes = b""
    left_out: str = ""


def pictured(
    scenes: Sequence[Scene],
    columns: int = 1,
    height: float | None = None,
    width: float = WIDTH,
    title: str = "",
) -> Picture:
    """Picture of scenes in `columns`, each `height` inches high, `width` inches wide in total.

    If `height` is None, it follows from the proportions of the first scene. The picture is omitted,
    with the reason, if this machine cannot draw it.
    """
    if not can_draw():
        return Picture(left_out=MESSAGE)
    with plot_style():
        return Picture(_png_of(drawn_scenes(scenes, columns, height, width, title)))


def drawn_scenes(
    scenes: Sequence[Scene],
    columns: int = 1,
    height: float | None = None,
    width: float = WIDTH,
    title: str = "",
) -> Canvas:
    """Matplotlib figure of scenes. The arguments are those of `pictured`.

    If this machine cannot draw scenes, the figure contains only the reason.
    """
    if not can_draw():
        figure = Canvas(figsize=(width, 1.0))
        figure.text(0.02, 0.5, MESSAGE, va="center", wrap=True)
        return figure
    rows, scene_height = -(-len(scenes) // columns), height or width * _shape(scenes[0])
    bars = any(scene.bar for scene in scenes)
    size = width, rows * (scene_height + _TITLE + _BAR * bars) + _TITLE * bool(title)
    with plot_style():
        picture = Canvas(figsize=size, layout=ConstrainedLayoutEngine(h_pad=0.07))
        all_axes = picture.subplots(rows, columns, squeeze=False).ravel()
        for axes in all_axes:
            axes.set_axis_off()
        for axes, scene in zip(all_axes, scenes, strict=False):
            _draw_scene(axes, scene, panel_size(columns, scene_height, width))
            letters = round(_LETTERS * width / columns)
            axes.set_title(fill(scene.title, letters), fontsize=9.0 if columns > 2 else 10.5)
            if scene.bar:
                _colour_bar(picture, axes, scene)
        if title:
            lines = (fill(line, round(12.0 * width)) for line in title.split("\n"))
            picture.suptitle("\n".join(lines), fontsize=10.0)
        picture.set_dpi(DOTS_PER_INCH)
        return picture


def panel_size(columns: int, height: float, width: float = WIDTH) -> tuple[int, int]:
    """Size in pixels (width, height) of one of `columns` panels. `height` and `width` in inches."""
    return round(width / columns * DOTS_PER_INCH), round(height * DOTS_PER_INCH)


def _shape(scene: Scene) -> float:
    """Height over width of a scene's contents, limited to 0.45 to 1.2."""
    view = scene.view((1000, 1000))
    points = np.vstack([*(body.surface.points for body in scene.bodies), *scene.inside])
    width, height = np.ptp(view.pixels(points), axis=0)
    return float(np.clip(height / width, 0.45, 1.2))


def render(scene: Scene, view: View) -> NDArray[np.uint8]:
    """Pixels (height × width × 3) of a scene on white. Call `can_draw` before."""
    import pyvista  # noqa: PLC0415  VTK must not be loaded on a machine that cannot draw

    plotter = pyvista.Plotter(off_screen=True, window_size=list(view.size))
    plotter.background_color = pyvista.Color("white")
    for body in scene.bodies:
        _add_body(plotter, body, scene.limits)
    for wire in scene.wires:
        count = np.full((len(wire.pairs), 1), 2)
        lines = pyvista.PolyData(wire.points, lines=np.hstack([count, wire.pairs]).ravel())
        plotter.add_mesh(lines, color=wire.colour, line_width=wire.width, lighting=False)
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point = view.centre
    camera.position = view.centre + 10.0 * view.half_height * view.toward
    camera.up = view.up
    camera.parallel_scale = view.half_height
    plotter.reset_camera_clipping_range()
    plotter.enable_anti_aliasing("ssaa")
    image: NDArray[np.uint8] = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return image


def _add_body(plotter: Any, body: DrawnBody, limits: tuple[float, float]) -> None:
    import pyvista  # noqa: PLC0415

    faces: Any = body.surface.faces  # pyvista accepts all integers, its annotation does not
    mesh = pyvista.PolyData.from_regular_faces(body.surface.points, faces)
    look: dict[str, Any] = {"color": body.colour}
    if body.values is not None:
        mesh["values"] = body.values
        look = {"scalars": "values", "cmap": COLOUR_MAP, "clim": list(limits)}
    plotter.add_mesh(mesh, ambient=0.35, diffuse=0.7, specular=0.05, show_scalar_bar=False, **look)


def _draw_scene(axes: Axes, scene: Scene, size: tuple[int, int]) -> None:
    """Draw a scene with marks, arrows, coordinate triad and labels, without frame and ticks.

    `size`: width and height of the picture (pixels).
    """
    view = scene.view(size)
    axes.imshow(render(scene, view), interpolation="antialiased")
    for marks in scene.marks:
        _draw_marks(axes, view, marks)
    for arrow in scene.arrows:
        start, end = view.pixels(np.array([arrow.tail, arrow.head]))
        tip = "-|>,head_width=0.3,head_length=0.6"
        axes.annotate(
            "", end, xytext=start, arrowprops={"arrowstyle": tip, "color": arrow.colour, "lw": 2.2}
        )
    _draw_triad(axes, view, clear_corner(scene, view))
    _write_labels(axes, view, scene.labels)
    axes.set(xlim=(0.0, size[0]), ylim=(size[1], 0.0))


def _draw_marks(axes: Axes, view: View, marks: Marks) -> None:
    look = {"color": marks.colour, "mfc": marks.colour, **_MARKS[marks.kind]}
    look |= {"linestyle": "", "clip_on": False}
    axes.plot(*view.pixels(marks.points).T, **look)


def _write_labels(axes: Axes, view: View, labels: Sequence[Label]) -> None:
    """Write each label at its point.

    A movable label is placed beside its point with least overlap, and a line joins them.
    """
    occupied: list[Array] = []
    for label in labels:
        (point,) = view.pixels(label.point[None])
        half_size = 0.5 * _PER_POINT * _TEXT * np.array([0.62 * len(label.text), 1.25])
        centres = [point]
        if label.movable:
            centres = [
                point + np.array(side) * (half_size + 7.0 * _PER_POINT * distance)
                for distance in (1.0, 2.0, 3.5)
                for side in ((1, -1), (-1, -1), (1, 1), (-1, 1), (0, -1), (0, 1), (1, 0), (-1, 0))
            ]
        boxes = [np.concatenate([centre - half_size, centre + half_size]) for centre in centres]
        # The small term selects the first of equally good positions.
        costs = [_overlap(box, occupied) + 1e-3 * number for number, box in enumerate(boxes)]
        best = int(np.argmin(costs))
        occupied.append(boxes[best])
        line = {"arrowstyle": "-", "color": label.colour, "lw": 0.4, "shrinkA": 0, "shrinkB": 1}
        axes.annotate(
            label.text,
            xy=tuple(point),
            xytext=tuple(centres[best]),
            ha="center",
            va="center",
            fontsize=_TEXT,
            fontstyle="italic" if label.slanted else "normal",
            color=label.colour,
            zorder=7,
            path_effects=[withStroke(linewidth=1.8, foreground="white")],
            arrowprops=line if label.movable else None,
        )


def _overlap(box: Array, boxes: Sequence[Array]) -> float:
    """Fraction of the area of `box` (x and y of two opposite corners) that other boxes cover."""
    area = 0.0
    for other in boxes:
        sides = np.minimum(box[2:], other[2:]) - np.maximum(box[:2], other[:2])
        area += float(np.prod(np.maximum(sides, 0.0)))
    return area / float(np.prod(box[2:] - box[:2]))


def _draw_triad(axes: Axes, view: View, corner: tuple[float, float]) -> None:
    """Draw the directions of x, y and z from `corner` (fractions of width and height).

    An axis nearly along the line of sight is omitted.
    """
    origin = np.array(corner) * view.size
    for name, direction in zip("xyz", np.eye(3), strict=True):
        projection = np.array([direction @ view.right, -(direction @ view.up)])
        size = float(np.linalg.norm(projection))
        if size < 0.4:
            continue
        axes.annotate(
            "",
            tuple(origin + _PER_POINT * _TRIAD * projection),
            xytext=tuple(origin),
            arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.1, "shrinkA": 0},
        )
        tip = origin + _PER_POINT * (_TRIAD + 8.0 / size) * projection
        axes.text(tip[0], tip[1], name, ha="center", va="center", fontsize=9.0)


def clear_corner(scene: Scene, view: View) -> tuple[float, float]:
    """First corner for the coordinate triad that is clear of bodies, or the one farthest from them.

    Corners are fractions of width and height.
    """
    points = view.pixels(np.vstack([body.surface.points for body in scene.bodies]))

    def distance(corner: tuple[float, float]) -> float:
        centre = np.array(corner) * view.size + 0.75 * _PER_POINT * _TRIAD * np.array([1.0, -1.0])
        return float(np.linalg.norm(points - centre, axis=1).min()) / _PER_POINT

    clear = [corner for corner in _CORNERS if distance(corner) > _CLEARANCE]
    return clear[0] if clear else max(_CORNERS, key=distance)


def _colour_bar(picture: Canvas, axes: Axes, scene: Scene) -> None:
    """Draw a horizontal colour bar under the axes, with the unit in its label."""
    mappable = mpl.cm.ScalarMappable(mpl.colors.Normalize(*scene.limits), COLOUR_MAP)
    layout: dict[str, Any] = {"fraction": 0.05, "pad": 0.02, "aspect": 28.0, "shrink": 0.8}
    bar = picture.colorbar(mappable, ax=axes, orientation="horizontal", **layout)
    bar.set_label(scene.bar)
    bar.outline.set_visible(False)


def _png_of(picture: Canvas) -> bytes:
    """PNG without date, with 256 dithered colours. Its size is half of that in full colour."""
    from PIL import Image  # noqa: PLC0415  comes with matplotlib, needed for pictures alone

    picture.set_dpi(DOTS_PER_INCH)
    canvas: Any = FigureCanvasAgg(picture)  # untyped in matplotlib
    canvas.draw()
    colours = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    # The palette is chosen from a sixteenth of the pixels, which saves most of the time.
    count = 256 - len(_MARK_COLOURS)
    reduced = colours.resize((colours.width // 4, colours.height // 4)).quantize(count)
    # Marks and arrows are too small to affect the choice, so their colours are added.
    mark_colours = [
        round(255.0 * share) for colour in _MARK_COLOURS for share in mpl.colors.to_rgb(colour)
    ]
    reduced.putpalette([*(reduced.getpalette() or [])[: 3 * count], *mark_colours])
    reduced = colours.quantize(palette=reduced, dither=Image.Dither.FLOYDSTEINBERG)
    # Tints of white become white, because averaged palette colours would shade the background.
    palette = np.array(reduced.getpalette() or []).reshape(-1, 3)
    palette[palette.min(axis=1) >= _NEARLY_WHITE] = 255
    reduced.putpalette([int(value) for value in palette.ravel()])
    content = io.BytesIO()
    reduced.save(content, format="png", optimize=True)
    return content.getvalue()
