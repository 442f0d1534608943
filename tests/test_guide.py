"""Run every example of README.md and docs/guide, in the order of each page.

The first word of a fenced block is its kind:

    ```console         `$ command` and, below it, lines that it prints (… stands for others)
    ```toml name.toml  a file of that name, which later commands of the page use; csv likewise
    ```python          executed; all blocks of a page share one namespace
    ```python name.py  a quotation from docs/examples, where it is executed as a script

`flexproof run` is run at the quick preset on a few comparisons. `flexproof test` is not run: it
runs these tests.
"""

import os
import re
import runpy
import shlex
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from typing import get_args

import pytest
from support.fakes.toy_runs import run_in_this_process

from lumped import sections
from lumped.robot_file import load_robot
from lumped.robot_file.variation import variations_of
from lumped.robots import RobotType
from meshes.section import section_mesh
from validation import cli
from validation.case import Case
from validation.catalogue import catalogue
from validation.run import runner
from validation.variations.cases import cases_over

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "docs" / "examples"
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs" / "guide").glob("*.md")))
# Pages and scripts whose examples take ten seconds and more.
LONG = {"cross_validation", "measured", "models", "mechanisms", "cases", "paper", "from_python"}
# Of these two that take a minute. Tests of the API and docstrings call the same functions.
LONGEST = ("cross_validation", "from_python")
BLOCK = re.compile(r"^```(\w+)[ ]?([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)")
FEW = ["--preset", "quick", "--only", "*.statics?simplified*", "--jobs", "1"]


def blocks(page: Path) -> list[tuple[str, str, str]]:
    return BLOCK.findall(page.read_text(encoding="utf-8"))


def long_apart(paths):
    marks = dict.fromkeys(LONG, pytest.mark.exhaustive) | dict.fromkeys(LONGEST, pytest.mark.soak)
    return [
        pytest.param(path, id=path.stem, marks=[marks[path.stem]] if path.stem in marks else [])
        for path in paths
    ]


@pytest.mark.parametrize("page", long_apart(PAGES))
def test_code_blocks_of_page_run(page, tmp_path, monkeypatch, capsys):
    """Commands print the shown lines, and Python blocks run without an error."""
    monkeypatch.chdir(tmp_path)
    # Workers are tested elsewhere.
    monkeypatch.setattr(runner, "run", run_in_this_process)
    namespace = {"__name__": "example"}
    for language, argument, text in blocks(page):
        if language == "console":
            run_console(text, capsys)
        elif language in {"toml", "csv"}:
            assert argument, "a file needs a name"
            Path(argument).write_text(text, encoding="utf-8")
        elif language == "python" and argument:
            assert text in (EXAMPLES / argument).read_text(encoding="utf-8")
        elif language == "python":
            exec(compile(text, f"{page.name}", "exec"), namespace)  # noqa: S102  our own pages
        else:
            # What a page may show without its being run: formulas and excerpts of files.
            assert language == "text", f"```{language} is not known to this test"


@pytest.mark.parametrize("script", long_apart(sorted(EXAMPLES.glob("*.py"))))
def test_example_scripts_of_guide_run(script, tmp_path, monkeypatch):
    """Scripts of docs/examples that the guide quotes."""
    monkeypatch.chdir(tmp_path)
    # What the guide puts in place from outside is taken back afterwards.
    monkeypatch.setattr(sections, "SHAPES", dict(sections.SHAPES))
    monkeypatch.setattr(section_mesh, "section_blocks", section_mesh.section_blocks)
    runpy.run_path(str(script), run_name="__main__")


