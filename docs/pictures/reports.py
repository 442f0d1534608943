"""Draws docs/pictures/report.png and parts-report.png: what two reports say first.

    python docs/pictures/reports.py

Chromium opens them as wide as on a desktop.
"""

import subprocess
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from validation import cli

PICTURES = Path(__file__).resolve().parent
# Picture, robot, and how much of its page is shown, in px.
SHOWN = (
    ("report.png", "ifw", 560),
    ("parts-report.png", "examples/tapered-biglide/robot.toml", 1000),
)
WIDTH = 1280


def draw(picture: str, robot: str, height: int) -> None:
    """Run the robot and take a picture of its page."""
    with TemporaryDirectory() as folder, chdir(PICTURES.parents[1]):
        run = Path(folder) / "run"
        cli.main(["run", robot, "--preset", "quick", "--out", str(run)])
        browser = ["chromium", "--headless=new", "--no-sandbox", "--hide-scrollbars"]
        size = f"--window-size={WIDTH},{height}"
        page, target = (run / "report.html").as_uri(), f"--screenshot={PICTURES / picture}"
        subprocess.run([*browser, size, target, page], check=True)  # noqa: S603  our own page


if __name__ == "__main__":
    for shown in SHOWN:
        draw(*shown)
