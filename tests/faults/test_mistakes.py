"""Mistakes put into a copy of the sources, one at a time, must fail the nearest tests.

    ./flexproof test -m faults                              all of mistakes.toml, half an hour
    ./flexproof test -m faults -k "shear or drive"          some of them
    FAULTS_AGAINST=validation ./flexproof test -m faults    tests/validation in place of the nearest

A test passes if its mistake is noticed. If a line of the sources that mistakes.toml quotes is
changed, the quotation must be changed, too, as a quick test checks.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("lumped", "meshes", "fem", "validation")
# A mistake for which a loop never ends is noticed by whoever waits.
PATIENCE = 900.0


class Mistake(NamedTuple):
    name: str
    file: str
    text: str
    instead: str
    nearest: tuple[str, ...]


def table() -> list[Mistake]:
    by_file = tomllib.loads(Path(__file__).with_name("mistakes.toml").read_text(encoding="utf-8"))
    return [
        Mistake(name, file, *change, tuple(entries["nearest"]))
        for file, entries in by_file.items()
        for name, change in entries.items()
        if name != "nearest"
    ]


MISTAKES = table()


@cache
def first_failure(nearest: tuple[str, ...], mistake: Mistake | None = None) -> str | None:
    """The first of the `nearest` tests that fails in a copy with the mistake; None if all pass."""
    with TemporaryDirectory(prefix="flexproof-faults-") as folder:
        copy = Path(folder) / "copy"
        for name in (*PACKAGES, "tests", "docs", "examples"):
            shutil.copytree(ROOT / name, copy / name)
        for name in ("pyproject.toml", "README.md"):
            shutil.copy2(ROOT / name, copy)
        if mistake is not None:
            file = copy / mistake.file
            faulty = file.read_text(encoding="utf-8").replace(mistake.text, mistake.instead)
            file.write_text(faulty, encoding="utf-8")
        env = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST_", "FLEXPROOF_"))}
        # Before what is installed: also the processes that tests start take the copy.
        env |= {"PYTHONPATH": str(copy), "HOME": folder, "XDG_CACHE_HOME": folder}
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
        try:
            completed = subprocess.run(
                [*command, *(f"tests/{path}" for path in nearest)],
                check=False,
                cwd=copy,
                env=env,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )
        except subprocess.TimeoutExpired:
            return f"no end in {PATIENCE:g} s"
    # What cannot be collected has been noticed, too; anything else is no answer.
    assert completed.returncode in {0, 1, 2}, completed.stdout[-2000:] + completed.stderr[-2000:]
    failure = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - |$)", completed.stdout, re.MULTILINE)
    assert (completed.returncode == 0) is (failure is None), completed.stdout[-2000:]
    return failure and failure[1]


def test_mistakes_quote_unique_lines():
    """Each mistake of mistakes.toml quotes a line that occurs once, and tests that exist."""
    assert len({mistake.name for mistake in MISTAKES}) == len(MISTAKES) >= 70
    assert {mistake.file.split("/")[0] for mistake in MISTAKES} == set(PACKAGES)
    for mistake in MISTAKES:
        source = (ROOT / mistake.file).read_text(encoding="utf-8")
        assert source.count(mistake.text) == 1, (
            f"{mistake.name}: {mistake.text!r} in {mistake.file}"
        )
        compile(source.replace(mistake.text, mistake.instead), mistake.file, "exec")
        missing = [test for test in mistake.nearest if not (ROOT / "tests" / test).exists()]
        assert not missing, mistake.name


@pytest.mark.faults
@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_nearest_tests_fail_for_mistake(mistake):
    """Each mistake makes a test of its `nearest` files fail; without it these tests pass."""
    against = os.environ.get("FAULTS_AGAINST")
    nearest = (against,) if against else mistake.nearest
    assert first_failure(nearest, mistake), f"{mistake.instead!r} is noticed by none"
    # The same without a mistake, once in a process.
    assert first_failure(nearest) is None
