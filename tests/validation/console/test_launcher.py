"""The launcher with a stand-in for Python: later set-ups install the extras again."""

import os
import shutil
import subprocess

import pytest

from validation.console.extras import NOTE, ROOT

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
