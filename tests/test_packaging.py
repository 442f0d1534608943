"""Version by tag, contents of wheel and source distribution, and a clean installation of both."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.version import Version

from validation.console.locked import locked_packages

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("lumped", "meshes", "fem", "validation")
BUILD = "import sys; from hatchling import build; print(getattr(build, sys.argv[1])(sys.argv[2]))"


def built(kind, folder, sources=ROOT):
    line = [sys.executable, "-c", BUILD, f"build_{kind}", str(folder)]
    completed = subprocess.run(line, cwd=sources, capture_output=True, text=True, check=True)
    return folder / completed.stdout.split()[-1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return built("wheel", tmp_path_factory.mktemp("wheel"))


def test_wheel_contains_data_and_type_markers(wheel):
    """All sources, built-in robots and py.typed files."""
    names = set(zipfile.ZipFile(wheel).namelist())
    markers = {f"{name}/py.typed" for name in (*PACKAGES, "flexproof")}
    assert {"flexproof/__init__.py", *markers} <= names
    robots = {f"lumped/robots/{file.name}" for file in (ROOT / "lumped/robots").glob("*.toml")}
    assert len(robots) > 5
    assert robots <= names
    files = [file for name in PACKAGES for file in (ROOT / name).rglob("*") if file.is_file()]
    sources = {str(file.relative_to(ROOT)) for file in files if "__pycache__" not in file.parts}
    assert sources <= names


def contents(wheel):
    """Digest of each file in the wheel by name, except the wheel's own list of digests."""
    with zipfile.ZipFile(wheel) as archive:
        infos = [info for info in archive.infolist() if not info.filename.endswith("RECORD")]
        return {info.filename: info.CRC for info in infos}


