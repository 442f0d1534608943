"""Optional packages: messages, installation from lock files, and again by the launcher."""

import os
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError
from types import SimpleNamespace

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from fem.extras import EXTRAS
from lumped.errors import ComputationError
from validation.console import extras, locked
from validation.console.extras import NOTE, ROOT

LOCK = """\
# made by a tool
first==1.0 \\
    --hash=sha256:aa \\
    --hash=sha256:ab
    # via sample
second==2.5 ; python_version >= '3' \\
    --hash=sha256:bb
third==3.0 \\
    --hash=sha256:cc
windows==1.0 ; sys_platform == 'win32' \\
    --hash=sha256:dd
"""


@pytest.fixture
def packages(monkeypatch):
    """Made-up installed packages: version and requirements by name."""
    installed = {}

    def distribution(name):
        if name not in installed:
            raise PackageNotFoundError(name)
        version, *requires = installed[name]
        return SimpleNamespace(version=version, requires=requires)

    monkeypatch.setattr(locked, "distribution", distribution)
    return installed


def missing(*requirements):
    return locked.missing_packages(map(Requirement, requirements), locked.locked_packages(LOCK))


def test_missing_dependencies_are_listed(packages):
    """Packages needed by packages, with extras and conditions, that are absent or too old."""
    assert missing("First>=1") == ["first"]
    packages["first"] = ("1.0", "second[more]>2", "windows; sys_platform == 'win32'")
    assert missing("first") == ["second"]
    packages["second"] = ("2.5", "third; extra == 'more'", "lost; extra == 'other'", "first")
    assert missing("first") == ["third"]
    packages["third"] = ("3.0",)
    assert missing("first") == []
    # A version of an earlier set-up, which is not that of the lock.
    packages["third"] = ("2.9",)
    assert missing("first") == ["third"]


@pytest.mark.usefixtures("packages")
@pytest.mark.parametrize("name", ["fourth", "windows"])
def test_package_missing_in_lock_is_named(name):
    """A dependency for which the lock file has no version for this machine."""
    with pytest.raises(ComputationError, match=f"no version of {name} for this machine in req"):
        missing(name)


def test_packages_are_installed_by_hash(packages, monkeypatch, tmp_path):
    """pip gets the lines of the lock file, and no package is installed twice."""
    for lock, content in zip(locked.LOCKS, (LOCK, ""), strict=True):
        (tmp_path / lock).write_text(content)
    project = '[project.optional-dependencies]\nsample = ["first"]\n'
    (tmp_path / "pyproject.toml").write_text(project)
    installed = []

    def run(command, **_):
        content = open(command[-1]).read()  # noqa: PTH123, SIM115
        assert {"--require-hashes", "--no-deps", "--only-binary"} <= set(command)
        installed.append(content)
        packages["first" if "first" in content else "second"] = (
            ("1.0", "second") if "first" in content else ("2.5",)
        )
        return SimpleNamespace(returncode=0)

    monkeypatch.setattr(locked.subprocess, "run", run)
    assert locked.add(tmp_path, ["sample", "sample"]) == ["first", "second"]
    first, second = installed
    assert first == "".join(line + "\n" for line in LOCK.splitlines()[1:5])
    assert second == "".join(line + "\n" for line in LOCK.splitlines()[5:7])
    assert locked.add(tmp_path, ["sample"]) == []
    packages.clear()
    monkeypatch.setattr(locked.subprocess, "run", lambda *_, **__: SimpleNamespace(returncode=1))
    with pytest.raises(ComputationError, match="pip failed to install the packages"):
        locked.add(tmp_path, ["sample"])


def test_lock_has_every_extra():
    """Each requirement of an extra has an allowed version and a hash."""
    project = tomllib.loads((extras.ROOT / locked.PROJECT).read_text("utf-8"))["project"]
    optional = project["optional-dependencies"]
    assert set(EXTRAS) == set(optional) - {"test", "dev"}
    packages = {}
    for lock in locked.LOCKS:
        packages |= locked.locked_packages((extras.ROOT / lock).read_text("utf-8"))
    for name in EXTRAS:
        for requirement in map(Requirement, optional[name]):
            package, lines = packages[canonicalize_name(requirement.name)]
            assert requirement.specifier.contains(next(iter(package.specifier)).version)
            assert "--hash=sha256:" in lines


def test_extras_are_listed_and_names_checked(command, monkeypatch):
    """Outside a virtual environment the message contains the command of pip."""
    lines = command.output("extras").splitlines()
    assert [line.split()[0] for line in lines] == list(EXTRAS)
    message = command.error_line("extras", "nastrn")
    allowed = "must be one of cluster, docs, exudyn, gpu, hammer, nastran"
    assert f'{allowed}; did you mean "nastran"?' in message
    monkeypatch.setattr(sys, "prefix", "/usr")
    assert "pip install '.[hammer]'" in command.error_line("extras", "hammer")


