"""A picture of a mechanism: one posture in full, the others as their lines, everything named.

Faces are drawn from the farthest to the nearest. A mechanism whose joints lie in one plane is
seen along its normal, any other from above and aside, both without perspective.
"""

from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from itertools import permutations
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure as Canvas
from matplotlib.patheffects import withStroke

from lumped.arrays import Array
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from validation.drawing.style import ORANGE, VERMILLION, plot_style
from validation.kinematics.solids import Face, Matter, body_faces, is_leg, joint_faces, on_ground

_COLOURS: dict[Matter, str] = {
    "leg": "#9db8cc",
    "other leg": "#b5cbb7",
    "rigid": "#d9c9a3",
    "hole": "#3f4d58",
    "joint": "#f4f4f4",
    "drive": ORANGE,
}
_LIGHT = np.array([-0.35, -0.45, 0.82])
_ASIDE = np.array([0.45, -0.80, 0.40])
_DOTS = 150  # per inch
_WIDTH = 9.0
# Radius of a joint's symbol, of the size of the mechanism.
_SYMBOL = 0.035
_TEXT = 7.0
# Letters of a title in an inch.
_LETTERS = 12.0


def png(mechanism: Mechanism, postures: Sequence[Posture]) -> bytes:
    """PNG of the mechanism: the middle one of the postures in full, the others as lines."""
    with plot_style():
        content = BytesIO()
        picture(mechanism, postures).savefig(content, dpi=_DOTS, format="png")
    return content.getvalue()