def test_source_distribution_makes_same_wheel(wheel, tmp_path):
    """It contains all files that tests and site need, and no generated ones."""
    with tarfile.open(built("sdist", tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
        archive.extractall(tmp_path / "sources", filter="data")
    assert {"README.md", "CHANGELOG.md", "docs/conf.py", "tests/test_packaging.py"} <= names
    assert "examples/gallery/plot_01_paper_robot.py" in names
    assert not [name for name in names if name.startswith((".ci", "docs/gallery/", "site/"))]
    (sources,) = (tmp_path / "sources").iterdir()
    assert contents(built("wheel", tmp_path, sources)) == contents(wheel)


def output(*line, folder):
    completed = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=True)
    return completed.stdout.strip()


def test_released_version_is_consistent():
    """Changelog, citation and fallback version contain the same last release.

    The installed version is this release or a later one.
    """
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    headings = re.findall(r"^## (.+)$", changelog, re.MULTILINE)
    released = next(heading for heading in headings if heading != "Unreleased").split()[0]
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.findall(r"^version: (.+)$", citation, re.MULTILINE) == [released]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert project["tool"]["hatch"]["version"]["fallback-version"] == released
    assert Version(version("flexproof")) >= Version(released)


def test_version_comes_from_the_tag(tmp_path):
    """Without git it is the fallback, and without a tag one after the fallback."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)

    def git(*words):
        identity = ("-c", "user.name=test", "-c", "user.email=test@localhost")
        return output("git", *identity, *words, folder=tmp_path)

    def computed():
        return output(sys.executable, "-m", "hatchling", "version", folder=tmp_path)

    fallback = Version(computed())
    assert not fallback.is_devrelease
    git("init", "--quiet")
    git("add", ".")
    git("commit", "--quiet", "--message", "first")
    untagged = Version(computed())
    assert untagged.is_devrelease
    assert untagged > fallback
    git("tag", "v7.8.9")
    assert computed() == "7.8.9"
    git("commit", "--quiet", "--allow-empty", "--message", "second")
    assert computed().partition("+")[0] == "7.8.10.dev1"
    assert git("rev-parse", "HEAD").startswith(computed().partition("+g")[2])


def test_launcher_and_guide_state_equal_sizes():
    """Sizes measured with `pip download` of both lock files and `du` of both environments."""
    launcher = (ROOT / "flexproof").read_text("utf-8")
    sizes = re.findall(r'size="(\d+ MB, [\d.]+ GB on disk)"', launcher)
    assert len(set(sizes)) == 2
    guide = (ROOT / "docs/guide/start.md").read_text("utf-8")
    assert re.findall(r"\d+ MB, [\d.]+ GB on disk", guide) == sizes


def test_module_flexproof_is_that_of_clone(tmp_path):
    """The imported module is the file of this clone, not a copy in the environment."""
    line = (sys.executable, "-c", "import flexproof; print(flexproof.__file__)")
    assert output(*line, folder=tmp_path) == str(ROOT / "flexproof.py")


# Imports every module and prints their number.
IMPORT_ALL = """
import importlib, pkgutil
modules = []
for name in ("lumped", "meshes", "fem", "validation"):
    package = importlib.import_module(name)
    modules += [module.name for module in pkgutil.walk_packages(package.__path__, f"{name}.")]
for module in modules:
    importlib.import_module(module)
print(len(modules))
"""


@pytest.mark.install
@pytest.mark.parametrize("name", ["python3.11", "python3.12", "python3.13"])
def test_clean_installation_runs(name, wheel, tmp_path):
    """An empty environment, the packages of requirements.lock, then sdist and wheel in turn."""
    if subprocess.run([name, "-c", "import venv"], capture_output=True, check=False).returncode:
        pytest.skip(f"{name} is not installed here")
    output(name, "-m", "venv", "env", folder=tmp_path)
    python, command = (
        str(tmp_path / "env" / "bin" / program) for program in ("python", "flexproof")
    )
    pip = (python, "-m", "pip", "--disable-pip-version-check", "install", "--quiet")
    pip += ("--no-deps", "--no-compile")
    locked = ("--only-binary", ":all:", "--require-hashes", "--requirement")
    output(*pip, *locked, str(ROOT / "requirements.lock"), folder=tmp_path)
    environment = os.environ | {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    environment.pop("PYTHONPATH", None)

    def outcome(*line):
        return subprocess.run(
            line, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )

    source = built("sdist", tmp_path)
    for distribution in (source, wheel):
        alone = ("--no-index", "--no-build-isolation", "--force-reinstall", str(distribution))
        output(*pip, *alone, folder=tmp_path)
        number = distribution.name.split("-")[1].removesuffix(".tar.gz")
        assert outcome(command, "--version").stdout.startswith(f"{number}, ")
    run = outcome(command, "run", "ifw", "--preset", "quick", "--only", "leg1.converged?beam*")
    assert run.returncode == 0, run.stderr
    assert "agree" in run.stdout
    assert f"flexproof {number}" in (tmp_path / "report" / "report.html").read_text("utf-8")
    for kind in ("biglide", "five-bar", "delta", "hexapod"):
        created = outcome(command, "new", f"{kind}.toml", "--type", kind)
        assert created.returncode == 0, created.stderr
        assert outcome(command, "check", f"{kind}.toml").returncode == 0
    public = "import flexproof as fp; print(fp.__file__, fp.solve('ifw', 'vjm').table())"
    solved = outcome(python, "-c", public)
    assert str(tmp_path / "env") in solved.stdout, solved.stderr
    assert "x (m/N)" in solved.stdout
    packages = locked_packages((ROOT / "requirements-dev.lock").read_text("utf-8"))
    needed = ("pytest", "iniconfig", "packaging", "pluggy", "pygments")
    (tmp_path / "pytest.lock").write_text(
        "".join(packages[package][1] for package in needed), "utf-8"
    )
    output(*pip, *locked, "pytest.lock", folder=tmp_path)
    plugin = outcome(python, "-m", "pytest", "--help")
    assert "--flexproof" in plugin.stdout, plugin.stderr
    imported = outcome(python, "-c", IMPORT_ALL)
    assert imported.returncode == 0, imported.stderr
    assert int(imported.stdout) > 300
    refused = outcome(command, "docs")
    assert refused.returncode == 2
    assert "in a clone of the sources" in refused.stderr
