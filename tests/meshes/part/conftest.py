"""Parts made on the spot, by gmsh's kernel, and written as STEP in millimetres."""

from collections.abc import Callable
from pathlib import Path

import pytest
from drawn_parts import written

from meshes.part import volume
from meshes.part.reading import read


def box(occ, s):
    occ.addBox(0.0, -10.0 * s, -15.0 * s, 100.0 * s, 20.0 * s, 30.0 * s)


def lug(occ, s):
    """A bar 200 × 40 × 30 mm with bores of radius 8 and 5 along z at x = 20 and 180."""
    bar = occ.addBox(0.0, -20.0 * s, -15.0 * s, 200.0 * s, 40.0 * s, 30.0 * s)
    bores = [
        (3, occ.addCylinder(x * s, 0.0, -30.0 * s, 0.0, 0.0, 60.0 * s, r * s))
        for x, r in ((20.0, 8.0), (180.0, 5.0))
    ]
    occ.cut([(3, bar)], bores)


@pytest.fixture
def in_this_process(monkeypatch):
    """Files that do not end the CAD kernel are read and meshed without a process of their own."""
    for module in (read, volume):
        monkeypatch.setattr(module, "within_limits", lambda _, function, *rest: function(*rest))


@pytest.fixture(scope="session")
def part_file(tmp_path_factory) -> Callable:
    """A function that writes a part: (name with suffix, builder, scale) → path."""
    folder = tmp_path_factory.mktemp("parts")

    def make(name: str, build: Callable, scale: float = 1.0) -> Path:
        return written(folder / name, lambda kernel: build(kernel, scale))

    return make


@pytest.fixture(scope="session")
def lug_step(part_file) -> Path:
    return part_file("lug.step", lug)


@pytest.fixture(scope="session")
def box_step(part_file) -> Path:
    return part_file("box.step", box)
