"""The cache on the disk: invalid entries, a full disk, several processes and machines."""

import os
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from support.robots.crane import write_meshed_crane

from lumped.memo import forget
from lumped.robot_file import load_robot
from validation.run import cache
from validation.run.cache import CacheEntry, available_cache, find, keep, key_of, require_shape
from validation.run.provisions import provisions

ROOT = Path(__file__).resolve().parents[3]
ARRAYS = {"powers": np.arange(4.0), "total": np.array(6.0)}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXPROOF_CACHE", str(tmp_path / "cache"))
    forget()
    return tmp_path / "cache"


def test_invalid_entries_are_ignored(folder):
    """Torn, changed, exchanged or foreign files, links and pipes: computed again."""
    keep("a", ARRAYS)
    forget()
    assert_array_equal(find("a")["powers"], ARRAYS["powers"])
    file = folder / "a.npz"
    valid_bytes = file.read_bytes()
    (folder / "b.npz").write_bytes(valid_bytes)
    other = BytesIO()
    np.savez(other, powers=np.zeros(10**6), total="no number")
    flipped = bytearray(valid_bytes)
    flipped[len(valid_bytes) // 2] ^= 1
    for content in (b"PK torn", b"", b"[]", bytes(flipped), valid_bytes[:-1], other.getvalue()):
        file.write_bytes(content)
        forget()
        assert find("a") is None
    for odd in (lambda: file.symlink_to("/dev/zero"), lambda: os.mkfifo(file), file.mkdir):
        file.unlink()
        odd()
        forget()
        assert find("a") is None
    file.rmdir()
    # Filed under another name it is not what was asked for.
    assert find("b") is None
    assert CacheEntry("b", lambda: {"anew": 1.0}, dict).value()["anew"] == 1.0
    forget()
    assert find("b")["anew"] == 1.0


def read_powers(arrays):
    require_shape(arrays, powers=(None,), total=())
    return arrays["powers"].sum()


@pytest.mark.parametrize(
    "wrong", [{"total": 1.0}, {**ARRAYS, "powers": np.zeros(0)}, {**ARRAYS, "total": np.ones(2)}]
)
def test_cache_entry_with_wrong_arrays_is_ignored(wrong):
    """Missing or empty arrays and wrong shapes, although the checksum is valid."""
    keep("a", wrong)
    for computed in (lambda: ARRAYS, pytest.fail):
        forget()
        assert CacheEntry("a", computed, read_powers).value() == 6.0


def test_cache_entry_with_valid_arrays_is_used():
    """An entry is stored if those that it needs are stored, too."""
    needed = CacheEntry("needed", lambda: {"half": 3.0}, lambda arrays: float(arrays["half"]))
    entry = CacheEntry("a", lambda: ARRAYS | {"half": needed.value()}, read_powers, (needed,))
    # Nothing is computed for the answer.
    assert not CacheEntry("a", pytest.fail, read_powers, (needed,)).is_stored
    assert (entry.is_stored, entry.stored_arrays) == (False, {})
    assert entry.value() == 6.0
    forget()
    assert entry.is_stored
    assert entry.stored_arrays.keys() == {"needed", "a"}
    assert_array_equal(entry.stored_arrays["needed"]["half"], 3.0)
    # Sealed arrays of another shape are none.
    keep("a", {"powers": np.zeros(0)})
    assert not entry.is_stored


def test_cache_reading_never_unpickles(folder):
    """Pickled data in a cache entry are not executed, even if its seal is valid."""
    bomb = BytesIO()
    np.savez(bomb, bomb=np.array([Bomb()]))
    folder.mkdir()
    sealed = bomb.getvalue() + cache._SEAL + cache.digest(b"a" + bomb.getvalue()).encode()
    (folder / "a.npz").write_bytes(sealed)
    assert find("a") is None
    with pytest.raises(ValueError, match="allow_pickle=False"):
        keep("c", {"odd": Bomb()})


class Bomb:
    def __reduce__(self):
        return pytest.fail, ("unpickled",)


def test_unwritable_cache_recomputes_all(folder, monkeypatch, tmp_path):
    """A file in place of the folder; FLEXPROOF_CACHE=off; a relative XDG_CACHE_HOME is ignored."""
    folder.write_text("a file")
    assert CacheEntry("a", lambda: ARRAYS, dict).value()["total"] == 6.0
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    forget()
    assert find("a") is None
    # For the time of a run its processes share a folder all the same, and nothing of it is left.
    with available_cache():
        meanwhile = cache.cache_folder()
        keep("a", ARRAYS)
        assert list(meanwhile.iterdir()) == [meanwhile / "a.npz"]
    assert not meanwhile.exists()
    assert os.environ["FLEXPROOF_CACHE"] == "off"
    for setting, folder_of_caches in (
        ("relative", Path.home() / ".cache"),
        (str(tmp_path), tmp_path),
    ):
        monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
        monkeypatch.setenv("XDG_CACHE_HOME", setting)
        assert cache.cache_folder() == folder_of_caches / "flexproof"


def test_full_cache_drops_least_recently_used(folder, monkeypatch):
    """Files of the user remain; old lock files are deleted."""
    for number, key in enumerate("abcd"):
        keep(key, {"much": np.zeros(1000)})
        os.utime(folder / f"{key}.npz", (number, number))
    (folder / "mine.txt").write_text("mine")
    (folder / "old.lock").write_text("")
    os.utime(folder / "old.lock", (0, 0))
    forget()
    assert find("a") is not None
    monkeypatch.setattr(cache, "_CACHE_LIMIT", 4 * (folder / "a.npz").stat().st_size)
    keep("e", {"much": np.zeros(1000)})
    assert {file.name for file in folder.iterdir()} == {"a.npz", "d.npz", "e.npz", "mine.txt"}


COMPUTING = """
import sys, time
import numpy as np
from validation.run.cache import CacheEntry

def compute():
    print("computing", flush=True)
    time.sleep(float(sys.argv[1]))
    return {"large": np.arange(1e6)}

assert CacheEntry("a", compute, dict).value()["large"].sum() == np.arange(1e6).sum()
"""


def computing(seconds):
    line = [sys.executable, "-c", COMPUTING, str(seconds)]
    return subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE, text=True)


def test_killed_run_leaves_valid_cache(folder):
    """No entry or a complete one. Two runs compute one entry once."""
    for moment in (0.0, 0.02):
        process = computing(0.0)
        process.stdout.readline()
        time.sleep(moment)
        process.kill()
        process.communicate()
        forget()
        arrays = find("a")
        assert arrays is None or arrays["large"].sum() == np.arange(1e6).sum()
        (folder / "a.npz").unlink(missing_ok=True)
    processes = [computing(1.0), computing(1.0)]
    outputs = [process.communicate(timeout=60)[0] for process in processes]
    assert sorted(outputs) == ["", "computing\n"]
    assert [process.returncode for process in processes] == [0, 0]


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