@pytest.mark.soak
def test_design_team_example_passes(tmp_path):
    """The example of a team's pytest suite contains one test, which passes."""
    line = (
        f"-m pytest -p no:cacheprovider -q --flexproof-preset quick --rootdir . {EXAMPLES}/design"
    )
    completed = subprocess.run(
        [sys.executable, *line.split()],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "1 passed" in completed.stdout, completed.stdout + completed.stderr


def run_console(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Run each command of a console block. `flexproof run` computes only a few comparisons."""
    for example in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *expected = example.rstrip().splitlines()
        program, *arguments = shlex.split(command.split(";")[0], comments=True)
        assert program in {"flexproof", "./flexproof"}
        if arguments == ["test"]:
            continue
        running = arguments[0] == "run"
        if running:
            line = re.sub(r"--(preset|only) \S+", "", shlex.join(arguments))
            arguments = [*shlex.split(line), *FEW]
        code = cli.main(arguments)
        printed = capsys.readouterr()
        actual = (printed.err + printed.out).splitlines()
        if command.endswith("; echo $?"):
            actual.append(str(code))
        else:
            assert code == 0, f"{command}\n{printed.err}"
        if running:
            continue
        # The expected lines are there, in their order.
        lines = map(str.strip, actual)
        for line in map(str.strip, expected):
            assert line == "…" or line in lines, f"{command} did not print {line!r} but\n{actual}"


def test_blocks_and_links_are_valid():
    """Code blocks are closed, and the files of relative links exist."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert text.count("\n```") == 2 * len(blocks(page)), f"{page.name}: an open code block"
        for target in LINK.findall(text):
            if not target.startswith("https://"):
                assert (page.parent / target).exists(), f"{page.name}: {target} does not exist"


@pytest.mark.parametrize("page", PAGES[1:], ids=lambda page: page.stem)
def test_page_has_aim_and_next_page(page):
    """A page begins with "After this page you …" and ends with "Next:"."""
    paragraphs = page.read_text(encoding="utf-8").strip().split("\n\n")
    assert paragraphs[1].startswith("After this page you ")
    assert re.match(r"\*\*Next:\*\* .*\]\([a-z./-]+\.md", paragraphs[-1])


def test_guide_lists_types_of_robots():
    """describing.md lists all values of `type`, in the order of the code."""
    page = (ROOT / "docs" / "guide" / "describing.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `([\w-]+)` \|", page, re.MULTILINE) == list(get_args(RobotType))


def test_mechanisms_of_guide_are_built_in():
    """The robot files printed in mechanisms.md equal the built-in ones."""
    mechanisms = {
        name.removesuffix(".toml"): text
        for language, name, text in blocks(ROOT / "docs" / "guide" / "mechanisms.md")
        if language == "toml" and name != "written-out.toml"
    }
    assert set(mechanisms) == {"five-bar", "3-rrr", "delta", "orthoglide", "hexapod"}
    files = {name: ROOT / "lumped" / "robots" / f"{name}.toml" for name in mechanisms}
    assert mechanisms == {name: file.read_text(encoding="utf-8") for name, file in files.items()}


def test_new_case_takes_ten_lines():
    """Lines of code of new_case.py, without imports and trial call."""
    case, _, _ = (EXAMPLES / "new_case.py").read_text(encoding="utf-8").partition("if __name__")
    assert len(re.findall(r"^.*\S", case.rpartition('"""\n')[2], re.MULTILINE)) <= 10


def test_guide_lists_every_case_of_the_catalogue():
    """Each case matches a pattern of cases.md, and each pattern matches a case."""
    page = (ROOT / "docs" / "guide" / "cases.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
    patterns = [pattern for row in rows for pattern in re.findall(r"`([^`]+)`", row)]
    robots = ("ifw", "five-bar", ROOT / "examples" / "tapered-biglide" / "robot.toml")
    ifw, five_bar, tapered = map(load_robot, robots)
    ids = [task.id for task in catalogue(ifw) if isinstance(task, Case)]
    case_names = [identifier.replace("leg2", "leg1") for identifier in ids]
    assert [
        case_name
        for case_name in case_names
        if not any(fnmatchcase(case_name, p) for p in patterns)
    ] == []
    ids += [task.id for robot_file in (five_bar, tapered) for task in catalogue(robot_file)]
    ids += [case.id for case in cases_over(five_bar, variations_of(five_bar, ["tool.mass=1:2:3"]))]
    assert [pattern for pattern in patterns if not any(fnmatchcase(i, pattern) for i in ids)] == []


@pytest.mark.soak
def test_numbers_of_parts_page_are_current():
    """The page is written by a script, `python docs/pictures/parts_models.py`."""
    script = runpy.run_path(str(ROOT / "docs" / "pictures" / "parts_models.py"))
    page = script["PAGE"].read_text(encoding="utf-8")
    assert script["written"](page, script["numbers"]()) == page
