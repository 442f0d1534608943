"""Whatever is read is an ordinary file: a pipe would wait for someone to write."""

import os

import pytest

from lumped.errors import InputError
from lumped.files import read_ordinary
from lumped.robot_file import load_robot
from lumped.robot_file.evidence import read_measured
from meshes.part.reading.read import require_file
from validation.results.records import load_run

READERS = {
    "robot.toml": load_robot,
    "measured.csv": read_measured,
    "results.json": load_run,
    "fork.step": require_file,
    "fork.brep": require_file,
    "fork.msh": require_file,
}


@pytest.mark.parametrize("name", READERS)
def test_pipes_and_links_to_nothing_are_called_what_they_are(name, tmp_path):
    path = tmp_path / name
    os.mkfifo(path)
    with pytest.raises(InputError, match="is a pipe; must be"):
        READERS[name](path)
    path.unlink()
    path.symlink_to("nowhere")
    with pytest.raises(InputError, match=f"{name}: is a link to nowhere, which does not exist"):
        READERS[name](path)


@pytest.mark.parametrize("name", ["robot.toml", "measured.csv", "results.json"])
def test_endless_and_oversized_files_are_refused_before_they_are_read(name, tmp_path):
    path = tmp_path / name
    path.symlink_to("/dev/zero")
    with pytest.raises(InputError, match="is a device"):
        READERS[name](path)
    path.unlink()
    with path.open("wb") as file:
        file.truncate(300_000_000)
    with pytest.raises(InputError, match="is larger than"):
        READERS[name](path)


def test_a_file_of_the_largest_size_is_read_whole(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"x" * 100)
    assert read_ordinary(path, "a file", 100) == b"x" * 100
    with pytest.raises(InputError, match="is larger than"):
        read_ordinary(path, "a file", 99)
