"""The pytest plugin, in a pytest of its own: the fixture, and robot files as tests."""

import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MODULE = "validation.pytest_plugin"
SUITE = """
def test_holds(flexproof):
    flexproof("mine.toml").assert_adequate("vjm", "x")

def test_holds_by_another_limit(flexproof):
    flexproof("mine.toml", accept={"z": 0.99}).assert_adequate("simplified", "y", within=0.99)

def test_does_not_hold(flexproof):
    flexproof("mine.toml").assert_adequate("simplified", "y")
"""


def robot_in(folder):
    folder.mkdir(exist_ok=True)
    text = (ROOT / "lumped" / "robots" / "ifw.toml").read_text(encoding="utf-8")
    (folder / "mine.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def folder(tmp_path):
    return robot_in(tmp_path)


def pytest_in(folder, *arguments):
    # An environment set up before the plugin was there knows it by its module alone.
    known = any(one.value == MODULE for one in entry_points(group="pytest11"))
    named = [] if known else ["-p", MODULE]
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "-rA", *named]
    return subprocess.run(
        [*command, "--flexproof-preset", "quick", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A test file that asks the fixture, and a robot file as tests, in one session."""
    folder = robot_in(tmp_path_factory.mktemp("judged"))
    suite = robot_in(folder / "suite")
    (suite / "test_mine.py").write_text(SUITE, encoding="utf-8")
    asked = "vjm. or simplified.z or simplified.y or (segments.f1 and not euler) or test_mine"
    return pytest_in(folder, "--flexproof", "mine.toml", "-k", asked, "suite")


def test_the_fixture_judges_robots_beside_the_test(finished):
    assert finished.returncode == 1, finished.stdout + finished.stderr
    for name in ("test_holds", "test_holds_by_another_limit"):
        assert f"PASSED suite/test_mine.py::{name}\n" in finished.stdout
    assert "FAILED suite/test_mine.py::test_does_not_hold - AssertionError" in finished.stdout
    assert re.search(r"simplified, y: inadequate; error [1-9]", finished.stdout)
    assert "along the load −" in finished.stdout


def test_a_robot_file_is_collected_as_one_item_per_model_and_quantity(folder, finished):
    listed = pytest_in(folder, "--flexproof", "mine.toml", "--collect-only")
    assert "mine.toml::segments.f1" in listed.stdout
    # Eight models by six axes and any force, four frequencies and their order.
    assert listed.stdout.count("mine.toml::") == 96
    assert "PASSED mine.toml::vjm.x" in finished.stdout
    assert "FAILED mine.toml::simplified.z" in finished.stdout
    assert re.search(r"SKIPPED .*vjm says nothing of f1", finished.stdout)
    assert "Traceback" not in finished.stdout


def test_faults_of_a_file_are_told_without_a_traceback(folder):
    (folder / "mine.toml").write_text("schema = 1\nname = 3\n", encoding="utf-8")
    finished = pytest_in(folder, "--flexproof", "mine.toml")
    assert finished.returncode == 4
    assert "mine.toml: name" in finished.stderr
    assert "Traceback" not in finished.stderr


def test_the_plugin_comes_with_the_distribution():
    declared = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'[project.entry-points.pytest11]\nflexproof = "{MODULE}"' in declared
