"""Units of work: what is finished is kept, survives Ctrl-C, and is not computed again."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from lumped.errors import ComputationError
from validation.sweeps.cores import on_cores
from validation.sweeps.journal import Journal, key_of
from validation.sweeps.runner import computed, in_turn

ROOT = Path(__file__).resolve().parents[3]


@dataclass(frozen=True, eq=False)
class Powers:
    """What a unit yields: numbers and arrays."""

    powers: np.ndarray
    total: float


@dataclass(frozen=True)
class Unit:
    """The first powers of a base."""

    base: float

    def compute(self):
        powers = self.base ** np.arange(4)
        return Powers(powers, float(powers.sum()))


def test_equal_units_are_computed_once_and_taken_up_in_order(tmp_path):
    units, calls = [Unit(2.0), Unit(3.0), Unit(2.0)], []

    def counting(works):
        calls.extend(works)
        yield from reversed([(number, work()) for number, work in enumerate(works)])

    found = computed(units, Powers, counting, Journal(tmp_path), "raising")
    assert [one.total for one in found] == [15.0, 40.0, 15.0]
    assert len(calls) == 2
    (again,) = computed(units[1:2], Powers, pytest.fail, Journal(tmp_path), "raising")
    assert_array_equal(again.powers, [1.0, 3.0, 9.0, 27.0])


def test_journal_outlives_the_process_and_ignores_damaged_files(tmp_path):
    unit = Unit(2.0)
    computed([unit], Powers, in_turn, Journal(tmp_path), "raising")
    kept = Journal(tmp_path).find(key_of(unit), Powers)
    assert kept is not None
    assert_array_equal(kept.powers, unit.compute().powers)
    file = tmp_path / f"{key_of(unit)}.npz"
    whole = bytearray(file.read_bytes())
    whole[len(whole) // 2] ^= 1
    other = BytesIO()
    np.savez(other, powers=np.zeros((10**6,)), total="no number", more=[1])
    for content in (b"PK torn", b"", b"[]", whole, whole[:-1], other.getvalue()):
        file.write_bytes(content)
        assert Journal(tmp_path).find(key_of(unit), Powers) is None
    for odd in (lambda: file.symlink_to("/dev/zero"), lambda: os.mkfifo(file), file.mkdir):
        file.unlink()
        odd()
        assert Journal(tmp_path).find(key_of(unit), Powers) is None
    file.rmdir()
    (again,) = computed([unit], Powers, in_turn, Journal(tmp_path), "raising")
    assert again.total == 15.0


SLOW_SWEEP = """
import sys, time
from dataclasses import dataclass
from pathlib import Path
from validation.sweeps.cores import on_cores
from validation.sweeps.journal import Journal
from validation.sweeps.runner import computed

@dataclass(frozen=True)
class Number:
    number: int

@dataclass(frozen=True)
class Slow:
    number: int

    def compute(self):
        time.sleep(0.05 if self.number < 2 else 60.0)
        return Number(self.number)

if __name__ == "__main__":
    units = [Slow(number) for number in range(6)]
    try:
        with on_cores(2) as executor:
            computed(units, Number, executor, Journal(Path(sys.argv[1])), "sleeping")
    except KeyboardInterrupt:
        sys.exit(3)
"""


def test_ctrl_c_ends_all_processes_at_once_and_keeps_what_was_finished(tmp_path):
    script, folder = tmp_path / "slow_sweep.py", tmp_path / "journal"
    script.write_text(SLOW_SWEEP, encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, str(script), str(folder)],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    # Spawned processes import scipy: some seconds on a loaded machine, and a limit for a hang.
    for _ in range(600):
        if len(list(folder.glob("*.npz"))) == 2:
            break
        time.sleep(0.1)
    # As a terminal does: to every process of the group.
    os.killpg(process.pid, signal.SIGINT)
    _, messages = process.communicate(timeout=30)
    assert process.returncode == 3, messages.decode()
    assert messages.decode() == ""
    assert len(list(folder.glob("*.npz"))) == 2
    # Python's own helper process ends a moment after its parent; the sleepers would last a minute.
    assert _gone_within(5.0, process.pid)


def _gone_within(seconds, group):
    for _ in range(round(seconds / 0.1)):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


def test_process_that_is_killed_is_an_error_that_names_the_cause():
    with (
        pytest.raises(ComputationError, match="ended from outside, probably for want of memory"),
        on_cores(1) as executor,
    ):
        list(executor([partial(os._exit, 9)]))
