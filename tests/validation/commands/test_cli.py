"""The command line: exit codes, one clear line per fault, results on stdout, nothing else."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
import toy_catalogue as toys
from toy_runs import run_here

from validation import cli
from validation.session import runner

ROOT = Path(__file__).parents[3]
HEAVY = ("gmsh", "pyvista", "vtk", "skfem", "matplotlib", "scipy", "numpy", "jinja2")


@pytest.fixture
def with_catalogue(monkeypatch):
    """Made-up tasks, computed here and not by workers but where those are wanted."""

    def use(catalogue, by=run_here):
        monkeypatch.setattr(runner, "run", by)
        cases = ModuleType("validation.catalogue")
        cases.catalogue = catalogue
        monkeypatch.setitem(sys.modules, "validation.catalogue", cases)

    return use


def test_a_run_prints_its_verdict_and_where_the_report_is(with_catalogue, tmp_path, capsys):
    with_catalogue(toys.sound, runner.run)
    assert cli.main(["run", "--out", str(tmp_path / "out"), "--jobs", "2"]) == 0
    printed = capsys.readouterr()
    assert "All 3 comparisons agree, 1 skipped." in printed.out
    assert printed.out.rstrip().endswith(str(tmp_path / "out" / "report.html"))
    assert printed.err == "flexproof: figure toy.undrawn left out: no OpenGL\n"


def test_cases_are_listed_as_text_and_as_json(with_catalogue, capsys):
    with_catalogue(toys.sound)
    assert cli.main(["cases"]) == 0
    assert "closed-form: made up" in capsys.readouterr().out
    assert cli.main(["cases", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [entry["id"] for entry in listed][:2] == ["toy.agrees", "toy.first[x=1]"]
    assert listed[0]["tolerance"] == 0.1


def test_a_new_robot_file_is_sound_and_no_file_is_overwritten(tmp_path, capsys):
    path = tmp_path / "a\nforged.toml"
    assert cli.main(["new", str(path)]) == 0
    content = path.read_bytes()
    (line,) = capsys.readouterr().out.splitlines()
    assert "a\\nforged.toml written" in line
    assert cli.main(["check", str(path)]) == 0
    capsys.readouterr()
    assert cli.main(["new", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_bytes() == content


def test_the_audit_of_the_built_in_robot_is_shown(capsys):
    assert cli.main(["check", "ifw"]) == 0
    used, errata = capsys.readouterr().out.split("misprints and errors of the source")
    assert used.startswith("ifw: sound in form, 4 doubts; IFW demonstrator")
    # The signs of the couplings are used as printed, the foot's rotation is not.
    assert "leg1.compliance (warning, couplings)" in used
    assert "foot.compliance" not in used
    assert "foot.compliance (error" in errata


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "--preset", "quik"], 'Did you mean "quick"'),
        (["run", "--presett", "quick"], "Did you mean --preset"),
        (["run", "--jobs", "0"], "Must be a whole number"),
        (["run", "--jobs", "1.5"], "Must be a whole number"),
        (["run", "ifw", "extra"], "not understood: extra"),
        (["run", "--only", "toy.agree"], 'did you mean "toy.agrees"'),
        (["run", "--only", "nonsense"], "'flexproof cases' lists them"),
        (["run", "--only", "toy.fig*"], '"toy.fig*" matches figures alone, and nothing would be'),
        (["compare", "x" * 5000, "y"], 'xxx…": File name too long.'),
        (["run", "--out", "/dev/null/report"], "cannot write there"),
        (["run", "--resume"], "no run to go on with"),
        (["rum"], 'Did you mean "run"'),
        (["check", "/nonexistent.toml"], "/nonexistent.toml"),
        (["new", "/nonexistent/robot.toml"], "cannot be written"),
        (["faces", "nothing.step"], "no such file"),
    ],
)
def test_wrong_input_ends_with_2_and_one_line(
    arguments, said, with_catalogue, tmp_path, monkeypatch, capsys
):
    with_catalogue(toys.sound)
    monkeypatch.chdir(tmp_path)
    assert cli.main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    assert printed.err.startswith("flexproof: ")
    assert said in printed.err
    assert "Traceback" not in printed.err
    left = {entry.name for entry in tmp_path.rglob("*")}
    assert left <= {"report", ".lock"}


def test_a_full_disk_ends_with_3_and_says_how_to_go_on(
    with_catalogue, tmp_path, monkeypatch, capsys
):
    def full(descriptor):
        if os.readlink(f"/proc/self/fd/{descriptor}").endswith("results.jsonl"):  # noqa: PTH115
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with_catalogue(toys.sound)
    monkeypatch.setattr(os, "fsync", full)
    out, values = tmp_path / "run", tmp_path / "my values.csv"
    values.write_text("quantity,pose,value,uncertainty,source\nf1,0.4975,80.0,0.1,rig\n")
    options = ["--accept", "x=0.1", "--measured", str(values)]
    assert cli.main(["run", *options, "--out", str(out)]) == 3
    printed = capsys.readouterr().err
    assert "No space left" in printed
    told = f"flexproof run ifw --preset standard --accept x=0.1 --measured '{values}'"
    assert f"{told} --out {out} --resume" in printed


def test_what_the_system_refuses_is_neither_a_fault_of_flexproof_nor_of_stdout(monkeypatch, capsys):
    def refused(*_arguments):
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr("meshes.processes.Process.__init__", refused)
    assert cli.main(["faces", str(ROOT / "examples" / "rocker" / "rocker.step")]) == 3
    assert capsys.readouterr() == ("", "flexproof: the system refuses: Too many open files\n")


def test_help_imports_nothing_heavy():
    program = (
        "import sys; from validation.cli import main; code = main(['--help']);"
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules];"
        "sys.stderr.write(' '.join(loaded)); sys.exit(code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert done.stderr == ""
    assert "run" in done.stdout


def test_a_verdict_worse_than_in_the_baseline_ends_with_1(with_catalogue, tmp_path, capsys):
    with_catalogue(toys.sound)
    first = tmp_path / "first"
    assert cli.main(["run", "--out", str(first)]) == 0
    # The earlier run knew a case that agreed and is now skipped, another value, and a case that
    # is gone.
    earlier = json.loads((first / "results.json").read_text())
    by_id = {case["id"]: case for case in earlier["cases"]}
    by_id["toy.skipped"]["verdict"] = "agree"
    by_id["toy.agrees"]["value"] = 0.25
    earlier["cases"].append(by_id["toy.agrees"] | {"id": "toy.gone"})
    baseline = tmp_path / "baseline.json"
    baseline.write_text(json.dumps(earlier))
    capsys.readouterr()
    out = tmp_path / "second"
    assert cli.main(["run", "--out", str(out), "--baseline", str(baseline)]) == 1
    said = capsys.readouterr().out.splitlines()
    assert any(line.startswith("warning: toy.skipped agreed in the baseline") for line in said)
    assert (
        "against the baseline: 1 verdict worse, 0 better, 1 case drifted, 0 new, 1 removed." in said
    )
    # A part of the run is compared with that part of the baseline.
    arguments = ["run", "--only", "toy.agrees", "--out", str(out), "--baseline", str(baseline)]
    assert cli.main(arguments) == 0
    assert "0 new, 0 removed." in capsys.readouterr().out
    (entry,) = json.loads((out / "results.json").read_text())["cases"]
    assert (entry["verdict"], entry["earlier"]) == ("agree", 0.25)
    assert entry["drift"] == pytest.approx(1.0 / 3.0 - 0.25, rel=1e-12)


def test_export_takes_its_place_in_the_run_folder(with_catalogue, tmp_path, monkeypatch):
    with_catalogue(toys.sound)
    monkeypatch.setattr(
        "validation.export.files.export_mechanism",
        lambda mechanism, preset, folder: (folder / f"{mechanism.name} {preset}.vtu").touch(),
    )
    arguments = ["run", "--only", "toy.agrees", "--preset", "quick", "--out", str(tmp_path)]
    assert cli.main([*arguments, "--export"]) == 0
    assert (tmp_path / "export" / "IFW demonstrator quick.vtu").exists()
    assert not (tmp_path / ".export.tmp").exists()
    # A run without it leaves no export of an earlier one behind.
    assert cli.main(arguments) == 0
    assert not (tmp_path / "export").exists()


def test_a_fault_of_the_program_is_no_disagreement(with_catalogue, tmp_path, monkeypatch, capsys):
    def broken(*_arguments):
        raise RuntimeError("no template")

    with_catalogue(toys.sound)
    monkeypatch.setattr("validation.session.validate.render", broken)
    assert cli.main(["run", "--only", "toy.agrees", "--out", str(tmp_path / "run")]) == 3
    printed = capsys.readouterr().err
    assert "no template" in printed
    assert printed.splitlines()[-1].startswith("flexproof: this is a fault of flexproof itself")
    assert (tmp_path / "run.partial" / "results.json").exists()
