"""Runs that are killed, interrupted, or out of disk: nothing that was finished is lost."""

import json
import os
import random
import shutil
import signal
import subprocess
import time

import pytest
from toy_runs import (
    ENVIRONMENT,
    PATIENCE,
    command,
    completed,
    lines,
    on_terminal,
    partial,
    started,
    wait_for,
)


def results(path):
    """results.json without times and without what names processes."""
    content = json.loads((path / "results.json").read_text())
    for name in ("started", "seconds"):
        del content["run"][name]
    for entry in content["cases"]:
        del entry["seconds"]
        if entry["id"].startswith("toy."):
            del entry["notes"]
    return content


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    path = tmp_path_factory.mktemp("undisturbed") / "run"
    begun = time.monotonic()
    done = completed("real", "run", "--preset", "quick", "--out", path, "--jobs", "2")
    assert done.returncode == 0, done.stderr
    content = results(path)
    assert len(content["cases"]) > 25
    return content, time.monotonic() - begun


@pytest.mark.exhaustive
def test_a_run_killed_four_times_goes_on_to_the_same_results(undisturbed, tmp_path):
    expected, duration = undisturbed
    path = tmp_path / "run"
    asked = ("run", "--preset", "quick", "--out", path, "--jobs", "2")
    moments = random.Random(0)  # noqa: S311  any moments will do
    kept = []
    for _ in range(4):
        run = started(command("real", *asked, *resumed(path)))
        time.sleep(moments.uniform(0.0, duration))
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        # What was finished was not computed again: the times in it are the same.
        assert lines(path)[: len(kept)] == kept
        kept = whole(lines(path))
    # Numbers do not depend on the number of processes.
    done = completed("real", *asked[:-1], "1", *resumed(path))
    assert done.returncode == 0, done.stderr
    assert results(path) == expected
    assert lines(path)[: len(kept)] == kept
    assert not list(path.rglob(".*.tmp"))
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]


def whole(records):
    """Without a last line that a kill cut off."""
    return [record for record in records if record.endswith(b"}}")]


def resumed(path):
    """Killed before it had even said what it is, a run has nothing to go on with."""
    begun = path.exists() or (partial(path) / "run.json").exists()
    return ["--resume"] if begun else []


@pytest.mark.exhaustive
def test_under_nohup_a_hang_up_changes_nothing(undisturbed, tmp_path):
    path = tmp_path / "run"
    asked = command("real", "run", "--preset", "quick", "--out", path, "--jobs", "2")
    run = started(["nohup", *asked])
    wait_for(lambda: lines(path))
    # As the terminal does when it is closed: to all processes in front, workers included.
    os.killpg(run.pid, signal.SIGHUP)
    _, said = run.communicate()
    assert run.returncode == 0, said
    assert results(path) == undisturbed[0]


@pytest.fixture
def endless(tmp_path):
    """A run whose first case is finished and whose second takes a minute."""
    # The tests themselves may run under nohup.
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    run = started(command("endless", "run", "--out", tmp_path / "run"))
    signal.signal(signal.SIGHUP, before)
    wait_for(lambda: lines(tmp_path / "run"))
    return run


def test_a_hang_up_without_nohup_ends_the_run_as_ctrl_c_does(endless, tmp_path):
    second = completed("endless", "run", "--out", tmp_path / "run", "--resume")
    assert second.returncode == 2
    (line,) = second.stderr.splitlines()
    assert f"another run (process {endless.pid}) is writing there" in line
    os.killpg(endless.pid, signal.SIGHUP)
    _, said = endless.communicate(timeout=PATIENCE)
    assert endless.returncode == 3
    assert "go on with: flexproof run ifw" in said
    cases = json.loads((tmp_path / "run.partial" / "results.json").read_text())["cases"]
    # The worker left it to the run: nothing has failed.
    assert [case["verdict"] for case in cases] == ["agree"]


def test_ctrl_c_on_a_terminal_ends_the_run(tmp_path):
    path = tmp_path / "run"
    asked = command("endless", "run", "--out", path)
    code, screen = on_terminal(asked, ENVIRONMENT, pressed=lambda _: lines(path))
    assert code == 3
    assert "1 not computed" in screen
    assert "interrupted" in screen
    assert "--resume" in screen
    assert "Traceback" not in screen
    assert (
        json.loads((tmp_path / "run.partial" / "results.json").read_text())["run"]["unfinished"]
        == 1
    )


@pytest.mark.exhaustive
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can mount a small disk")
def test_a_full_disk_ends_with_a_clear_message_and_keeps_what_was_done(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = shutil.which("mount") or pytest.skip("no mount")
    umount = shutil.which("umount") or pytest.skip("no umount")
    small = [mount, "-t", "tmpfs", "-o", "size=256k", "none", str(disk)]
    if subprocess.run(small, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed here")
    try:
        done = completed("chatty", "run", "--out", disk / "run", "--jobs", "1")
        assert done.returncode == 3
        assert "No space left on device; what was finished before is kept" in done.stderr
        assert "go on with: flexproof run ifw" in done.stderr
        assert len(done.stderr.splitlines()) == 2
        assert lines(disk / "run")
        cases = json.loads((disk / "run.partial" / "results.json").read_text())["cases"]
        assert {case["verdict"] for case in cases} == {"agree"}
        larger = [mount, "-o", "remount,size=8m", str(disk)]
        subprocess.run(larger, check=True)
        done = completed("chatty", "run", "--out", disk / "run", "--jobs", "1", "--resume")
        assert done.returncode == 0, done.stderr
        assert "All 12 comparisons agree" in done.stdout
    finally:
        subprocess.run([umount, str(disk)], check=True)
