"""The report in a browser, opened from a file without a network."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from support.pages.report_sample import FIG_5, PIXEL, sample_report

from validation.drawing.scene import DrawnBody, Scene, Wire
from validation.drawing.surfaces import prism, rectangle
from validation.drawing.turnable import turnable
from validation.report.page import render
from validation.studies_and_figures import Figure

NAMES = ("chromium", "chromium-browser", "google-chrome")
EXECUTABLE = next(filter(None, map(shutil.which, NAMES)), None)
FLAGS = (
    *("--headless=new", "--no-sandbox", "--no-first-run", "--disable-extensions"),
    *("--disable-component-update", "--disable-background-networking", "--disable-dev-shm-usage"),
    # WebGL without a graphics card.
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    # The network is off: no name is ever resolved.
    *("--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9"),
    *("--window-size=1280,900", "--hide-scrollbars", "--enable-logging=stderr"),
    # The page is printed once so much of its own time (ms) has passed.
    *("--virtual-time-budget=60000", "--dump-dom"),
)
ADDED = """<script type="module" id="looking">
document.getElementById("looking").remove();
const look = async () => { %s };
const found = await look().catch(error => ({ error: error.stack }));
document.body.textContent = `found ${encodeURIComponent(JSON.stringify(found))} found`;
</script></body>"""
LOOK = Path(__file__).with_name("looking.js").read_text("utf-8")


def scene(title, height=None):
    """A red box, three times as long as high, drawn `height` (m) along z from its place at rest."""
    shape = prism(rectangle(1.0, 1.0), np.array([-1.5, 1.5]))
    motion = None if height is None else np.tile([0.0, 0.0, height], (len(shape.points), 1))
    camera = np.array([0.3, -1.0, 0.4]), np.array([0.0, 0.0, 1.0])
    edges = Wire(shape.points, shape.edges, "#0000cc", 4.0, motion)
    body = DrawnBody(shape, "#cc2200", motion=motion)
    return turnable(Scene([body], camera, title=title, turned=[edges]))


@pytest.mark.skipif(EXECUTABLE is None, reason="no Chromium (Debian: chromium)")
def test_browser_shows_report_and_scenes(tmp_path):
    """No error on the console, no request, all pictures loaded, nothing wider than the window."""
    scenes = (scene("(a) a box"), scene("(b) the same box"), scene("(c) it swings", 0.4))
    turned = Figure("turnable", "A box", "Made up.", "Leg 1", png=PIXEL, scenes=scenes)
    report = sample_report(figures=(FIG_5, turned))
    page = tmp_path / "page.html"
    page.write_text(render(report).replace("</body>", ADDED % LOOK), encoding="utf-8")
    line = [EXECUTABLE, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()]
    completed = subprocess.run(line, capture_output=True, text=True, check=True, timeout=120.0)
    assert "CONSOLE" not in completed.stderr
    (encoded,) = re.findall("found (.*) found", completed.stdout)
    results = json.loads(unquote(encoded))
    assert "error" not in results, results
    assert all(address.startswith(("file:", "data:")) for address in results["asked"])
    assert set(results["images"]) == {True}
    # Neither a phone nor a desktop shows anything beyond its edge.
    assert all(
        width_of_content <= int(width) for width, width_of_content in results["widths"].items()
    )
    # A phone shows the answer and all of the matrix at once, a desktop all of one of many columns.
    assert np.less_equal(results["corners"]["390"], [390.0, 844.0]).all()
    assert results["corners"]["1280"][0] <= 1280.0
    # Three times as long as high, the box covers at least a twentieth of its picture.
    assert (results["before"], results["pressed"]) == (True, "true")
    assert results["drawn"] > 0.05
    # Until the scene is clicked the wheel scrolls the page, and dragging turns nothing.
    assert (results["scrolls"], results["veiled"], results["scrollsBehind"]) == (True, 0.0, False)
    assert min(results["turned"], results["zoomed"]) > 0.02
    # One scene gives way to the next and is put away; what is displaced moves until it is stopped.
    assert results["away"]
    assert results["still"] == 0.0
