"""The built distribution: installed in an environment of its own, it runs, with all of its data."""

import os
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("lumped", "meshes", "fem", "validation")
BUILD = "import sys; from hatchling import build; print(getattr(build, sys.argv[1])(sys.argv[2]))"


def built(kind, folder, sources=ROOT):
    line = [sys.executable, "-c", BUILD, f"build_{kind}", str(folder)]
    done = subprocess.run(line, cwd=sources, capture_output=True, text=True, check=True)
    return folder / done.stdout.split()[-1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return built("wheel", tmp_path_factory.mktemp("wheel"))


def test_wheel_contains_data_and_type_markers(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {"flexproof.py", *(f"{name}/py.typed" for name in PACKAGES)} <= names
    robots = {f"lumped/robots/{file.name}" for file in (ROOT / "lumped/robots").glob("*.toml")}
    assert len(robots) > 5
    assert robots <= names
    files = [file for name in PACKAGES for file in (ROOT / name).rglob("*") if file.is_file()]
    sources = {str(file.relative_to(ROOT)) for file in files if "__pycache__" not in file.parts}
    assert sources <= names


def contents(wheel):
    """Digest of each file by name, without the list of all digests."""
    with zipfile.ZipFile(wheel) as archive:
        infos = [one for one in archive.infolist() if not one.filename.endswith("RECORD")]
        return {one.filename: one.CRC for one in infos}


def test_source_distribution_makes_the_same_wheel(wheel, tmp_path):
    """It contains what tests and site need, and nothing that was generated."""
    with tarfile.open(built("sdist", tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
        archive.extractall(tmp_path / "sources", filter="data")
    assert {"README.md", "CHANGELOG.md", "docs/conf.py", "tests/test_packaging.py"} <= names
    assert "examples/gallery/plot_01_paper_robot.py" in names
    assert not [name for name in names if name.startswith((".ci", "docs/gallery/", "site/"))]
    (sources,) = (tmp_path / "sources").iterdir()
    assert contents(built("wheel", tmp_path, sources)) == contents(wheel)


@pytest.mark.exhaustive
def test_installed_wheel_runs_and_offers_the_plugin(wheel, tmp_path):
    """Dependencies come from this environment; flexproof itself from the wheel alone."""
    venv.create(tmp_path / "env", with_pip=True)
    python = tmp_path / "env" / "bin" / "python"
    pip = [python, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet", wheel]
    subprocess.run(pip, check=True, capture_output=True)
    site = next((tmp_path / "env" / "lib").glob("python3*/site-packages"))
    here = next(Path(sys.prefix, "lib").glob("python3*/site-packages"))
    # A path file of this environment would make the sources importable.
    dependencies = tmp_path / "dependencies"
    dependencies.mkdir()
    for entry in here.iterdir():
        if "flexproof" not in entry.name and entry.suffix != ".pth":
            (dependencies / entry.name).symlink_to(entry)
    (site / "dependencies.pth").write_text(f"{dependencies}\n", "utf-8")
    environment = os.environ | {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}

    def outcome(*line):
        return subprocess.run(
            line, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )

    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    command = tmp_path / "env" / "bin" / "flexproof"
    assert version in outcome(command, "--version").stdout
    run = outcome(command, "run", "ifw", "--preset", "quick")
    assert run.returncode == 0, run.stderr
    assert "agree" in run.stdout
    assert "<h1" in (tmp_path / "report" / "report.html").read_text("utf-8")
    for kind in ("biglide", "five-bar", "delta", "hexapod"):
        made = outcome(command, "new", f"{kind}.toml", "--type", kind)
        assert made.returncode == 0, made.stderr
        assert outcome(command, "check", f"{kind}.toml").returncode == 0
    public = "import flexproof as fp; print(fp.__file__, fp.solve('ifw', 'vjm').table())"
    solved = outcome(python, "-c", public)
    assert str(site) in solved.stdout, solved.stderr
    assert "x (m/N)" in solved.stdout
    plugin = outcome(python, "-m", "pytest", "--help")
    assert "--flexproof" in plugin.stdout, plugin.stderr
    refused = outcome(command, "docs")
    assert refused.returncode == 2
    assert "in a clone of the sources" in refused.stderr
