"""The command line: exit codes, one clear line per fault, results on stdout, nothing else."""

import errno
import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.fakes import toy_catalogue as toys
from support.fakes.toy_runs import refusing, run_in_this_process

from lumped.errors import ProgramError
from lumped.files import os_errors_as_store_errors
from validation import cli
from validation.console import streams
from validation.run import runner
from validation.run.folder import RunFolder

pytestmark = pytest.mark.usefixtures("blank_charts")
ROOT = Path(__file__).parents[3]
HEAVY = ("gmsh", "pyvista", "vtk", "skfem", "matplotlib", "scipy", "numpy", "jinja2")


@pytest.fixture
def with_catalogue(monkeypatch):
    """Function that replaces the tasks of `run` by a made-up `catalogue`, run in this process.

    `run` is another function that runs them, for example on workers.
    """

    def use(catalogue, run=run_in_this_process):
        monkeypatch.setattr(runner, "run", run)
        cases = SimpleNamespace(catalogue=catalogue)
        monkeypatch.setitem(sys.modules, "validation.catalogue", cases)

    return use


def test_run_prints_verdict_and_report(with_catalogue, tmp_path, capsys):
    """Verdict and path of the report on stdout, omitted figures on stderr."""
    with_catalogue(toys.sound, runner.run)
    assert cli.main(["run", "--out", str(tmp_path / "out"), "--jobs", "2"]) == 0
    printed = capsys.readouterr()
    assert "All 3 comparisons agree, 1 skipped." in printed.out
    assert printed.out.rstrip().endswith(str(tmp_path / "out" / "report.html"))
    # A slow machine prints lines of progress, too.
    assert "flexproof: figure toy.undrawn left out: no OpenGL" in printed.err.splitlines()


def test_quiet_run_requests_no_progress(with_catalogue, tmp_path):
    """--quiet suppresses progress for one command only: the next run reports it again."""
    are_quiet = []

    def catalogue(robot_file):
        are_quiet.append(streams.is_quiet())
        return toys.sound(robot_file)

    with_catalogue(catalogue)
    for options in ((), ("--quiet",), ()):
        assert cli.main(["run", "--out", str(tmp_path / f"{len(are_quiet)}"), *options]) == 0
    assert are_quiet == [False, True, False]


def test_cases_are_listed_as_text_and_json(with_catalogue, command):
    """`flexproof cases`: id, kind, source and tolerance."""
    with_catalogue(toys.sound)
    assert "closed-form: made up" in command.output("cases")
    listed = command.json("cases")
    assert [entry["id"] for entry in listed][:2] == ["toy.agrees", "toy.first[x=1]"]
    assert listed[0]["tolerance"] == 0.1


def test_audit_of_robot_is_printed(command):
    """`flexproof check ifw`: doubts about the data that are used, then misprints of the paper."""
    used, errata = command.output("check", "ifw").split(
        "misprints and errors of the printed source"
    )
    assert used.startswith("ifw: valid, 4 doubts; IFW demonstrator")
    # The signs of the couplings are used as printed, the foot's rotation is not.
    assert "leg1.compliance (warning, couplings)" in used
    assert "foot.compliance" not in used
    assert "foot.compliance (error" in errata


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "--preset", "quik"], 'Did you mean "quick"'),
        (["run", "--presett", "quick"], "Did you mean --preset"),
        (["run", "--jobs", "0"], "Must be a whole number"),
        (["run", "--jobs", "1.5"], "Must be a whole number"),
        (["run", "ifw", "extra"], "unknown arguments: extra"),
        (["run", "--only", "toy.agree"], 'did you mean "toy.agrees"'),
        (["run", "--only", "nonsense"], "'flexproof cases' lists them"),
        (["run", "--only", "toy.fig*"], '"toy.fig*" matches figures alone, and nothing would be'),
        (["compare", "x" * 5000, "y"], 'xxx…": File name too long.'),
        (["run", "--out", "/dev/null/report"], "cannot write there"),
        (["run", "--resume"], "contains no run that can be resumed"),
        (["rum"], 'Did you mean "run"'),
        (["check", "missing.toml"], "missing.toml"),
        (["new", "/dev/null/robot.toml"], "cannot be written"),
        (["faces", "nothing.step"], "no such file"),
        (["export", "five-bar", "--to", "nastran"], "exports one body"),
        (
            ["export", "five-bar", "--to", "statespace", "--body", "crank1"],
            "exports the whole robot",
        ),
        (["export", "five-bar", "--to", "npz", "--body", "no"], "must be one of"),
        (["export", "five-bar", "--to", "npz", "--out", "five-bar.toml"], "must end in .npz"),
        (["export", "five-bar", "--to", "npz", "--modes", "0"], "must be from 1 to"),
        (
            ["export", "ifw", "--to", "npz", "--body", "leg1"],
            "is a leg specified by its 6×6 compliance",
        ),
        (["kinematics", "five-bar", "--pose=0.7,0.9"], "y = 0.9 m: cannot be reached: joint"),
        (["kinematics", "five-bar", "--pose=1e300,0"], "must be 2 finite numbers up to 100 m or"),
    ],
)
def test_wrong_input_exits_with_2(
    arguments, message, with_catalogue, tmp_path, monkeypatch, command
):
    """Misspelt options, values and files: one line with a suggestion, and no files."""
    with_catalogue(toys.sound)
    monkeypatch.chdir(tmp_path)
    assert message in command.error_line(*arguments)
    files = {entry.name for entry in tmp_path.rglob("*")}
    assert files <= {"report", ".lock"}


