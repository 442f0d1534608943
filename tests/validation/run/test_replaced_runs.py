"""kill -9 while a new run takes the place of a finished one: one of the two is always whole."""

import json
import os
import random
import shutil
import signal
import time

import pytest
from toy_runs import command, completed, content, partial, started, wait_for

COUNT = 30
# Every other kill falls into the replacement itself, which is made this slow (s per step) for it.
STEP = 0.02


def preset_of(path):
    """The preset of the run that a folder holds; its results must be those of a whole run."""
    run = json.loads((path / "results.json").read_text())["run"]
    assert run["unfinished"] == 0
    assert json.loads((path / "run.json").read_text())["preset"] == run["preset"]
    return run["preset"]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished quick run, with a file of somebody else, and how long a run takes (s)."""
    path = tmp_path_factory.mktemp("finished") / "run"
    begun = time.monotonic()
    finish("quick", path)
    duration = time.monotonic() - begun
    (path / "figures" / "thesis.png").write_bytes(b"years of work")
    return path, duration


def finish(preset, path, *resumed):
    done = completed("sound", "run", "--preset", preset, "--out", path, *resumed)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed",
    [
        1,
        pytest.param(0, marks=pytest.mark.exhaustive),
        *(pytest.param(k, marks=pytest.mark.soak) for k in range(2, COUNT)),
    ],
)
def test_a_kill_leaves_the_old_run_or_the_new_one(finished, tmp_path, seed):
    former, duration = finished
    path = tmp_path / "run"
    shutil.copytree(former, path)
    before = content(path)
    chance = random.Random(seed)  # noqa: S311  any moment will do
    slowly = {"SLOW_STEPS": str(STEP)} if seed % 2 else {}
    run = started(command("sound", "run", "--preset", "standard", "--out", path), **slowly)
    earlier = partial(path) / ".earlier"
    if slowly:
        wait_for(lambda: earlier.exists() or run.poll() is not None)
        time.sleep(chance.uniform(0.0, 15 * STEP))
    else:
        time.sleep(chance.uniform(0.0, 1.2 * duration))
    if run.poll() is None:
        os.killpg(run.pid, signal.SIGKILL)
    run.communicate()
    replaced = earlier.exists() or preset_of(path) == "standard"
    if not path.exists():
        # Between the two steps: both are whole, and whoever opens the folder next goes on.
        assert content(earlier) == before
        assert preset_of(partial(path)) == "standard"
    elif not replaced:
        # Not a byte of the old run has changed.
        assert content(path) == before
    finish("standard", path, *(["--resume"] if replaced else []))
    assert preset_of(path) == "standard"
    assert set(content(path)) == set(before)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]
    assert (path / "figures" / "thesis.png").read_bytes() == b"years of work"
    assert "standard" in (path / "report.html").read_text()
