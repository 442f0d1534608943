"""Examples in the docstrings of the public functions run, and print what they show."""

import doctest
import inspect
from pathlib import Path

import pytest

import flexproof as fp
from validation import api

ROOT = Path(__file__).resolve().parents[1]
FUNCTIONS = [name for name in fp.__all__ if inspect.isfunction(getattr(fp, name))]
QUICK = {"compare_measured", "converge", "load", "solve"}
PARSER = doctest.DocTestParser()


def run_examples(text, names, where):
    """Run the examples of a text with `names` known, and return the names that they define."""
    test = PARSER.get_doctest(text, names, where, None, None)
    assert test.examples, f"{where} has no example"
    runner = doctest.DocTestRunner(verbose=False)
    report = []
    runner.run(test, out=report.append, clear_globs=False)
    assert runner.failures == 0, "".join(report)
    return test.globs


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.exhaustive] * (n not in QUICK)) for n in FUNCTIONS],
)
def test_examples_of_functions_print_what_they_show(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    known = run_examples(api.__doc__, {}, "validation.api")
    run_examples(getattr(api, name).__doc__, {**vars(api), **known}, name)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstrings_describe_every_parameter_and_result(name):
    """The form of numpydoc: Parameters by name, Returns, Raises, Examples."""
    text = inspect.getdoc(getattr(api, name))
    for heading in ("Parameters", "Returns", "Raises", "Examples"):
        assert f"\n{heading}\n{'-' * len(heading)}\n" in text, heading
    described = text.partition("\nParameters\n")[2].partition("\nReturns\n")[0]
    lines = [line for line in described.splitlines() if line and not line.startswith(" ")]
    names = [one.strip(" *") for line in lines[1:] for one in line.split(",")]
    assert names == list(inspect.signature(getattr(fp, name)).parameters)
