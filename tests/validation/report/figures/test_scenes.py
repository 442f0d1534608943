"""Scenes: closed surfaces, positions, drawn objects, and their data for the browser."""

import gzip
import io
import json

import numpy as np
import pytest
from PIL import Image

from lumped.mechanism.free_twists import interface_position
from lumped.robot_file import load_robot
from lumped.sections import (
    Angle,
    Channel,
    Circle,
    HollowRectangle,
    ISection,
    Polygon,
    Rectangle,
    Tee,
    Tube,
)
from validation.drawing import opengl
from validation.drawing.rendering import pictured, render
from validation.drawing.scene import (
    ABOVE,
    DrawnBody,
    Label,
    Scene,
    Wire,
    fitted_view,
    readable_factor,
)
from validation.drawing.surfaces import end_triangles, faceted, joined, prism, rectangle, walled
from validation.drawing.turnable import turnable
from validation.kinematics.poses import postures_of
from validation.kinematics.solids import outlines, solids

ROUNDING = 1e-12  # lengths of about 1 m, a few operations each


@pytest.fixture
def needs_opengl():
    if not opengl.can_draw():
        pytest.skip(opengl.MESSAGE)


def volume(surface):
    """Volume in a closed surface of quadrangles with outward normals, by the divergence theorem."""
    a, b, c, d = (surface.points[surface.faces[:, k]] for k in range(4))
    return np.sum(a * (np.cross(b, c) + np.cross(c, d))) / 6.0


@pytest.mark.parametrize(
    ("section", "area"),
    [
        (Rectangle(width=0.1, height=0.3), 0.03),
        (ISection(width=0.1, height=0.3, flange=0.02, web=0.01), 2.0 * 0.002 + 0.0026),
        # A polygon of 20 sides: (20/2) r² sin(2π/20).
        (Circle(diameter=0.2), 10.0 * 0.01 * np.sin(np.pi / 10.0)),
        # Of hollow ones the ends are rings, and no wall is drawn within: 2/3 outline, 1/3 ring.
        (HollowRectangle(0.1, 0.2, 0.01), (2.0 * 0.02 + 0.0056) / 3.0),
        (Tube(diameter=0.2, thickness=0.02), (0.1 - 0.064 / 3.0) * np.sin(np.pi / 10.0)),
    ],
)
def test_prism_is_closed_and_faces_outwards(section, area):
    """Volume by Gauss's theorem, also of a moved prism and of two prisms."""
    corners, bore = outlines(section)
    hollow_prism = prism(corners, np.array([0.0, 0.4, 2.0]), bore)
    turned = hollow_prism.placed(
        np.array([1.0, 2.0, 3.0]), np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    )
    for surface, times in (
        (hollow_prism, 2.0),
        (turned, 2.0),
        (joined([hollow_prism, turned]), 4.0),
    ):
        assert volume(surface) == pytest.approx(times * area, rel=1e-11)


def test_rectangular_prism_has_twelve_edges():
    """Diagonals of triangles are no edges."""
    solid_prism = prism(outlines(Rectangle(width=0.2, height=0.4))[0], np.array([0.0, 1.0]))
    # So are those of a box whose faces are given.
    for surface in (solid_prism, faceted(solid_prism.points, solid_prism.faces[:, None])):
        edges = np.unique(np.sort(surface.edges, axis=1), axis=0)
        lengths = np.linalg.norm(np.diff(surface.points[edges], axis=1)[:, 0], axis=1)
        twelve = [0.2] * 4 + [0.4] * 4 + [1.0] * 4
        assert sorted(lengths) == pytest.approx(twelve, rel=ROUNDING)


@pytest.mark.parametrize("robot", ["delta", "ifw"])
def test_bodies_and_joints_are_drawn_in_place(robot):
    """Legs reach from interface to interface. Slides are at their positions in the pose."""
    mechanism = load_robot(robot).mechanism
    (second_posture,) = postures_of(mechanism, mechanism.poses[1:2])
    points_by_body = {solid.name: solid.surface.points for solid in solids(second_posture)}
    assert len(solids(second_posture)) == len(points_by_body)
    for name, body in mechanism.bodies.items():
        places = np.array(
            [
                (second_posture.frames[name] @ interface).position
                for interface in body.interfaces.values()
            ]
        )
        if name != "ground" and np.ptp(places, axis=0).any():
            assert (places >= points_by_body[name].min(axis=0) - 1e-9).all(), name
            assert (places <= points_by_body[name].max(axis=0) + 1e-9).all(), name
    assert {joint.name for joint in mechanism.joints if joint.kind != "fixed"} <= set(
        points_by_body
    )
    slid = [joint for joint in mechanism.joints if joint.kind == "prismatic"]
    assert len(slid) == {"delta": 0, "ifw": 2}[robot]
    for joint in slid:
        ends = [interface_position(second_posture, side) for side in (joint.first, joint.second)]
        assert np.linalg.norm(ends[1] - ends[0]) > 0.01
        np.testing.assert_allclose(points_by_body[joint.name].mean(axis=0), ends[1], atol=ROUNDING)


def test_magnification_is_round_and_bounded():
    """Displacements of 10 µm are drawn 10 000 times as large, to 0.1 m at most."""
    factors = {1e-5: 1e4, 1.9e-5: 5e3, 2e-5: 5e3, 0.3: 0.2, 0.0: 1.0}
    assert {size: readable_factor(size, target=0.1) for size in factors} == pytest.approx(factors)


