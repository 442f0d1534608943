"""Run folders that were tampered with: what goes on gives the numbers of an undisturbed run.

Bits that flipped, files cut short, exchanged, replaced, or gone: whatever does not hold is computed
again, and what somebody else wrote keeps every byte. Links and pipes: test_run_folder.
"""

import os
import random
import shutil
from pathlib import Path

import pytest
import toy_catalogue as toys
from toy_runs import content, numbers, run_here

from lumped.robot_file import load_robot
from validation.run.files import read_regular
from validation.session import runner
from validation.session.validate import Request, validate

# What `flexproof test` tries of it, and -m exhaustive besides.
FEW, SOME, COUNT = 8, 34, 60
ODD = (
    *("", "[]", "5", "{}", "null", "\x00", "[" * 50_000),
    *('{"seal": "', '{"run": 5}', '{"schema": 1, "run": [], "cases": {}}'),
    '{"id": "toy.agrees", "verdict": "agree"}',
)
PLACES = (
    *("records/other.json", "figures/thesis.png", "notes.json"),
    *("export/precious.dat", "figures.kept/precious", ".results.json.tmp"),
)


@pytest.fixture(autouse=True, scope="module")
def without_workers():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "run", run_here)
        yield


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    path = tmp_path_factory.mktemp("undisturbed") / "run"
    validate(Request(load_robot("ifw"), "quick", path, 1), toys.disagreeing)
    return path


class Vandal:
    """Damages a run folder by chance; `foreign` are the bytes that are not the run's to change."""

    def __init__(self, path: Path, seed: int) -> None:
        self.path = path
        self.chance = random.Random(seed)  # noqa: S311  any damage will do
        self.foreign: list[bytes] = []

    def file(self, pattern="*"):
        """A file of the run."""
        files = sorted(
            file
            for file in self.path.rglob(pattern)
            if file.is_file() and not self.holds_treasure(file)
        )
        return self.chance.choice(files)

    def holds_treasure(self, file):
        """Whether damage to the file would be the test's own."""
        return any(treasure in file.read_bytes() for treasure in self.foreign)

    def treasure(self):
        """Bytes that occur nowhere else."""
        self.foreign.append(self.chance.randbytes(32).hex().encode())
        return self.foreign[-1]

    def flips_a_bit(self):
        file = self.file()
        data = bytearray(file.read_bytes() or b"0")
        data[self.chance.randrange(len(data))] ^= 1 << self.chance.randrange(8)
        file.write_bytes(data)

    def cuts_short(self):
        file = self.file()
        os.truncate(file, self.chance.randrange(file.stat().st_size + 1))

    def exchanges_files(self):
        one, two = self.file(), self.file()
        first, second = one.read_bytes(), two.read_bytes()
        one.write_bytes(second), two.write_bytes(first)

    def edits_a_number(self):
        file = self.file("*.json*")
        file.write_text(file.read_text().replace("0.33333", "12345.0").replace("1.84", "1.0"))

    def leaves_odd_json(self):
        self.file().write_text(self.chance.choice(ODD))

    def adds_foreign_json(self):
        name = self.chance.choice(PLACES)
        (self.path / name).parent.mkdir(exist_ok=True)
        (self.path / name).write_bytes(b'{"id": "%s"}' % self.treasure())

    def puts_foreign_data_in_place(self):
        self.file().write_bytes(self.treasure())

    def removes_a_file(self):
        self.file().unlink()

    def removes_a_folder(self):
        for file in (self.path / "figures").rglob("*"):
            if file.is_file() and not self.holds_treasure(file):
                file.unlink()

    def repeats_a_line(self):
        file = self.file("*.jsonl")
        lines = file.read_bytes().splitlines(keepends=True)
        file.write_bytes(b"".join(self.chance.choices(lines, k=len(lines))) if lines else b"")

    def strikes(self):
        """Damage of one to three kinds; one of the two marks of the folder always remains."""
        done = self.chance.choices(KINDS, k=self.chance.randint(1, 3))
        mark, records = (self.path / name for name in ("run.json", "results.jsonl"))
        sound = mark.read_bytes()
        for kind in done:
            kind(self)
        if read_regular(mark) != sound and b'", "started"' not in (read_regular(records) or b""):
            if mark.exists():
                mark.rename(mark.with_name("mine"))
            mark.write_bytes(sound)
        return done


KINDS = [
    *(Vandal.flips_a_bit, Vandal.cuts_short, Vandal.exchanges_files, Vandal.edits_a_number),
    *(Vandal.leaves_odd_json, Vandal.adds_foreign_json, Vandal.puts_foreign_data_in_place),
    *(Vandal.removes_a_file, Vandal.removes_a_folder, Vandal.repeats_a_line),
]


@pytest.mark.parametrize(
    "seed",
    [
        *range(FEW),
        *(pytest.param(k, marks=pytest.mark.exhaustive) for k in range(FEW, SOME)),
        *(pytest.param(k, marks=pytest.mark.soak) for k in range(SOME, COUNT)),
    ],
)
def test_a_corrupted_run_goes_on_to_the_same_numbers(undisturbed, tmp_path, seed):
    path = tmp_path / "run"
    shutil.copytree(undisturbed, path)
    vandal = Vandal(path, seed)
    done = vandal.strikes()
    placed = {file: file.read_bytes() for place in PLACES if (file := path / place).is_file()}
    request = Request(load_robot("ifw"), "quick", path, 1, start="resumed")
    gathered = validate(request, toys.disagreeing)
    assert gathered.exit_code() == 1, done
    assert numbers(path) == numbers(undisturbed), done
    there = content(path).values()
    for treasure in vandal.foreign:
        assert any(treasure in written for written in there), done
    # What was put where the run has nothing to write is still there under its own name.
    assert {file: file.read_bytes() for file in placed} == placed, done
