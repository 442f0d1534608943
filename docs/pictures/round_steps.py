"""Draws docs/pictures/round-steps.svg: section meshes at steps from round to straight edges.

python docs/pictures/round_steps.py
"""

from itertools import starmap
from pathlib import Path

import numpy as np

from lumped.legs import Span
from lumped.sections import Circle, HollowRectangle, Rectangle, Section, Tube
from meshes.stepped import stepped_sections

PICTURE = Path(__file__).resolve().parent / "round-steps.svg"
# Sections (m) before and after each step.
STEPS: list[tuple[Section, Section]] = [
    (Rectangle(0.06, 0.06), Circle(0.068)),
    (Rectangle(0.09, 0.07), Tube(0.06, 0.01)),
    (HollowRectangle(0.06, 0.06, 0.004), Tube(0.056, 0.004)),
]
# Order of the corners and the middles of the sides of a nine-node cell, around it.
AROUND = [0, 4, 1, 5, 2, 6, 3, 7]
SCALE, WIDTH = 2500.0, 250.0


def cells(first: Section, second: Section) -> str:
    """SVG paths of the cells of a step: the first section grey, and the second one with lines."""
    spans = (Span(0.0, 0.2, first, first), Span(0.2, 0.4, second, second))
    common = stepped_sections(spans, 4)
    shaded = common.filled(0)
    points = np.round(SCALE * common.mesh.nodes, 1)
    paths = []
    for cell, is_shaded in zip(common.mesh.cells, shaded.tolist(), strict=True):
        start, *middles_and_corners = points[cell[AROUND]].tolist()
        sides = [*middles_and_corners, start]
        # The control point of a parabola through the middle of a side.
        previous, path = start, f"M{start[0]:g} {start[1]:g}"
        for middle, corner in zip(sides[::2], sides[1::2], strict=True):
            control = [
                2.0 * m - 0.5 * (a + b) for a, m, b in zip(previous, middle, corner, strict=True)
            ]
            path += f"Q{control[0]:.1f} {control[1]:.1f} {corner[0]:g} {corner[1]:g}"
            previous = corner
        paths.append(f'<path d="{path}" fill="{"#d5d8dc" if is_shaded else "#ffffff"}"/>')
    return "".join(paths)


if __name__ == "__main__":
    drawings = [
        f'<g transform="translate({WIDTH * (0.5 + number):g} {0.5 * WIDTH:g})">{drawing}</g>'
        for number, drawing in enumerate(starmap(cells, STEPS))
    ]
    PICTURE.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH * len(STEPS):g} {WIDTH:g}">'
        f'<g stroke="#2c3e50" stroke-width="0.6">{"".join(drawings)}</g></svg>\n',
        encoding="utf-8",
    )