def test_full_disk_exits_with_3(with_catalogue, tmp_path, monkeypatch, capsys):
    """The message contains the command that continues the run, with all its options."""
    with_catalogue(toys.sound)
    # Of what is kept, not of what is found out beforehand.
    monkeypatch.setattr(
        RunFolder, "keep", os_errors_as_store_errors(tmp_path)(refusing(errno.ENOSPC))
    )
    out, values = tmp_path / "run", tmp_path / "my values.csv"
    values.write_text("quantity,pose,value,uncertainty,source\nf1,0.4975,80.0,0.1,rig\n")
    options = ["--accept", "x=0.1", "--measured", str(values)]
    assert cli.main(["run", *options, "--out", str(out)]) == 3
    printed = capsys.readouterr().err
    assert "No space left" in printed
    expected = f"flexproof run ifw --preset standard --accept x=0.1 --measured '{values}'"
    assert f"{expected} --out {out} --resume" in printed


def test_system_error_is_one_line(tmp_path, monkeypatch, capsys):
    """The system has too many open files to start a process."""
    monkeypatch.setattr("meshes.processes.Process.__init__", refusing(errno.EMFILE))
    # A file of its own: what is known of others is not read again.
    part = tmp_path / "rocker.step"
    part.write_bytes((ROOT / "examples/rocker/rocker.step").read_bytes() + b"\n")
    assert cli.main(["faces", str(part)]) == 3
    assert capsys.readouterr() == (
        "",
        "flexproof: the operating system reports: Too many open files\n",
    )


def test_help_imports_no_heavy_module():
    """`flexproof --help` imports neither SciPy, gmsh nor matplotlib."""
    program = (
        "import sys; from validation.cli import main; code = main(['--help']);"
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules];"
        "sys.stderr.write(' '.join(loaded)); sys.exit(code)"
    )
    line = [sys.executable, "-c", program]
    completed = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (completed.returncode, completed.stderr) == (0, "")
    assert "run" in completed.stdout


def test_worse_verdict_than_baseline_exits_1(with_catalogue, tmp_path, command):
    """Worse, drifted, new and removed cases are counted and listed."""
    with_catalogue(toys.sound)
    first = tmp_path / "first"
    command.output("run", "--out", first)
    # The earlier run knew a case that agreed and is now skipped, and another value.
    earlier = json.loads((first / "results.json").read_text())
    by_id = {case["id"]: case for case in earlier["cases"]}
    by_id["toy.skipped"]["verdict"] = "agree"
    by_id["toy.agrees"]["value"] = 0.25
    baseline = tmp_path / "baseline.json"
    baseline.write_text(json.dumps(earlier))
    out = tmp_path / "second"
    output = command.output("run", "--out", out, "--baseline", baseline, code=1)
    # For example, because CalculiX was uninstalled: the skipped comparison is a warning.
    assert "skipped in this run: toy.skipped." in (out / "report.html").read_text(encoding="utf-8")
    assert "warning: comparison toy.skipped agreed in the baseline" in output
    assert "1 verdict worse, 0 better, 1 case drifted, 0 new, 0 removed." in output
    # A part of the run is compared with that part of the baseline.
    words = ["run", "--only", "toy.agrees", "--out", out, "--baseline", baseline]
    assert "0 new, 0 removed." in command.output(*words)
    (entry,) = json.loads((out / "results.json").read_text())["cases"]
    assert (entry["verdict"], entry["earlier"]) == ("agree", 0.25)
    assert entry["drift"] == pytest.approx(1.0 / 3.0 - 0.25, rel=1e-12)


def test_export_is_in_run_folder(with_catalogue, tmp_path, monkeypatch, command):
    """A later run without --export removes the exported files."""
    with_catalogue(toys.sound)
    monkeypatch.setattr(
        "validation.export.files.export_mechanism",
        lambda mechanism, preset, folder: (folder / f"{mechanism.name} {preset}.vtu").touch(),
    )
    words = ["run", "--only", "toy.agrees", "--preset", "quick", "--out", tmp_path]
    command.output(*words, "--export")
    assert (tmp_path / "export" / "IFW demonstrator quick.vtu").exists()
    assert not (tmp_path / ".export.tmp").exists()
    command.output(*words)
    assert not (tmp_path / "export").exists()


def test_program_error_of_process_has_traceback(monkeypatch, capsys):
    """A traceback of another process arrives as lines of text, which are all printed."""

    def broken(_name):
        raise ProgramError("leg 2: KeyError: 3", ["Traceback", "in postures"])

    monkeypatch.setattr("lumped.robot_file.load_robot", broken)
    assert cli.main(["check", "ifw"]) == 3
    lines = capsys.readouterr().err.splitlines()
    assert lines[:3] == [
        f"flexproof: {line}" for line in ("Traceback", "in postures", "leg 2: KeyError: 3")
    ]
    assert "this is an error in flexproof itself" in lines[3]


def test_program_error_is_not_disagreement(with_catalogue, tmp_path, monkeypatch, capsys):
    """Exit code 3, not 1; results computed so far are kept."""

    def broken(*_arguments):
        raise RuntimeError("no template")

    with_catalogue(toys.sound)
    monkeypatch.setattr("validation.validate.render", broken)
    assert cli.main(["run", "--only", "toy.agrees", "--out", str(tmp_path / "run")]) == 3
    printed = capsys.readouterr().err
    assert "no template" in printed
    assert printed.splitlines()[-1].startswith("flexproof: this is an error in flexproof itself")
    assert (tmp_path / "run.partial" / "results.json").exists()
