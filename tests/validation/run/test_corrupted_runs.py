"""Run folders that were tampered with: what goes on gives the numbers of an undisturbed run.

Bits that flipped, files cut short, exchanged, replaced, or gone: whatever does not hold is computed
again, and what somebody else wrote keeps every byte. Links and pipes: test_run_folder.
"""

import os
import random
import shutil

import pytest
import toy_catalogue as toys
from toy_runs import content, numbers, run_here

from lumped.robot_file import load_robot
from validation.run.files import read_regular
from validation.session import runner
from validation.session.validate import Request, validate

pytestmark = pytest.mark.usefixtures("undrawn")
# What `flexproof test` tries of it, and -m exhaustive besides.
FEW, COUNT = 8, 60
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


def asked(path, **changes):
    return Request(load_robot("ifw"), "quick", path, 1, **changes)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    path = tmp_path_factory.mktemp("undisturbed") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "run", run_here)
        validate(asked(path), toys.disagreeing)
        yield path


def damage(path, chance):
    """One damage to what a run wrote, or something precious put there: what it was."""
    files = sorted(file for file in path.rglob("*") if file.is_file())
    own = [file for file in files if PRECIOUS not in file.read_bytes()]
    # The records matter most.
    weights = [5 if file.suffix == ".jsonl" else 1 for file in own]
    file, other = chance.choices(own, weights, k=2)
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
            place = path / chance.choice(PLACES)
            place.parent.mkdir(exist_ok=True)
            place.write_bytes(b'{"id": "%s"}' % precious)
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
    [*range(FEW), *(pytest.param(k, marks=pytest.mark.exhaustive) for k in range(FEW, COUNT))],
)
def test_a_corrupted_run_goes_on_to_the_same_numbers(undisturbed, tmp_path, seed):
    path = tmp_path / "run"
    shutil.copytree(undisturbed, path)
    mark, records = path / "run.json", path / "results.jsonl"
    sound, chance = mark.read_bytes(), random.Random(seed)  # noqa: S311  any damage will do
    done = [damage(path, chance) for _ in range(chance.randint(1, 3))]
    # One of the two by which a folder is known as a run's always remains.
    if read_regular(mark) != sound and b'", "started"' not in (read_regular(records) or b""):
        if mark.exists():
            mark.rename(mark.with_name("mine"))
        mark.write_bytes(sound)
    before = content(path)
    gathered = validate(asked(path, start="resumed"), toys.disagreeing)
    assert gathered.exit_code() == 1, done
    assert numbers(path) == numbers(undisturbed), done
    after = content(path)
    for name, written in before.items():
        if PRECIOUS in written:
            assert written in after.values(), done
            # Nor is it renamed where the run has nothing to write.
            assert name not in PLACES or after[name] == written, done
