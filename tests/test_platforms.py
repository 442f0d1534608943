"""Systems without POSIX modules, gmsh or its libraries: supported and refused commands."""

import subprocess
import sys
from pathlib import Path

import pytest
from support.pages.messages import only_message

from lumped.errors import ComputationError, InputError
from meshes import gmsh_session, processes
from validation.run import folder

ROOT = Path(__file__).resolve().parents[1]
# Libraries are imported before: they have ways of their own on each system.
WITHOUT_POSIX = """
import os, signal, sys
import matplotlib.figure, numpy, scipy.linalg, scipy.sparse, skfem, multiprocessing.connection
import subprocess
missing = {"fcntl", "resource"}
class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name in missing:
            raise ImportError(name)
sys.meta_path.insert(0, Hidden())
for name in missing:
    sys.modules.pop(name, None)
for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "sysconf_names", "sched_getaffinity"):
    delattr(os, name)
for name in ("SIGKILL", "SIGXCPU", "SIGHUP", "SIGPIPE"):
    delattr(signal, name)
"""
USE = """
import flexproof as fp
from lumped.posix import fcntl, resource
assert (fcntl, resource) == (None, None)
import validation.cli
fp.solve("ifw", "beam", modes=1)
fp.converge("ifw", "segments", body="leg1", elements=[5, 10, 20])
assert validation.cli.main(["check", "five-bar"]) == 0
sys.exit(validation.cli.main(["run", "ifw", "--preset", "quick", "--out", "report"]))
"""


def test_only_flexproof_run_needs_posix(tmp_path):
    """Without fcntl and other POSIX modules, all other commands work; `run` names WSL."""
    completed = subprocess.run(
        [sys.executable, "-c", WITHOUT_POSIX + USE],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path / "cache"), "HOME": "/"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 2, completed.stderr
    (line,) = [line for line in completed.stderr.splitlines() if "run:" in line]
    assert "Windows Subsystem for Linux" in line
    assert "Traceback" not in completed.stderr
    assert not list(tmp_path.glob("report*"))


def test_child_process_without_posix_is_refused(monkeypatch):
    """Meshing with limits needs processes of Linux or macOS."""
    monkeypatch.setattr(processes, "_POSIX", False)
    with pytest.raises(ComputationError, match="are available only on Linux and macOS"):
        processes.in_own_process(len, "abc")


def test_run_folder_is_refused_without_locks(monkeypatch, tmp_path):
    """The folder of a run is locked; without file locks no folder is made."""
    monkeypatch.setattr(folder, "fcntl", None)
    with (
        pytest.raises(InputError, match="needs locks of files"),
        folder.open_folder(tmp_path / "run", {}, "afresh"),
    ):
        pass
    assert not list(tmp_path.iterdir())


def test_missing_gmsh_gives_one_error_line(monkeypatch):
    """gmsh has no wheels for Linux on ARM."""
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with (
        pytest.raises(ComputationError, match=r"leg\.step: needs gmsh, which cannot be loaded"),
        gmsh_session.gmsh_model("leg.step"),
    ):
        pass


def test_missing_gmsh_library_names_package(monkeypatch):
    """gmsh raises OSError if a library that it links to is missing."""
    message = "libGLU.so.1: cannot open shared object file"

    class Unloadable:
        @staticmethod
        def find_spec(name, *_):
            if name == "gmsh":
                raise OSError(message)

    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Unloadable, *sys.meta_path])
    with (
        pytest.raises(ComputationError, match=r"libGLU\.so\.1.*packages libgl1 libglu1-mesa "),
        gmsh_session.gmsh_model("leg.step"),
    ):
        pass


WITHOUT_GMSH = """
import sys
import flexproof as fp
import validation.cli
for model in ("vjm", "links", "segments", "beam"):
    fp.solve("five-bar", model)
fp.converge("five-bar", "beam", body="crank1", elements=[5, 10, 20])
assert validation.cli.main(["check", "five-bar"]) == 0
sys.exit(validation.cli.main(["solve", "five-bar", "--model", "solid"]))
"""


def test_only_solids_need_gmsh(tmp_path):
    """Without gmsh, models of beams and segments are solved, and a solid gives one line."""
    hidden = tmp_path / "hidden"
    hidden.mkdir()
    # Worker processes inherit the path.
    (hidden / "gmsh.py").write_text('raise ImportError("hidden")\n', "utf-8")
    path = f"{hidden}:{ROOT}"
    completed = subprocess.run(
        [sys.executable, "-c", WITHOUT_GMSH],
        cwd=tmp_path,
        env={"PYTHONPATH": path, "XDG_CACHE_HOME": str(tmp_path / "cache"), "HOME": "/"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 3, completed.stderr
    assert "needs gmsh, which cannot be loaded" in only_message(completed.stderr)


def test_guide_names_gmsh_and_vtk_packages():
    """The set-up script tests each library; the guide names those that bring all of them."""
    guide = (ROOT / "docs/guide/start.md").read_text("utf-8")
    line = next(candidate for candidate in guide.splitlines() if "apt-get install" in candidate)
    packages = {word for word in line.split() if word.startswith("lib")}
    assert packages == {*gmsh_session.DEBIAN_PACKAGES, "libegl1"}
    script = (ROOT / "flexproof").read_text("utf-8")
    assert all(f'"{package}"' in script for package in packages)
