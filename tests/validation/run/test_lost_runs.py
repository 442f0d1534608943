"""Runs that are killed, interrupted, out of disk space or corrupted keep finished results.

Files of a run are damaged: flipped bits, truncated, exchanged, replaced or deleted. Results whose
seal is broken are computed again, and foreign files keep every byte. Links and pipes:
test_run_folder.
"""

import json
import os
import random
import shutil
import signal
import subprocess
import time

import pytest
from support.fakes import toy_catalogue
from support.fakes import toy_runs as toys

from lumped.files import read_regular
from lumped.robot_file import load_robot
from validation.run import runner
from validation.validate import Request, validate

pytestmark = pytest.mark.usefixtures("blank_charts")

ASKED = ("run", "--preset", "quick", "--out")


def summary(path):
    """Header of the run and list of verdicts in results.json of an interrupted run."""
    record = json.loads((toys.partial(path) / "results.json").read_text())
    return record["run"], [case["verdict"] for case in record["cases"]]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Numbers of an undisturbed run, and its duration (s)."""
    path = tmp_path_factory.mktemp("undisturbed") / "run"
    begun = time.monotonic()
    completed = toys.completed("real", *ASKED, path, "--jobs", "2")
    assert completed.returncode == 0, completed.stderr
    assert len(toys.numbers(path)[0]) > 25
    return toys.numbers(path), time.monotonic() - begun


@pytest.mark.exhaustive
def test_resumed_run_equals_uninterrupted_run(undisturbed, tmp_path):
    """Killed at four random moments and resumed: equal numbers, finished results kept."""
    expected, duration = undisturbed
    path = tmp_path / "run"
    moments = random.Random(0)  # noqa: S311  any moments will do
    finished_lines = []

    def resumed():
        """Option --resume, or none if the run was killed before it wrote run.json."""
        return ["--resume"] if (toys.partial(path) / "run.json").exists() else []

    for _ in range(4):
        run = toys.started(toys.command("real", *ASKED, path, "--jobs", "2", *resumed()))
        time.sleep(moments.uniform(0.0, duration / 2.0))
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        # What was finished was not computed again: the times in it are the same.
        assert toys.lines(path)[: len(finished_lines)] == finished_lines
        # Without a last line that the kill cut off.
        finished_lines = [record for record in toys.lines(path) if record.endswith(b"}}")]
        if path.exists():  # finished before it was killed, on a machine that is faster now
            break
    else:
        # Numbers do not depend on the number of processes.
        completed = toys.completed("real", *ASKED, path, "--jobs", "1", *resumed())
        assert completed.returncode == 0, completed.stderr
    assert toys.numbers(path) == expected
    assert toys.lines(path)[: len(finished_lines)] == finished_lines
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]


@pytest.mark.exhaustive
def test_nohup_run_ignores_hangup(undisturbed, tmp_path):
    """A run under nohup finishes after SIGHUP, with the numbers of an undisturbed run."""
    path = tmp_path / "run"
    run = toys.started(["nohup", *toys.command("real", *ASKED, path)])
    toys.wait_for(lambda: toys.lines(path))
    # As the terminal does when it is closed: to all processes in front, workers included.
    os.killpg(run.pid, signal.SIGHUP)
    _, messages = run.communicate()
    assert run.returncode == 0, messages
    assert toys.numbers(path) == undisturbed[0]


def test_hangup_ends_run_like_ctrl_c(tmp_path):
    """SIGHUP of a closed terminal: results are kept, with the command that continues."""
    path = tmp_path / "run"
    # The tests themselves may run under nohup.
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    run = toys.started(toys.command("endless", "run", "--out", path))
    signal.signal(signal.SIGHUP, before)
    toys.wait_for(lambda: toys.lines(path))
    os.killpg(run.pid, signal.SIGHUP)
    _, messages = run.communicate(timeout=toys.PATIENCE)
    assert run.returncode == 3
    assert "continue with: flexproof run ifw" in messages
    # The worker left it to the run: nothing has failed.
    assert summary(path)[1] == ["agree"]


def test_ctrl_c_on_terminal_ends_run(tmp_path):
    """The screen shows the number of missing cases and --resume."""
    path = tmp_path / "run"
    line = toys.command("endless", "run", "--out", path)
    code, screen = toys.run_on_terminal(line, toys.ENVIRONMENT, pressed=lambda _: toys.lines(path))
    assert code == 3
    for words in ("1 not computed", "interrupted", "--resume"):
        assert words in screen
    assert "Traceback" not in screen
    assert summary(path)[0]["unfinished"] == 1


@pytest.mark.exhaustive
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can mount a small disk")
def test_full_disk_keeps_finished_results(tmp_path):
    """A disk of 256 kB; enlarged, the run continues."""
    disk = tmp_path / "disk"
    disk.mkdir()
    words = ("verbose", "run", "--out", disk / "run", "--jobs", "1")
    mount, umount = (
        shutil.which(name) or pytest.skip(f"no {name}") for name in ("mount", "umount")
    )
    small = [mount, "-t", "tmpfs", "-o", "size=256k", "none", str(disk)]
    if subprocess.run(small, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed here")
    try:
        completed = toys.completed(*words)
        assert completed.returncode == 3
        failed, how_to_go_on = completed.stderr.splitlines()
        assert "No space left on device" in failed
        assert "finished results are kept; continue with: flexproof run ifw" in how_to_go_on
        assert toys.lines(disk / "run")
        assert set(summary(disk / "run")[1]) == {"agree"}
        subprocess.run([mount, "-o", "remount,size=8m", str(disk)], check=True)
        completed = toys.completed(*words, "--resume")
        assert completed.returncode == 0, completed.stderr
        assert "All 12 comparisons agree" in completed.stdout
    finally:
        subprocess.run([umount, str(disk)], check=True)


# What `flexproof test` tries of it, and -m exhaustive besides.
FEW, MORE, COUNT = 8, 20, 60
ODD = (
    *("", "[]", "5", "{}", "null", "\x00", "[" * 50_000),
    *('{"seal": "', '{"run": 5}', '{"schema": 1, "run": [], "cases": {}}'),
    '{"id": "toy.agrees", "verdict": "agree"}',
)
# Where the run has nothing to write.
PLACES = (
    *("records/other.json", "figures/thesis.png", "notes.json"),
    *("export/precious.dat", "figures.kept/precious", ".results.json.tmp"),
)
PRECIOUS = b"years of work "


def request(path, **changes):
    return Request(load_robot("ifw"), "quick", path, 1, **changes)


@pytest.fixture(scope="module")
def untouched(tmp_path_factory):
    path = tmp_path_factory.mktemp("untouched") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "run", toys.run_in_this_process)
        validate(request(path), toy_catalogue.disagreeing)
        yield path


def damage(path, chance):
    """Damage a file of a run at random, or add a foreign file; return a description."""
    files = sorted(file for file in path.rglob("*") if file.is_file())
    files_of_run = [file for file in files if PRECIOUS not in file.read_bytes()]
    # The records matter most.
    weights = [5 if file.suffix == ".jsonl" else 1 for file in files_of_run]
    file, other = chance.choices(files_of_run, weights, k=2)
    data = bytearray(file.read_bytes() or b"0")
    precious = PRECIOUS + chance.randbytes(16).hex().encode()
    match kind := chance.randrange(9):
        case 0:
            data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
            file.write_bytes(data)
        case 1:
            os.truncate(file, chance.randrange(len(data)))
        case 2:
            file.write_bytes(other.read_bytes())
            other.write_bytes(data)
        case 3:
            file.write_bytes(data.replace(b"0.33333", b"12345.0").replace(b"1.84", b"1.0"))
        case 4:
            file.write_text(chance.choice(ODD))
        case 5:
            new_file = path / chance.choice(PLACES)
            new_file.parent.mkdir(exist_ok=True)
            new_file.write_bytes(b'{"id": "%s"}' % precious)
        case 6:
            file.write_bytes(precious)
        case 7:
            file.unlink()
        case _:
            lines = data.splitlines(keepends=True)
            file.write_bytes(b"".join(chance.choices(lines, k=len(lines))))
    return kind, file.name


@pytest.mark.parametrize(
    "seed",
    [
        *range(FEW),
        *(pytest.param(k, marks=pytest.mark.exhaustive) for k in range(FEW, MORE)),
        *(pytest.param(k, marks=pytest.mark.soak) for k in range(MORE, COUNT)),
    ],
)
def test_corrupted_run_resumes_to_same_results(untouched, tmp_path, seed):
    """One to three random damages; files of the user are unchanged."""
    path = tmp_path / "run"
    shutil.copytree(untouched, path)
    mark, records = path / "run.json", path / "results.jsonl"
    sound, chance = mark.read_bytes(), random.Random(seed)  # noqa: S311  any damage will do
    done = [damage(path, chance) for _ in range(chance.randint(1, 3))]
    # One of the two by which a folder is known as a run's always remains.
    if read_regular(mark) != sound and b'", "started"' not in (read_regular(records) or b""):
        if mark.exists():
            mark.rename(mark.with_name("mine"))
        mark.write_bytes(sound)
    before = toys.content(path)
    gathered = validate(request(path, start="resumed"), toy_catalogue.disagreeing)
    assert gathered.standing.exit_code == 1, done
    assert toys.numbers(path) == toys.numbers(untouched), done
    after = toys.content(path)
    for name, written in before.items():
        if PRECIOUS in written:
            assert written in after.values(), done
            # Nor is it renamed where the run has nothing to write.
            assert name not in PLACES or after[name] == written, done
