"""The report as a reader opens it: from a file, without a network, in a real browser."""

import json
import re
import shutil
import subprocess
from urllib.parse import unquote

import numpy as np
import pytest
from report_sample import FIG_5, PIXEL, sample_report

from validation.drawing.scene import DrawnBody, Scene, Wire
from validation.drawing.surfaces import prism, rectangle
from validation.drawing.turnable import turnable
from validation.exhibits import Figure
from validation.report.page import render

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
# Events go to whatever lies uppermost at the middle of the scene, as those of a mouse do.
LOOK = """
const find = selector => document.querySelector(selector);
const scenes = document.querySelectorAll("button[data-scene]");
const wait = time => new Promise(done => setTimeout(done, time));
const until = async (condition) => {
  for (let k = 0; k < 200 && !condition(); k++) await wait(50);
  if (!condition()) throw Error(`never: ${condition}`);
};
// Browsers capture pointers of real mice alone.
HTMLElement.prototype.setPointerCapture = () => {};
const middle = () => {
  const canvas = find(".scene canvas");
  canvas.scrollIntoView({ block: "center", behavior: "instant" });
  const { x, y, width, height } = canvas.getBoundingClientRect();
  return { clientX: x + width / 2, clientY: y + height / 2 };
};
const send = (kind, name, right = 0, deltaY = 0) => {
  const at = middle(), top = document.elementFromPoint(at.clientX, at.clientY);
  return top.dispatchEvent(new kind(name, {
    ...at, deltaY, clientX: at.clientX + right, bubbles: true, cancelable: true, pointerId: 1 }));
};
const drag = (right) => {
  send(PointerEvent, "pointerdown");
  for (const share of [0.25, 0.5, 0.75, 1]) send(PointerEvent, "pointermove", share * right);
  send(PointerEvent, "pointerup", right);
};
// Where the box is drawn: its red is far above the other colours, whatever the light.
const red = () => {
  const canvas = find(".scene canvas"), width = 200, height = 150;
  const copy = Object.assign(document.createElement("canvas"), { width, height });
  const plane = copy.getContext("2d");
  plane.drawImage(canvas, 0, 0, width, height);
  const { data } = plane.getImageData(0, 0, width, height);
  return Array.from({ length: width * height }, (_, k) =>
    data[4 * k] > Math.max(data[4 * k + 1], data[4 * k + 2]) + 60);
};
const share = pixels => pixels.filter(Boolean).length / pixels.length;
const changed = (one, other) => share(one.map((pixel, k) => pixel !== other[k]));
const told = { widths: {} };

await until(() => document.readyState === "complete");
told.images = [...document.images].map(image => image.complete && image.naturalWidth > 0);
const html = document.documentElement.outerHTML;
for (const width of [1280, 390]) {
  const frame = Object.assign(document.createElement("iframe"), { width, srcdoc: html });
  const loaded = new Promise(done => { frame.onload = done; });
  document.body.append(frame);
  await loaded;
  const page = frame.contentDocument, matrix = page.querySelector("table.adequacy");
  // More quantities than a page is wide: loads, responses, ten frequencies.
  const rows = width === 390 ? [] : [...matrix.rows];
  for (const row of rows)
    while (row.cells.length < 24) row.append(row.cells[row.cells.length - 1].cloneNode(true));
  if (rows.length) matrix.style.setProperty("--rows", 24);
  told.widths[width] = page.documentElement.scrollWidth;
  const boxes = [...matrix.querySelectorAll("th, td")].map(cell => cell.getBoundingClientRect());
  told.corners ??= {};
  told.corners[width] = ["right", "bottom"].map(side => Math.max(...boxes.map(box => box[side])));
  frame.remove();
}
find('main table a[href^="#legs"]').click();
await until(() => document.getElementById(location.hash.slice(1)).checkVisibility());

told.before = find(".scene canvas") === null;
scenes[0].click();
await until(() => find(".scene canvas") && share(red()) > 0);
told.pressed = scenes[0].ariaPressed;
let former = red();
told.drawn = share(former);
told.scrolls = send(WheelEvent, "wheel", 0, 200);
drag(120);
told.veiled = changed(former, red());
send(MouseEvent, "click");
drag(120);
told.turned = changed(former, red());
former = red();
told.scrollsBehind = send(WheelEvent, "wheel", 0, 200);
told.zoomed = changed(former, red());

scenes[1].click();
await until(() => find(".scene canvas")?.title.startsWith("(b)"));
scenes[1].click();
told.away = find(".scene canvas") === null;

scenes[2].click();
await until(() => find(".scene .pause") && share(red()) > 0);
middle();
former = red();
await until(() => changed(former, red()) > 0.02);
find(".scene .pause").click();
await wait(100);
former = red();
await wait(300);
told.still = changed(former, red());
told.asked = performance.getEntriesByType("resource").map(one => one.name);
return told;
"""


def scene(title, away=None):
    """A red box, three times as long as high, drawn `away` (m) along z from its place at rest."""
    shape = prism(rectangle(1.0, 1.0), np.array([-1.5, 1.5]))
    motion = None if away is None else np.tile([0.0, 0.0, away], (len(shape.points), 1))
    camera = np.array([0.3, -1.0, 0.4]), np.array([0.0, 0.0, 1.0])
    edges = Wire(shape.points, shape.edges, "#0000cc", 4.0, motion)
    body = DrawnBody(shape, "#cc2200", motion=motion)
    return turnable(Scene([body], camera, title=title, turned=[edges]))


@pytest.mark.skipif(EXECUTABLE is None, reason="no Chromium (Debian: chromium)")
def test_a_reader_sees_all_of_the_report_and_turns_its_scenes(tmp_path):
    scenes = (scene("(a) a box"), scene("(b) the same box"), scene("(c) it swings", 0.4))
    turned = Figure("turnable", "A box", "Made up.", "Leg 1", png=PIXEL, scenes=scenes)
    report = sample_report(figures=(FIG_5, turned))
    page = tmp_path / "page.html"
    page.write_text(render(report).replace("</body>", ADDED % LOOK), encoding="utf-8")
    line = [EXECUTABLE, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()]
    done = subprocess.run(line, capture_output=True, text=True, check=True, timeout=120.0)
    assert "CONSOLE" not in done.stderr
    (found,) = re.findall("found (.*) found", done.stdout)
    told = json.loads(unquote(found))
    assert "error" not in told, told
    assert all(one.startswith(("file:", "data:")) for one in told["asked"])
    assert set(told["images"]) == {True}
    # Neither a phone nor a desktop shows anything beyond its edge.
    assert all(found <= int(width) for width, found in told["widths"].items())
    # A phone shows the answer and all of the matrix at once, a desktop all of one of many columns.
    assert np.less_equal(told["corners"]["390"], [390.0, 844.0]).all()
    assert told["corners"]["1280"][0] <= 1280.0
    # Three times as long as high, the box covers at least a twentieth of its picture.
    assert (told["before"], told["pressed"]) == (True, "true")
    assert told["drawn"] > 0.05
    # Until the scene is clicked the wheel scrolls the page, and dragging turns nothing.
    assert (told["scrolls"], told["veiled"], told["scrollsBehind"]) == (True, 0.0, False)
    assert min(told["turned"], told["zoomed"]) > 0.02
    # One scene gives way to the next and is put away; what is displaced moves until it is stopped.
    assert told["away"]
    assert told["still"] == 0.0
