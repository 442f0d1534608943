"""What a script sees in a page that a headless Chromium has opened, without a network."""

import json
import re
import shutil
import subprocess
from urllib.parse import unquote

NAMES = ("chromium", "chromium-browser", "google-chrome")
EXECUTABLE = next((found for name in NAMES if (found := shutil.which(name))), None)
_FLAGS = (
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
_ADDED = """<script type="module" id="looking">
document.getElementById("looking").remove();
const look = async () => { %s };
const found = await look().catch(error => ({ error: error.stack }));
document.body.textContent = `found ${encodeURIComponent(JSON.stringify(found))} found`;
</script></body>"""


def seen(html, script, folder):
    """What `script`, the body of an async function, returns in the page; lines of the console.

    The page and the browser's profile are written into `folder`.
    """
    page = folder / "page.html"
    page.write_text(html.replace("</body>", _ADDED % script), encoding="utf-8")
    line = [EXECUTABLE, *_FLAGS, f"--user-data-dir={folder / 'profile'}", page.as_uri()]
    done = subprocess.run(line, capture_output=True, text=True, check=True, timeout=120.0)
    (found,) = re.findall("found (.*) found", done.stdout)
    return json.loads(unquote(found)), [one for one in done.stderr.splitlines() if "CONSOLE" in one]
