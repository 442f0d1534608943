"""Runs that are killed, interrupted, or out of disk: nothing that was finished is lost."""

import json
import os
import random
import shutil
import signal
import subprocess
import time

import pytest
import toy_runs as toys

ASKED = ("run", "--preset", "quick", "--out")


def summary(path):
    """What a run that was given up says of itself and its cases."""
    found = json.loads((toys.partial(path) / "results.json").read_text())
    return found["run"], [case["verdict"] for case in found["cases"]]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The numbers of a run, and how long it takes (s)."""
    path = tmp_path_factory.mktemp("undisturbed") / "run"
    begun = time.monotonic()
    done = toys.completed("real", *ASKED, path, "--jobs", "2")
    assert done.returncode == 0, done.stderr
    assert len(toys.numbers(path)[0]) > 25
    return toys.numbers(path), time.monotonic() - begun


@pytest.mark.exhaustive
def test_a_run_killed_four_times_goes_on_to_the_same_results(undisturbed, tmp_path):
    expected, duration = undisturbed
    path = tmp_path / "run"
    moments = random.Random(0)  # noqa: S311  any moments will do
    kept = []

    def resumed():
        """Killed before it had even said what it is, a run has nothing to go on with."""
        return ["--resume"] if (toys.partial(path) / "run.json").exists() else []

    for _ in range(4):
        run = toys.started(toys.command("real", *ASKED, path, "--jobs", "2", *resumed()))
        time.sleep(moments.uniform(0.0, duration / 2.0))
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        # What was finished was not computed again: the times in it are the same.
        assert toys.lines(path)[: len(kept)] == kept
        # Without a last line that the kill cut off.
        kept = [record for record in toys.lines(path) if record.endswith(b"}}")]
        if path.exists():  # finished before it was killed, on a machine that is faster now
            break
    else:
        # Numbers do not depend on the number of processes.
        done = toys.completed("real", *ASKED, path, "--jobs", "1", *resumed())
        assert done.returncode == 0, done.stderr
    assert toys.numbers(path) == expected
    assert toys.lines(path)[: len(kept)] == kept
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]


@pytest.mark.exhaustive
def test_under_nohup_a_hang_up_changes_nothing(undisturbed, tmp_path):
    path = tmp_path / "run"
    run = toys.started(["nohup", *toys.command("real", *ASKED, path)])
    toys.wait_for(lambda: toys.lines(path))
    # As the terminal does when it is closed: to all processes in front, workers included.
    os.killpg(run.pid, signal.SIGHUP)
    _, said = run.communicate()
    assert run.returncode == 0, said
    assert toys.numbers(path) == undisturbed[0]


def test_a_hang_up_without_nohup_ends_the_run_as_ctrl_c_does(tmp_path):
    path = tmp_path / "run"
    # The tests themselves may run under nohup.
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    run = toys.started(toys.command("endless", "run", "--out", path))
    signal.signal(signal.SIGHUP, before)
    toys.wait_for(lambda: toys.lines(path))
    os.killpg(run.pid, signal.SIGHUP)
    _, said = run.communicate(timeout=toys.PATIENCE)
    assert run.returncode == 3
    assert "go on with: flexproof run ifw" in said
    # The worker left it to the run: nothing has failed.
    assert summary(path)[1] == ["agree"]


def test_ctrl_c_on_a_terminal_ends_the_run(tmp_path):
    path = tmp_path / "run"
    asked = toys.command("endless", "run", "--out", path)
    code, screen = toys.on_terminal(asked, toys.ENVIRONMENT, pressed=lambda _: toys.lines(path))
    assert code == 3
    for said in ("1 not computed", "interrupted", "--resume"):
        assert said in screen
    assert "Traceback" not in screen
    assert summary(path)[0]["unfinished"] == 1


@pytest.mark.exhaustive
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can mount a small disk")
def test_a_full_disk_ends_with_a_clear_message_and_keeps_what_was_done(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    asked = ("chatty", "run", "--out", disk / "run", "--jobs", "1")
    mount, umount = (
        shutil.which(name) or pytest.skip(f"no {name}") for name in ("mount", "umount")
    )
    small = [mount, "-t", "tmpfs", "-o", "size=256k", "none", str(disk)]
    if subprocess.run(small, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed here")
    try:
        done = toys.completed(*asked)
        assert done.returncode == 3
        failed, how_to_go_on = done.stderr.splitlines()
        assert "No space left on device; what was finished before is kept" in failed
        assert "go on with: flexproof run ifw" in how_to_go_on
        assert toys.lines(disk / "run")
        assert set(summary(disk / "run")[1]) == {"agree"}
        subprocess.run([mount, "-o", "remount,size=8m", str(disk)], check=True)
        done = toys.completed(*asked, "--resume")
        assert done.returncode == 0, done.stderr
        assert "All 12 comparisons agree" in done.stdout
    finally:
        subprocess.run([umount, str(disk)], check=True)
