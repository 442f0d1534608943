"""The pytest plugin in a process of its own: what it collects, and what it refuses."""

import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from lumped.robot_file import load_robot

ROOT = Path(__file__).resolve().parents[3]
MODULE = "validation.pytest_plugin"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "mine.toml").write_text(load_robot("ifw").text, encoding="utf-8")
    return tmp_path


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


def test_a_robot_file_is_collected_as_one_item_per_model_and_quantity(folder):
    listed = pytest_in(folder, "--flexproof", "mine.toml", "--collect-only")
    assert "mine.toml::segments.f1" in listed.stdout
    # Eight models by six axes and any force, four frequencies and their order.
    assert listed.stdout.count("mine.toml::") == 96


def test_faults_of_a_file_are_told_without_a_traceback(folder):
    (folder / "mine.toml").write_text("schema = 1\nname = 3\n", encoding="utf-8")
    finished = pytest_in(folder, "--flexproof", "mine.toml")
    assert finished.returncode == 4
    assert "mine.toml: name" in finished.stderr
    assert "Traceback" not in finished.stderr


def test_the_plugin_comes_with_the_distribution():
    declared = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'[project.entry-points.pytest11]\nflexproof = "{MODULE}"' in declared
