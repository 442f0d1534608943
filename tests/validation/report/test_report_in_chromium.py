"""The report as a reader opens it: from a file, without a network, in a real browser."""

import numpy as np
import pytest
from chromium import EXECUTABLE, browser
from made_box import box
from report_sample import FIG_5, PIXEL, sample_report

from validation.drawing.scene import Body, Scene, Wire
from validation.drawing.turnable import turnable
from validation.exhibits import Figure
from validation.report.page import render

pytestmark = pytest.mark.skipif(EXECUTABLE is None, reason="no Chromium (Debian: chromium)")

BUTTON, FRAME, VEIL = "button[data-scene]", ".scene canvas", ".scene .veil"
PAUSE = ".scene .pause"
DRAWN = f"document.querySelector('{FRAME}') !== null"


def scene(title, away=None):
    """A red box, three times as long as high, drawn `away` (m) along z from its place at rest."""
    shape = box(np.array([-1.5, -0.5, -0.5]), np.array([1.5, 0.5, 0.5]))
    motion = None if away is None else np.tile([0.0, 0.0, away], (len(shape.points), 1))
    camera = np.array([0.3, -1.0, 0.4]), np.array([0.0, 0.0, 1.0])
    edges = Wire(shape.points, shape.edges, "#0000cc", 4.0, motion)
    return turnable(
        Scene([Body(shape, "#cc2200", motion=motion)], camera, title=title, turned=[edges])
    )


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    turnable = Figure(
        "turnable",
        "A box",
        "Made up.",
        "Leg 1",
        png=PIXEL,
        scenes=(scene("(a) a box"), scene("(b) the same box"), scene("(c) it swings", 0.4)),
    )
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(render(sample_report(figures=(FIG_5, turnable))), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def page(report, tmp_path_factory):
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        opened.open(report)
        yield opened


def red(pixels):
    """Where the box is drawn: its red is far above the other colours, whatever the light."""
    return pixels[..., 0] > pixels[..., 1:].max(axis=2) + 60


def test_every_image_is_loaded(page):
    assert page.value("document.images.length") > 0
    assert page.value("[...document.images].every(i => i.complete && i.naturalWidth > 0)")


def test_nothing_overflows_a_desktop_and_a_phone(page, report):
    for width in (1280, 390):
        page.open(report, width)
        assert page.value("document.documentElement.scrollWidth") <= width
    page.open(report)


def test_a_link_to_a_comparison_opens_its_sheet(page):
    page.value("document.querySelector('main table a[href^=\"#legs\"]').click()")
    page.until("document.querySelector(location.hash.replaceAll('.', '\\\\.')).checkVisibility()")


def test_a_scene_is_drawn_and_turned_by_the_mouse(page):
    assert page.value(f"document.querySelector('{FRAME}')") is None
    page.value(f"document.querySelector('{BUTTON}').click()")
    page.until(DRAWN)
    page.until(f"document.querySelector('{BUTTON}').ariaPressed === 'true'")
    before = settled(page)
    # Three times as long as high, the box covers at least a twentieth of the picture.
    assert red(before).mean() > 0.05
    page.click(VEIL)
    page.drag(FRAME, 120, 60)
    after = settled(page)
    assert red(after).mean() > 0.02
    assert (red(before) != red(after)).mean() > 0.02


def test_the_wheel_scrolls_the_page_until_the_scene_is_clicked(page):
    page.value(f"document.querySelector('{VEIL}').hidden = false")
    page.wheel(FRAME, 200)
    page.until("scrollY !== self.former")
    page.click(VEIL)
    assert page.value(f"document.querySelector('{VEIL}').hidden")
    before = settled(page)
    page.wheel(FRAME, 200)
    page.value("new Promise(done => setTimeout(done, 300))")
    assert page.value("scrollY === self.former")
    # Zoomed: the box covers another part of the picture.
    assert (red(before) != red(settled(page))).mean() > 0.02


def test_what_is_displaced_moves_until_it_is_stopped(page):
    page.value(f"[...document.querySelectorAll('{BUTTON}')].at(-1).click()")
    page.until(f"document.querySelector('{PAUSE}') !== null")
    pictures = [page.shot(FRAME) for _ in range(12)]
    changed = [(red(one) != red(pictures[0])).mean() for one in pictures]
    assert max(changed) > 0.02
    page.click(PAUSE)
    still = settled(page)
    page.value("new Promise(done => setTimeout(done, 300))")
    assert np.array_equal(still, page.shot(FRAME))
    page.value(f"[...document.querySelectorAll('{BUTTON}')].at(-1).click()")


def test_one_scene_gives_way_to_the_next_and_is_put_away(page):
    second = f"document.querySelectorAll('{BUTTON}')[1]"
    page.value(f"{second}.click()")
    page.until(f"{DRAWN} && document.querySelector('{FRAME}').title.startsWith('(b)')")
    page.value(f"{second}.click()")
    page.until(f"document.querySelector('{FRAME}') === null")


def test_the_console_is_silent_and_nothing_is_asked_of_the_network(page):
    assert page.complaints() == []


def settled(page):
    """The scene once two pictures of it in a row are the same, and not blank."""
    former = page.shot(FRAME)
    for _ in range(100):
        page.value("new Promise(done => setTimeout(done, 100))")
        latest = page.shot(FRAME)
        if np.array_equal(former, latest) and red(latest).any():
            break
        former = latest
    return latest
