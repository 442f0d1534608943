"""Draws docs/pictures/convergence.svg: errors of leg 1 of the built-in robot over element count.

python docs/pictures/convergence.py
"""

from pathlib import Path

import flexproof as fp
from validation.drawing.plot import chart_svg

PICTURE = Path(__file__).resolve().parent / "convergence.svg"

if __name__ == "__main__":
    study = fp.converge("ifw", body="leg1")
    PICTURE.write_text(chart_svg(study.chart(["f1", "f2"])), encoding="utf-8")
