"""Scenes: closed surfaces, where points come to lie, what is drawn, and what a browser is told."""

import gzip
import io
import json

import numpy as np
import pytest
from made_box import box
from PIL import Image

from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
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
from validation.drawing.surfaces import Surface, joined, prism
from validation.drawing.turnable import turnable
from validation.kinematics.poses import postures_of
from validation.kinematics.solids import outlines, solids

needs_opengl = pytest.mark.skipif(opengl.usable_window() is None, reason=opengl.MESSAGE)
ROUNDING = 1e-12  # lengths of about 1 m, a few operations each


def volume(surface: Surface) -> float:
    """Volume inside closed quadrangles with normals outwards, by the divergence theorem."""
    p = surface.points[surface.faces]
    return sum(
        float(np.einsum("qi,qi->q", a, np.cross(b, c)).sum()) / 6.0
        for a, b, c in ((p[:, 0], p[:, 1], p[:, 2]), (p[:, 0], p[:, 2], p[:, 3]))
    )


@pytest.mark.parametrize(
    ("section", "area"),
    [
        (Rectangle(width=0.1, height=0.3), 0.03),
        (ISection(width=0.1, height=0.3, flange=0.02, web=0.01), 2.0 * 0.002 + 0.0026),
        # A polygon of 20 sides: (20/2) r² sin(2π/20).
        (Circle(diameter=0.2), 10.0 * 0.01 * np.sin(np.pi / 10.0)),
    ],
)
def test_a_prism_is_closed_and_faces_outwards(section, area):
    whole = prism(outlines(section)[0], np.array([0.0, 0.4, 2.0]))
    assert volume(whole) == pytest.approx(2.0 * area, rel=1e-11)
    turned = whole.placed(np.array([1.0, 2.0, 3.0]), np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]))
    assert volume(turned) == pytest.approx(2.0 * area, rel=1e-11)
    assert volume(joined([whole, whole])) == pytest.approx(4.0 * area, rel=1e-11)


@pytest.mark.parametrize(
    "section", [HollowRectangle(0.1, 0.2, 0.01), Tube(diameter=0.2, thickness=0.02)]
)
def test_both_ends_of_a_hollow_prism_are_rings(section):
    """Seen along its axis each end covers the outline but for the bore."""
    corners, bore = outlines(section)
    whole = prism(corners, np.array([0.0, 0.5, 1.0]), bore)
    faces = whole.points[whole.faces]
    areas = np.array([0.5 * np.cross(quad[2] - quad[0], quad[3] - quad[1]) for quad in faces])
    expected = sum(
        sign * 0.5 * abs(np.sum(o[:, 0] * np.roll(o[:, 1], -1) - np.roll(o[:, 0], -1) * o[:, 1]))
        for sign, o in ((1.0, corners), (-1.0, bore))
    )
    for x, normal in ((0.0, -1.0), (1.0, 1.0)):
        at_end = np.all(faces[:, :, 0] == x, axis=1)
        assert areas[at_end].sum(axis=0) == pytest.approx([normal * expected, 0, 0], abs=ROUNDING)


def test_the_edges_of_a_rectangular_prism_are_its_twelve():
    whole = prism(outlines(Rectangle(width=0.2, height=0.4))[0], np.array([0.0, 1.0]))
    lengths = np.linalg.norm(np.diff(whole.points[whole.edges], axis=1)[:, 0], axis=1)
    twelve = [0.2] * 4 + [0.4] * 4 + [1.0] * 4
    assert sorted(lengths) == pytest.approx(twelve, rel=ROUNDING)
    # So are those of a box whose faces are given.
    cuboid = box(np.zeros(3), np.array([1.0, 0.2, 0.4]))
    pairs = {frozenset(pair) for pair in cuboid.edges.tolist()}
    lengths = [np.linalg.norm(np.diff(cuboid.points[list(pair)], axis=0)) for pair in pairs]
    assert sorted(lengths) == pytest.approx(twelve, rel=ROUNDING)


@pytest.mark.parametrize("robot", ["delta", "ifw"])
def test_every_body_and_joint_is_drawn_where_it_is(robot):
    """Legs reach from interface to interface, symbols lie about their joints."""
    posture = reference_posture(load_robot(robot).mechanism)
    mechanism = posture.mechanism
    drawn = {one.name: one.surface.points for one in solids(posture)}
    for name, body in mechanism.bodies.items():
        frame = posture.frames[name]
        places = np.array([(frame @ one).position for one in body.interfaces.values()])
        if name == "ground" or not np.ptp(places, axis=0).any():
            continue
        low, high = drawn[name].min(axis=0), drawn[name].max(axis=0)
        slack = 1e-9 * mechanism.size
        assert (places >= low - slack).all(), name
        assert (places <= high + slack).all(), name
    joints = [joint.name for joint in mechanism.joints if joint.kind != "fixed"]
    assert set(joints) <= set(drawn)
    assert len(solids(posture)) == len(drawn)


def test_what_slides_on_ground_is_drawn_where_it_has_slid_to():
    mechanism = load_robot("ifw").mechanism
    (at,) = postures_of(mechanism, mechanism.poses[1:2])
    drawn = {one.name: one.surface.points.mean(axis=0) for one in solids(at)}
    slid = [joint for joint in mechanism.joints if joint.kind == "prismatic"]
    for joint in slid:
        ends = [interface_position(at, side) for side in (joint.first, joint.second)]
        assert np.linalg.norm(ends[1] - ends[0]) > 0.01
        np.testing.assert_allclose(drawn[joint.name], ends[1], atol=ROUNDING)
    assert len(slid) == 2


