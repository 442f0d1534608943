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
def test_pipes_links_devices_and_large_files_are_called_what_they_are(name, tmp_path):
    path = tmp_path / name

    def refused(said):
        with pytest.raises(InputError, match=said):
            READERS[name](path)
        path.unlink()

    os.mkfifo(path)
    refused("is a pipe; must be")
    path.symlink_to("nowhere")
    refused(f"{name}: is a link to nowhere, which does not exist")
    if READERS[name] is not require_file:
        path.symlink_to("/dev/zero")
        refused("is a device")
        with path.open("wb") as file:
            file.truncate(300_000_000)
        refused("is larger than")


def test_a_file_of_the_largest_size_is_read_whole(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"x" * 100)
    assert read_ordinary(path, "a file", 100) == b"x" * 100
    with pytest.raises(InputError, match="is larger than"):
        read_ordinary(path, "a file", 99)
