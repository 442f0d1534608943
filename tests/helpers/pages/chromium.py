"""A headless Chromium, driven through its DevTools protocol over a pipe; no further package."""

import base64
import io
import json
import os
import select
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager

import numpy as np
from PIL import Image

EXECUTABLE = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)
_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-extensions",
    "--disable-component-update",
    "--disable-background-networking",
    "--disable-dev-shm-usage",
    # WebGL without a graphics card.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # The network is off: no name is ever resolved.
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--proxy-server=127.0.0.1:9",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
)
# Chromium reads commands from descriptor 3 and answers on 4.
_LAUNCHER = """
import os, sys
os.dup2(int(sys.argv[1]), 3)
os.dup2(int(sys.argv[2]), 4)
os.execv(sys.argv[3], sys.argv[3:])
"""
# How long (s) anything may take before the test fails instead of hanging.
PATIENCE = 60.0


@contextmanager
def browser(profile):
    """A Chromium with an empty `profile` folder; yields its Page."""
    to_browser, from_test = os.pipe()
    to_test, from_browser = os.pipe()
    process = subprocess.Popen(
        [
            *(sys.executable, "-c", _LAUNCHER, str(to_browser), str(from_browser)),
            EXECUTABLE,
            *_FLAGS,
            f"--user-data-dir={profile}",
            "about:blank",
        ],
        pass_fds=(to_browser, from_browser),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(to_browser)
    os.close(from_browser)
    try:
        yield Page(from_test, to_test)
    finally:
        process.terminate()
        process.wait(timeout=PATIENCE)
        os.close(from_test)
        os.close(to_test)


class Page:
    """The only tab of a browser: commands, and the events that have arrived."""

    def __init__(self, writing, reading):
        self._writing, self._reading = writing, reading
        self._buffer, self._number, self._session = b"", 0, None
        self.events = []
        targets = self.send("Target.getTargets")["targetInfos"]
        target = next(one["targetId"] for one in targets if one["type"] == "page")
        attached = self.send("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def send(self, method, **parameters):
        """The result of a command."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._writing, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self._number:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self.events.append(answer)

    def open(self, address, width=1280, height=900):
        """Load a page and wait for it; the milliseconds it took until everything was there."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )
        self.send("Page.navigate", url=address)
        self.until("document.readyState === 'complete' && location.href !== 'about:blank'")
        return self.value("performance.timing.loadEventStart - performance.timing.navigationStart")

    def value(self, expression):
        """The value of a JavaScript expression."""
        found = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, expression):
        """Wait until the expression is true."""
        deadline = time.monotonic() + PATIENCE
        while not self.value(expression):
            assert time.monotonic() < deadline, f"never came true: {expression}"
            time.sleep(0.05)

    def shot(self, selector):
        """Pixels (height × width × 3) of the element, which is scrolled into the window."""
        box = self.place(selector)
        # The clip counts from the top of the document, the mouse from that of the window.
        box |= {"x": box["x"] + self.value("scrollX"), "y": box["y"] + self.value("scrollY")}
        taken = self.send("Page.captureScreenshot", format="png", clip=box | {"scale": 1})
        image = Image.open(io.BytesIO(base64.b64decode(taken["data"]))).convert("RGB")
        return np.asarray(image, dtype=int)

    def place(self, selector):
        """Where the element is in the window (px)."""
        self.value(
            f"document.querySelector({selector!r}).scrollIntoView("
            "{block: 'center', behavior: 'instant'})"
        )
        return self.value(
            f"(r => ({{x: r.x, y: r.y, width: r.width, height: r.height}}))"
            f"(document.querySelector({selector!r}).getBoundingClientRect())"
        )

    def drag(self, selector, right, down):
        """Press the mouse in the middle of the element, move it, and let it go."""
        box = self.place(selector)
        x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
        mouse = {"button": "left", "clickCount": 1}
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.send("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, **mouse)
        for step in (0.25, 0.5, 0.75, 1.0):
            self.send(
                "Input.dispatchMouseEvent",
                type="mouseMoved",
                x=x + step * right,
                y=y + step * down,
                buttons=1,
                **mouse,
            )
        self.send(
            "Input.dispatchMouseEvent", type="mouseReleased", x=x + right, y=y + down, **mouse
        )

    def click(self, selector):
        """Click in the middle of the element."""
        self.drag(selector, 0, 0)

    def wheel(self, selector, down):
        """Turn the wheel over the element; `self.former` in the page is where it stood before."""
        box = self.place(selector)
        self.value("self.former = scrollY")
        x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.send("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=down)

    def complaints(self):
        """Whatever the console said, and what was asked of any network."""
        self.value("1")
        said = []
        for event in self.events:
            method, told = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                said.append(json.dumps(told["exceptionDetails"]))
            elif method == "Runtime.consoleAPICalled":
                said.append(json.dumps(told["args"]))
            elif method == "Log.entryAdded" and told["entry"]["level"] == "error":
                said.append(told["entry"]["text"])
            elif method == "Network.requestWillBeSent":
                address = told["request"]["url"]
                if not address.startswith(("file:", "data:", "about:", "blob:")):
                    said.append(f"asked for {address}")
        return said

    def _receive(self, deadline):
        while b"\0" not in self._buffer:
            ready, _, _ = select.select(
                [self._reading], [], [], max(0.0, deadline - time.monotonic())
            )
            assert ready, "the browser does not answer"
            part = os.read(self._reading, 1 << 20)
            assert part, "the browser has ended"
            self._buffer += part
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)