@pytest.mark.parametrize(
    ("largest", "factor"), [(1e-5, 1e4), (1.9e-5, 5e3), (2e-5, 5e3), (0.3, 0.2), (0.0, 1.0)]
)
def test_an_enlargement_is_a_round_number_and_not_too_large(largest, factor):
    assert readable_factor(largest, wanted=0.1) == pytest.approx(factor)


def test_a_fitted_view_shows_every_point_and_fills_the_picture():
    points = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 1.0) for z in (-0.2, 0.2)])
    view = fitted_view(points, np.array([1.0, -2.0, 0.7]), np.array([0, 0, 1.0]), (800, 600))
    seen = view.pixels(points)
    assert (seen.min(axis=0) >= -1e-6).all()
    assert (seen.max(axis=0) <= [800.0, 600.0]).all()
    used = np.ptp(seen, axis=0) / [800.0, 600.0]
    # 7 % are left free on both sides of the tighter direction.
    assert used.max() == pytest.approx(0.86, rel=1e-9)


def test_what_a_browser_is_told_of_a_scene_is_what_is_drawn():
    """Points to a pixel in ten thousand, colours of both limits, motions, and the view."""
    cuboid = box(np.array([-1.5, -0.5, -0.5]), np.array([1.5, 0.5, 0.5]))
    away = np.tile([0.0, 0.0, 0.4], (8, 1))
    body = DrawnBody(cuboid, values=np.linspace(2.0, 4.0, 8), motion=away)
    wire = Wire(cuboid.points, cuboid.edges, "#ff8000", 2.5)
    scene = Scene([body], ABOVE, title="(a) a box", limits=(2.0, 4.0), turned=[wire], motion="push")
    shown = turnable(scene)
    assert shown.state == turnable(scene).state
    content = gzip.decompress(shown.state)
    start = 4 + int.from_bytes(content[:4], "little")
    header = json.loads(content[4:start])

    def numbers(kind, at):
        return np.frombuffer(content, kind, at[1], start + at[0])

    def lengths(at):
        return (at["step"] * numbers("<i2", at["values"])).reshape(-1, 3)

    assert (header["title"], header["motion"]) == ("(a) a box", "push")
    np.testing.assert_allclose(header["camera"]["axes"], np.eye(3), atol=ROUNDING)
    first, second = header["parts"]
    for part in (first, second):
        np.testing.assert_allclose(lengths(part["points"]), cuboid.points, atol=1e-4)
    np.testing.assert_allclose(lengths(first["motion"]), away, atol=1e-4)
    assert "motion" not in second
    assert numbers("<u4", first["faces"]).reshape(-1, 4).tolist() == cuboid.faces.tolist()
    assert numbers("<u4", second["pairs"]).reshape(-1, 2).tolist() == cuboid.edges.tolist()
    colours = numbers("u1", first["colours"]).reshape(-1, 3)
    # Both ends of viridis.
    assert colours[[0, -1]].tolist() == [[68, 1, 84], [253, 231, 36]]
    assert (second["colour"], second["width"]) == ([255, 128, 0], 2.5)


@needs_opengl
def test_a_small_box_is_drawn_where_the_projection_says():
    """VTK's own camera against `pixels`: the centre of what is coloured."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    view = fitted_view(corners, np.array([0.5, -1.0, 0.4]), np.array([0, 0, 1.0]), (200, 160))
    middle = np.array([0.7, 0.4, 0.8])
    assert opengl.can_draw()
    image = render(Scene([DrawnBody(box(middle - 0.03, middle + 0.03), "#800000")], ABOVE), view)
    assert image.shape == (160, 200, 3)
    down, right = np.nonzero(image[:, :, 1] < 128)
    # Pixels are counted from their corner, half a pixel before their middle.
    found = (right.mean() + 0.5, down.mean() + 0.5)
    assert found == pytest.approx(view.pixels(middle[None])[0], abs=1.0)


@needs_opengl
def test_names_stand_beside_their_points_and_small_things_keep_their_colours():
    cuboid = box(np.array([-1.0, -0.5, 0.0]), np.array([1.0, 0.5, 0.1]))
    wire = Wire(np.array([[-1.0, 0.0, 0.2], [1.0, 0.0, 0.2]]), np.array([[0, 1]]), "#D55E00", 2.5)
    names = [Label("one", np.zeros(3), "#0000ff"), Label("two", np.zeros(3), "#0000ff")]
    shown = [Scene([DrawnBody(cuboid)], ABOVE, [wire], labels=labels) for labels in (names, ())]
    with_names, without = (
        np.asarray(Image.open(io.BytesIO(pictured([one]).png)).convert("RGB"), dtype=int)
        for one in shown
    )
    assert (np.abs(without - [213, 94, 0]).max(axis=2) <= 2).any()
    blue = with_names[..., 2] > with_names[..., 0] + 100
    assert blue.any()
    assert not (without[..., 2] > without[..., 0] + 100).any()
    # Both are read, each on a side of the point of its own.
    columns = np.flatnonzero(blue.any(axis=0))
    rows = np.flatnonzero(blue.any(axis=1))
    assert max(np.ptp(columns), np.ptp(rows)) > 60