@pytest.mark.parametrize(
    ("module", "words", "message"),
    [
        (
            "pyyeti",
            ("export", "none.toml", "--to", "nastran", "--body", "crank1"),
            "--to nastran: needs pyyeti, not installed; ./flexproof extras nastran adds the extra",
        ),
        (
            "distributed",
            ("run", "none.toml", "--cluster", "tcp://127.0.0.1:9", "--vary", "tool.mass=1:2:2"),
            "--cluster: needs distributed, not installed; ./flexproof extras cluster adds",
        ),
        (
            "distributed",
            (
                *("solve", "none.toml", "--model", "vjm", "--vary", "tool.mass=1:2:2"),
                *("--cluster", "tcp://127.0.0.1:9"),
            ),
            "--cluster: needs distributed, not installed; ./flexproof extras cluster adds",
        ),
    ],
)
def test_missing_extra_is_reported_first(module, words, message, command, monkeypatch):
    """The message precedes that on the robot file, which does not exist."""
    monkeypatch.setitem(sys.modules, module, None)
    assert message in command.error_line(*words)


LAUNCHER = ROOT / "flexproof"
# Answers the launcher's queries, makes environments of itself and logs installations.
PYTHON = """#!/bin/sh
case "$*" in
*realpath*) echo "$STANDIN" ;;
-c*) exit 0 ;;
-) cat >/dev/null ;;
--version) echo "Python 3.11.0" ;;
"-m venv"*)
    rm -rf "$ROOT/.venv" && mkdir -p "$ROOT/.venv/bin" && cp "$STANDIN" "$ROOT/.venv/bin/python"
    printf '#!/bin/sh\\necho "runs $*"\\n' >"$ROOT/.venv/bin/flexproof"
    chmod +x "$ROOT/.venv/bin/flexproof" ;;
*validation.console.locked*) echo "$PWD: $*" >>"$LOG"; exit "${LOCKED:-0}" ;;
*) echo "$*" >>"$LOG" ;;
esac
"""


@pytest.fixture
def start(tmp_path):
    """Function `start(*words, **environment)` that runs the launcher in a new clone.

    It returns the lines of the log.
    """
    root, programs = tmp_path / "clone", tmp_path / "programs"
    root.mkdir()
    programs.mkdir()
    shutil.copy(LAUNCHER, root)
    for name in ("pyproject.toml", "requirements.lock", "requirements-dev.lock"):
        (root / name).write_text(name)
    (programs / "python3").write_text(PYTHON)
    (programs / "python3").chmod(0o755)
    log = tmp_path / "log"

    def run(*words, code=0, **environment):
        log.write_text("")
        path = os.pathsep.join([str(programs), os.environ["PATH"]])
        variables = {"PATH": path, "STANDIN": str(programs / "python3"), "ROOT": str(root)}
        completed = subprocess.run(
            [root / "flexproof", *words],
            env=os.environ | variables | {"LOG": str(log)} | environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert completed.returncode == code, completed.stderr
        run.stderr = completed.stderr
        run.stdout = completed.stdout
        return log.read_text().splitlines()

    run.root = root
    return run


def extras_lines(log):
    """Lines of the log about installed extras, with folder and names."""
    return [line for line in log if "validation.console.locked" in line]


def test_first_setup_installs_no_extras(start):
    """The lock file and flexproof itself; a second start installs nothing."""
    log = start("check", "ifw")
    assert start.stdout == "runs check ifw\n"
    assert any("--require-hashes --requirement" in line for line in log)
    assert any("--editable" in line for line in log)
    assert extras_lines(log) == []
    # A complete environment is not made again.
    assert start("check", "ifw") == []


@pytest.mark.parametrize("later", ["new-recipe", "unfinished", "broken-environment"])
def test_later_setup_reinstalls_extras(start, later):
    """After new lock files, an unfinished set-up or a broken environment."""
    start("check", "ifw")
    environment = start.root / ".venv"
    (environment / NOTE).write_text("hammer\nnastran\n")
    assert start("check", "ifw") == []
    if later == "new-recipe":
        (start.root / "requirements.lock").write_text("other packages")
    elif later == "unfinished":
        (environment / "flexproof-unfinished").touch()
    else:
        (environment / "bin" / "python").unlink()
    command = "-m validation.console.locked . hammer nastran"
    assert extras_lines(start("check", "ifw")) == [f"{start.root}: {command}"]
    assert "adding extras again: hammer nastran" in start.stderr
    assert (environment / NOTE).read_text() == "hammer\nnastran\n"
    assert start.stdout == "runs check ifw\n"
    assert start("check", "ifw") == []


def test_failed_extras_are_retried_at_start(start):
    """The command is not run until they are installed."""
    start("check", "ifw")
    (start.root / ".venv" / NOTE).write_text("hammer\n")
    (start.root / "requirements.lock").write_text("other packages")
    start("check", "ifw", code=3, LOCKED="3")
    assert "extras could not be installed (see above); start again to try again" in start.stderr
    assert start.stdout == ""
    # The stored names survive the environment, which is made anew.
    assert len(extras_lines(start("check", "ifw"))) == 1
    assert start.stdout == "runs check ifw\n"


def test_extras_command_is_passed_on(start):
    """`./flexproof extras` is a command of the program, not of the launcher."""
    start("extras", "hammer")
    assert start.stdout == "runs extras hammer\n"
