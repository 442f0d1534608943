"""Files and cache entries of a run on a machine that lacks them."""

import numpy as np
from numpy.testing import assert_array_equal
from support.fakes.cleared_memory import forget
from support.robots.crane import write_meshed_crane

from lumped.robot_file import load_robot
from validation.run.cache import find, keep, key_of
from validation.run.provisions import provisions


def test_other_machine_gets_files_and_entries(tmp_path, monkeypatch):
    """The content of a part's file counts, not its path."""
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "here"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    robot, key = load_robot(write_meshed_crane(tmp_path)), key_of("stiffness")
    file = robot.mechanism.bodies["arm"].shape.file
    content = file.read_bytes()
    arrays = keep(key, {"stiffness": np.arange(4.0)})
    sent = provisions(robot, {key: arrays})
    # Nothing is copied if the file is there, as on a shared disk.
    assert sent.unpack(robot) is robot
    file.write_bytes(content + b"changed")
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "there"))
    forget()
    assert find(key) is None
    unpacked = sent.unpack(robot)
    copy = unpacked.mechanism.bodies["arm"].shape.file
    assert copy != file
    assert copy.read_bytes() == content
    assert_array_equal(find(key)["stiffness"], np.arange(4.0))
