"""From bodies to a picture: VTK draws the bodies, matplotlib everything that is written on them."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Canvas
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from validation.drawing.opengl import MESSAGE, usable_window
from validation.drawing.style import WIDTH
from validation.drawing.surfaces import Surface, View, fitted_view, pixels

# Told apart by colour-blind readers, and light against dark when printed in grey.
COLOUR_MAP = "viridis"
GREY, DARK = "#b8bcc2", "#4a4f57"
DOTS_PER_INCH = 180


@dataclass(frozen=True)
class Body:
    """A surface to be drawn, coloured by its values where it has any; `edge` colours its mesh."""

    surface: Surface
    colour: str = GREY
    edge: str | None = None


@dataclass(frozen=True)
class Wire:
    """Straight pieces between pairs (e×2) of points (n×3, m); `motion` as of a surface."""

    points: Array
    pairs: IntArray
    colour: str = DARK
    width: float = 1.5
    motion: Array | None = None


@dataclass(frozen=True)
class Scene:
    """What one panel shows; `limits` are the values at both ends of the colour map."""

    view: View
    bodies: Sequence[Body]
    limits: tuple[float, float]
    wires: Sequence[Wire] = field(default_factory=tuple)


def render(scene: Scene) -> NDArray[np.uint8]:
    """The scene as pixels (height × width × 3) on white, where this machine can draw."""
    import pyvista  # noqa: PLC0415  VTK must not be loaded where it cannot draw

    view = scene.view
    plotter = pyvista.Plotter(off_screen=True, window_size=list(view.size))
    plotter.background_color = pyvista.Color("white")
    add_to(plotter, scene)
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


def add_to(plotter: Any, scene: Scene, overlay: Sequence[Body | Wire] = ()) -> None:
    """Put the scene, and what is drawn over it, into a pyvista plotter."""
    import pyvista  # noqa: PLC0415  VTK must not be loaded where it cannot draw

    for part in (*scene.bodies, *scene.wires, *overlay):
        if isinstance(part, Body):
            plotter.add_mesh(_poly_data(pyvista, part.surface), **_appearance(part, scene.limits))
        else:
            count = np.full((len(part.pairs), 1), 2)
            lines = pyvista.PolyData(part.points, lines=np.hstack([count, part.pairs]).ravel())
            plotter.add_mesh(lines, color=part.colour, line_width=part.width, lighting=False)


def _poly_data(pyvista: Any, surface: Surface) -> Any:
    mesh = pyvista.PolyData.from_regular_faces(surface.points, surface.faces)
    if surface.values is not None:
        mesh["values"] = surface.values
    return mesh


def _appearance(body: Body, limits: tuple[float, float]) -> dict[str, Any]:
    look: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.7, "specular": 0.05}
    if body.surface.values is None:
        look |= {"color": body.colour}
    else:
        look |= {
            "scalars": "values",
            "cmap": COLOUR_MAP,
            "clim": list(limits),
            "show_scalar_bar": False,
        }
    if body.edge is not None:
        look |= {"show_edges": True, "edge_color": body.edge, "line_width": 1.0}
    return look


def panel_pixels(columns: int, height: float) -> tuple[int, int]:
    """Pixels (width, height) of one of `columns` panels, `height` in inches."""
    return round(WIDTH / columns * DOTS_PER_INCH), round(height * DOTS_PER_INCH)


def show(axes: Axes, scene: Scene) -> None:
    """Fill the axes with the scene, without frame and ticks; leave them empty without OpenGL."""
    if usable_window() is not None:
        axes.imshow(render(scene), interpolation="antialiased")
    axes.set_axis_off()


def staged(
    axes: Axes,
    bodies: Sequence[Body],
    wires: Sequence[Wire],
    limits: tuple[float, float],
    camera: tuple[Array, Array],
    room: tuple[int, float],
    kept: Sequence[Array] = (),
) -> Scene:
    """A scene that fills its panel, drawn on axes with a triad in a corner that is clear.

    `camera`: the direction it is seen from and the one that points upwards (3 each); `room`:
    columns of panels and their height (in); `kept` further points (n×3, m) are kept inside.
    """
    points = np.vstack([*(body.surface.points for body in bodies), *kept])
    scene = Scene(fitted_view(points, *camera, panel_pixels(*room), 0.07), bodies, limits, wires)
    show(axes, scene)
    triad(axes, scene.view, place=clear_corner(scene))
    return scene


def canvas(rows: int, columns: int, height: float) -> tuple[Canvas, list[Axes]]:
    """An empty picture as wide as the page and its axes, row by row; they make room for texts."""
    picture = Canvas(figsize=(WIDTH, height), layout="constrained")
    return picture, list(picture.subplots(rows, columns, squeeze=False).flat)


def squares(axes: Axes, view: View, points: Array, colour: str) -> None:
    """Small squares at points (n×3, m) of the scene, on top of everything."""
    axes.plot(
        *pixels(view, points).T,
        linestyle="",
        marker="s",
        markersize=3.4,
        markerfacecolor=colour,
        markeredgecolor="black",
        markeredgewidth=0.5,
    )


def write(axes: Axes, view: View, point: Array, text: str, away: tuple[float, float]) -> None:
    """Write at a point (3, m) of the scene, `away` (pt) from it, on a white ground."""
    axes.annotate(
        text,
        pixels(view, point[None])[0],
        xytext=away,
        textcoords="offset points",
        fontsize=9.0,
        ha="center",
        va="center",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
    )


def arrow(axes: Axes, view: View, tail: Array, head: Array, colour: str) -> None:
    """An arrow between two points (3, m) of the scene."""
    start, end = pixels(view, np.array([tail, head]))
    axes.annotate(
        "",
        end,
        xytext=start,
        arrowprops={"arrowstyle": "-|>,head_width=0.3,head_length=0.6", "color": colour, "lw": 2.2},
    )


def triad(
    axes: Axes, view: View, length: float = 24.0, place: tuple[float, float] = (0.47, 0.93)
) -> None:
    """The directions of x, y and z, `length` pt long, from `place` (shares of width and height).

    An axis that points nearly along the line of sight is left out.
    """
    per_point = DOTS_PER_INCH / 72.0
    origin = np.array(place) * view.size
    for name, direction in zip("xyz", np.eye(3), strict=True):
        seen = np.array([direction @ view.right, -(direction @ view.up)])
        size = float(np.linalg.norm(seen))
        if size < 0.4:
            continue
        axes.annotate(
            "",
            tuple(origin + per_point * length * seen),
            xytext=tuple(origin),
            arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.1, "shrinkA": 0},
        )
        tip = origin + per_point * (length + 8.0 / size) * seen
        axes.text(tip[0], tip[1], name, ha="center", va="center", fontsize=9.0)


# Where a triad may stand, in the order of preference (shares of width and height).
_CORNERS = ((0.08, 0.92), (0.78, 0.92), (0.08, 0.3), (0.78, 0.3))
_HALF_TRIAD, _CLEAR = 18.0, 26.0  # pt


def clear_corner(scene: Scene) -> tuple[float, float]:
    """The first place for a triad that no body covers, else the one farthest from all."""
    per_point = DOTS_PER_INCH / 72.0
    drawn = pixels(scene.view, np.vstack([body.surface.points for body in scene.bodies]))

    def away(place: tuple[float, float]) -> float:
        centre = np.array(place) * scene.view.size + per_point * _HALF_TRIAD * np.array([1.0, -1.0])
        return float(np.linalg.norm(drawn - centre, axis=1).min()) / per_point

    clear = [place for place in _CORNERS if away(place) > _CLEAR]
    return clear[0] if clear else max(_CORNERS, key=away)


def colour_bar(
    picture: Canvas,
    axes: Axes | list[Axes],
    limits: tuple[float, float],
    label: str,
) -> None:
    """A horizontal colour bar under the axes, unit in `label`."""
    mappable = mpl.cm.ScalarMappable(mpl.colors.Normalize(*limits), COLOUR_MAP)
    bar = picture.colorbar(
        mappable,
        ax=axes,
        orientation="horizontal",
        fraction=0.05,
        pad=0.02,
        aspect=28.0,
        shrink=0.8,
    )
    bar.set_label(label)
    bar.outline.set_visible(False)


@dataclass(frozen=True)
class Picture:
    """A picture as PNG, or why there is none."""

    png: bytes = b""
    left_out: str = ""


def picture_of(picture: Canvas) -> Picture:
    """The picture, where this machine can draw what it shows."""
    return Picture(left_out=MESSAGE) if usable_window() is None else Picture(png_of(picture))


def png_of(picture: Canvas) -> bytes:
    """The picture as PNG in 256 dithered colours, half the size of full colour; no date in it."""
    from PIL import Image  # noqa: PLC0415  comes with matplotlib, needed for pictures alone

    picture.set_dpi(DOTS_PER_INCH)
    drawn: Any = FigureCanvasAgg(picture)  # untyped in matplotlib
    drawn.draw()
    colours = Image.fromarray(np.asarray(drawn.buffer_rgba())).convert("RGB")
    # A sixteenth of the pixels has the same colours: choosing 256 of them is the slow part.
    reduced = colours.resize((colours.width // 4, colours.height // 4)).quantize(256)
    reduced = colours.quantize(palette=reduced, dither=Image.Dither.FLOYDSTEINBERG)
    reduced.putpalette(_with_pure_white(reduced.getpalette() or []))
    small = io.BytesIO()
    reduced.save(small, format="png", optimize=True)
    return small.getvalue()


def _with_pure_white(palette: list[int]) -> list[int]:
    """The palette (r, g, b, …) without tints of white: a palette of means shades the background."""
    colours = np.array(palette).reshape(-1, 3)
    colours[colours.min(axis=1) >= _NEARLY_WHITE] = 255
    return [int(value) for value in colours.ravel()]


_NEARLY_WHITE = 246
