"""Meshes whose optimiser ends its process."""

import numpy as np
import pytest

from lumped.errors import ComputationError
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.own_process import Crashed
from meshes.part import volume
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part


@pytest.fixture
def bar(box_step):
    part = read_part(box_step)
    plane = ByPlane((-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return part, find_interfaces(part, {"A": PartInterface(plane, "rigid")})


def test_it_is_left_out_where_it_crashes(bar, monkeypatch):
    grading = volume.Grading(0.02)
    usual = volume.volume_mesh(*bar, grading)

    def crashing(function, *arguments):
        if arguments[-1]:
            raise Crashed
        return function(*arguments)

    monkeypatch.setattr(volume, "in_own_process", crashing)
    plain = volume.volume_mesh(*bar, grading)
    # Another mesh of the same block, which is as long.
    assert np.ptp(plain.nodes, axis=0) == pytest.approx(np.ptp(usual.nodes, axis=0))
    assert len(plain.nodes) != len(usual.nodes) or np.abs(plain.nodes - usual.nodes).max() > 1e-6


def test_what_cannot_be_meshed_without_it_is_said(bar, monkeypatch):
    def crashing(*_):
        raise Crashed

    monkeypatch.setattr(volume, "in_own_process", crashing)
    with pytest.raises(ComputationError, match=r"box.step: gmsh ends its process .* of 0.02 m"):
        volume.volume_mesh(*bar, volume.Grading(0.02))