def test_fitted_view_shows_all_points():
    """A box fills 86 % of the picture in one direction."""
    points = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 1.0) for z in (-0.2, 0.2)])
    view = fitted_view(points, np.array([1.0, -2.0, 0.7]), np.array([0, 0, 1.0]), (800, 600))
    pixels = view.pixels(points)
    assert (pixels.min(axis=0) >= -1e-6).all()
    assert (pixels.max(axis=0) <= [800.0, 600.0]).all()
    used = np.ptp(pixels, axis=0) / [800.0, 600.0]
    # 7 % are left free on both sides of the tighter direction.
    assert used.max() == pytest.approx(0.86, rel=1e-9)


def test_browser_scene_equals_drawn_scene():
    """The scene for the browser has the same points, colours, motions and view as the picture."""
    cuboid = prism(rectangle(1.0, 1.0), np.array([-1.5, 1.5]))
    motion = np.tile([0.0, 0.0, 0.4], (8, 1))
    body = DrawnBody(cuboid, values=np.linspace(2.0, 4.0, 8), motion=motion)
    wire = Wire(cuboid.points, cuboid.edges, "#ff8000", 2.5)
    scene = Scene([body], ABOVE, title="(a) a box", limits=(2.0, 4.0), turned=[wire], motion="push")
    interactive = turnable(scene)
    assert interactive.state == turnable(scene).state
    content = gzip.decompress(interactive.state)
    start = 4 + int.from_bytes(content[:4], "little")
    header = json.loads(content[4:start])

    def numbers(kind, entry):
        return np.frombuffer(content, kind, entry[1], start + entry[0])

    def lengths(entry):
        return (entry["step"] * numbers("<i2", entry["values"])).reshape(-1, 3)

    assert (header["title"], header["motion"]) == ("(a) a box", "push")
    np.testing.assert_allclose(header["camera"]["axes"], np.eye(3), atol=ROUNDING)
    first, second = header["parts"]
    for part in (first, second):
        np.testing.assert_allclose(lengths(part["points"]), cuboid.points, atol=1e-4)
    np.testing.assert_allclose(lengths(first["motion"]), motion, atol=1e-4)
    assert "motion" not in second
    assert numbers("<u4", first["faces"]).reshape(-1, 4).tolist() == cuboid.faces.tolist()
    assert numbers("<u4", second["pairs"]).reshape(-1, 2).tolist() == cuboid.edges.tolist()
    colours = numbers("u1", first["colours"]).reshape(-1, 3)
    # Both ends of viridis.
    assert colours[[0, -1]].tolist() == [[68, 1, 84], [253, 231, 36]]
    assert (second["colour"], second["width"]) == ([255, 128, 0], 2.5)


@pytest.mark.usefixtures("needs_opengl")
def test_box_is_drawn_at_its_projection():
    """The centre of the pixels that VTK colours is where `pixels` projects the box's centre."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    view = fitted_view(corners, np.array([0.5, -1.0, 0.4]), np.array([0, 0, 1.0]), (200, 160))
    middle = np.array([0.7, 0.4, 0.8])
    small = prism(rectangle(0.06, 0.06), np.array([-0.03, 0.03])).placed(middle, np.eye(3))
    image = render(Scene([DrawnBody(small, "#800000")], ABOVE), view)
    assert image.shape == (160, 200, 3)
    # Pixels are counted from their corner, half a pixel before their middle.
    down, right = (np.mean(indices) + 0.5 for indices in np.nonzero(image[:, :, 1] < 128))
    assert (right, down) == pytest.approx(view.pixels(middle[None])[0], abs=1.0)


@pytest.mark.usefixtures("needs_opengl")
def test_point_names_are_beside_points():
    """Names of two points at one place are drawn side by side."""
    cuboid = prism(rectangle(1.0, 0.1), np.array([-1.0, 1.0]))
    wire = Wire(np.array([[-1.0, 0.0, 0.2], [1.0, 0.0, 0.2]]), np.array([[0, 1]]), "#D55E00", 2.5)
    names = [Label(name, np.zeros(3), "#0000ff") for name in ("one", "two")]
    with_names, without = (
        np.asarray(Image.open(io.BytesIO(pictured([labelled]).png)).convert("RGB"), dtype=int)
        for labels in (names, ())
        for labelled in [Scene([DrawnBody(cuboid)], ABOVE, [wire], labels=labels)]
    )
    assert (np.abs(without - [213, 94, 0]).max(axis=2) <= 2).any()
    blue, none = (image[..., 2] > image[..., 0] + 100 for image in (with_names, without))
    assert not none.any()
    # Both are read, each on a side of the point of its own.
    assert max(map(np.ptp, np.nonzero(blue))) > 60


SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
HOLES = (
    ((0.1, 0.1), (0.4, 0.1), (0.4, 0.9), (0.1, 0.9)),
    ((0.6, 0.2), (0.9, 0.3), (0.7, 0.8)),
)
SECTIONS = [
    Channel(0.05, 0.1, 0.006, 0.005),
    Angle(0.06, 0.1, 0.006, 0.005),
    Tee(0.06, 0.1, 0.006, 0.005),
    Polygon(SQUARE, HOLES),
]


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_end_triangles_fill_section(section):
    """Their areas are positive, and sum to that of the section."""
    loops = section.centred_loops
    a, b, c = (np.vstack(loops)[end_triangles(loops)[:, k]] for k in range(3))
    (uy, uz), (vy, vz) = (b - a).T, (c - a).T
    areas = 0.5 * (uy * vz - uz * vy)
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(section.area, rel=1e-12)


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_hollow_prism_surface_is_closed(section):
    """Volume by Gauss's theorem: a third of the sum of x·n dA with outward normals."""
    surface = walled(section.centred_loops, np.array([0.0, 0.3, 2.0]))
    assert volume(surface) == pytest.approx(2.0 * section.area, rel=1e-12)
