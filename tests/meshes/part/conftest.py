"""Parts drawn by gmsh's CAD kernel, written as STEP in millimetres and read in this process."""

import pytest
from support.robots.drawn_parts import without_processes, written


@pytest.fixture
def in_this_process(monkeypatch):
    without_processes(monkeypatch)


@pytest.fixture(scope="session")
def box_step(tmp_path_factory):
    """Return a STEP file of a box of 100 × 20 × 30 mm with the origin in the middle of one end."""
    path = tmp_path_factory.mktemp("parts") / "box.step"
    return written(path, lambda occ: occ.addBox(0.0, -10.0, -15.0, 100.0, 20.0, 30.0))