def picture(
    mechanism: Mechanism, postures: Sequence[Posture], width: float = _WIDTH, *, named: bool = True
) -> Canvas:
    """The picture, `width` inches wide, to be saved; a small one has no room for names and pose."""
    shown = postures[len(postures) // 2]
    view = _view(shown)
    tints = _tints(mechanism)
    faces = [
        replace(face, matter=tints[name]) if face.matter == "leg" else face
        for name in tints
        for face in body_faces(shown, name, mechanism.size)
    ]
    radius = _SYMBOL * mechanism.size
    faces += [face for joint in mechanism.joints for face in joint_faces(shown, joint, radius)]
    drawn = np.concatenate([face.corners for face in faces]) @ view[:, :2]
    height = width * float(np.clip(np.ptp(drawn[:, 1]) / np.ptp(drawn[:, 0]), 0.45, 1.2))
    canvas = Canvas(figsize=(width, height + 0.4), layout="constrained")
    FigureCanvasAgg(canvas)
    axes = canvas.add_subplot()
    axes.set_aspect("equal")
    axes.set_axis_off()
    # A small picture stands beside words that say which posture it is.
    place = shown_pose(mechanism, shown.pose) or "reference posture"
    title = f"{mechanism.name}, {place}" if named else mechanism.name
    axes.set_title(fill(title, round(_LETTERS * width)))
    _draw_lines(axes, postures, view)
    _draw_faces(axes, faces, view)
    _draw_ground(axes, shown, view, radius)
    _draw_rails(axes, postures, view)
    _draw_tool(axes, shown, view)
    axes.autoscale_view()
    axes.margins(0.06)
    if named:
        canvas.draw_without_rendering()
        _write_names(axes, shown, view)
    return canvas


def _view(posture: Posture) -> Array:
    """Orthonormal columns: to the right, upwards, towards the eye (base axes)."""
    places = [interface_position(posture, joint.first) for joint in posture.mechanism.joints]
    flat = bool(np.ptp(np.array(places)[:, 2]) < 1e-6 * posture.mechanism.size)
    if flat:
        return np.eye(3)
    eye = _ASIDE / np.linalg.norm(_ASIDE)
    right = np.cross([0.0, 0.0, 1.0], eye)
    right /= np.linalg.norm(right)
    return np.column_stack([right, np.cross(eye, right), eye])


def _tints(mechanism: Mechanism) -> dict[str, Matter]:
    """Two tints, so that legs that meet stand out from each other where two are enough."""
    tints: dict[str, Matter] = {}
    for name, body in mechanism.bodies.items():
        meeting = {
            tints.get(other)
            for joint in mechanism.joints
            for one, other in permutations((joint.first.body, joint.second.body))
            if one == name and is_leg(mechanism.bodies[other])
        }
        if name != GROUND:
            tints[name] = "other leg" if is_leg(body) and "leg" in meeting else "leg"
    return tints


def _draw_faces(axes: Axes, faces: Sequence[Face], view: Array) -> None:
    depths = [float((face.corners @ view[:, 2]).mean()) + face.nearer for face in faces]
    ordered = [faces[i] for i in np.argsort(depths, kind="stable")]
    colours = [_shaded(face, view) for face in ordered]
    polygons = [face.corners @ view[:, :2] for face in ordered]
    axes.add_collection(
        PolyCollection(polygons, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=2)
    )


def _shaded(face: Face, view: Array) -> tuple[float, float, float]:
    first, second = face.corners[1] - face.corners[0], face.corners[2] - face.corners[1]
    normal = np.cross(first, second)
    normal = normal / (np.linalg.norm(normal) or 1.0)
    if normal @ view[:, 2] < 0.0:
        normal = -normal
    bright = 0.62 + 0.38 * abs(float(normal @ _LIGHT)) / float(np.linalg.norm(_LIGHT))
    colour = _COLOURS[face.matter].removeprefix("#")
    red, green, blue = (bright * int(colour[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return red, green, blue


def _draw_lines(axes: Axes, postures: Sequence[Posture], view: Array) -> None:
    """Other postures: lines between the interfaces of their bodies, and the tool's way."""
    segments = []
    for posture in postures:
        for name, body in posture.mechanism.bodies.items():
            if name == GROUND:
                continue
            points = [(posture.frames[name] @ place).position for place in body.interfaces.values()]
            middle = np.mean(points, axis=0)
            ends = points if len(points) == 2 else [e for p in points for e in (middle, p)]
            segments += [
                np.array(ends[i : i + 2]) @ view[:, :2] for i in range(0, len(ends) - 1, 2)
            ]
    axes.add_collection(LineCollection(segments, colors="#c8d2da", linewidths=0.6, zorder=1))
    way = np.array([_tool(posture) for posture in postures]) @ view[:, :2]
    axes.plot(way[:, 0], way[:, 1], color=VERMILLION, lw=0.9, marker=".", ms=3, zorder=3)


def _draw_ground(axes: Axes, posture: Posture, view: Array, radius: float) -> None:
    """A hatched foot below every point of the base."""
    for name in posture.mechanism.bodies[GROUND].interfaces:
        x, y = interface_position(posture, Side(GROUND, name)) @ view[:, :2]
        low = y - 2.4 * radius
        foot = [(x, y), (x - 1.4 * radius, low), (x + 1.4 * radius, low)]
        axes.add_collection(
            PolyCollection([foot], facecolors="none", edgecolors="#555555", linewidths=0.8)
        )
        rim = np.linspace(x - 1.8 * radius, x + 1.8 * radius, 6)
        axes.plot(rim[[0, -1]], [low, low], color="#555555", lw=1.0, zorder=1)
        for edge in rim[1:]:
            axes.plot(
                [edge, edge - 0.7 * radius], [low, low - 0.7 * radius], color="#555555", lw=0.6
            )


def _draw_rails(axes: Axes, postures: Sequence[Posture], view: Array) -> None:
    """Along ground, as far as the joints on it slide in all postures."""
    for joint in postures[0].mechanism.joints:
        if on_ground(joint):
            slid = [interface_position(one, joint.second) @ view[:, :2] for one in postures]
            axes.plot(*np.array(slid).T, color="#555555", lw=1.4, zorder=1.5)


def _draw_tool(axes: Axes, posture: Posture, view: Array) -> None:
    x, y = _tool(posture) @ view[:, :2]
    axes.plot(x, y, marker="P", ms=8, mfc=VERMILLION, mec="white", zorder=6)


def _tool(posture: Posture) -> Array:
    tool = posture.mechanism.tool
    return interface_position(posture, Side(tool.body, tool.point))


def _write_names(axes: Axes, posture: Posture, view: Array) -> None:
    """Names of bodies (upright) and joints (slanted), each where it covers the fewest others."""
    corners = axes.transData.inverted().transform([(0.0, 0.0), (1.0, 1.0)])
    scale = float(corners[1, 0] - corners[0, 0]) * axes.figure.dpi / 72.0  # m a point of print
    taken: list[Array] = []
    names = [(name, place, "#1c3d5a", "normal") for name, place in _bodies(posture)]
    names += [
        (joint.name, interface_position(posture, _named_at(joint)), "#8a3b00", "italic")
        for joint in posture.mechanism.joints
        if joint.kind != "fixed"
    ]
    for name, place, colour, style in names:
        wide, high = 0.62 * _TEXT * len(name) * scale, 1.25 * _TEXT * scale
        half = np.array([0.5 * wide, 0.5 * high])
        spots = [
            place @ view[:, :2] + np.array(side) * (half + 7.0 * scale * away)
            for away in (1.0, 2.0, 3.5)
            for side in ((1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0))
        ]
        boxes = [np.concatenate([spot - half, spot + half]) for spot in spots]
        best = int(np.argmin([_covered(box, taken) + 1e-3 * i for i, box in enumerate(boxes)]))
        taken.append(boxes[best])
        axes.annotate(
            name,
            xy=tuple(place @ view[:, :2]),
            xytext=tuple(spots[best]),
            ha="center",
            va="center",
            fontsize=_TEXT,
            fontstyle=style,
            color=colour,
            zorder=7,
            path_effects=[withStroke(linewidth=1.8, foreground="white")],
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.4, "shrinkA": 0, "shrinkB": 1},
        )


def _named_at(joint: Joint) -> Side:
    return joint.second if on_ground(joint) else joint.first


def _bodies(posture: Posture) -> list[tuple[str, Array]]:
    found = []
    for name, body in posture.mechanism.bodies.items():
        if name != GROUND:
            places = [(posture.frames[name] @ one).position for one in body.interfaces.values()]
            found.append((name, np.mean(places, axis=0)))
    return found


def _covered(box: Array, taken: Sequence[Array]) -> float:
    """Share of the box that lies on other names."""
    area = 0.0
    for other in taken:
        sides = np.minimum(box[2:], other[2:]) - np.maximum(box[:2], other[:2])
        area += float(np.prod(np.maximum(sides, 0.0)))
    return area / float(np.prod(box[2:] - box[:2]))
