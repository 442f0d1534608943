"""Run the examples in docstrings of public functions and of their results."""

import doctest
import inspect
import re
from pathlib import Path

import pytest

import flexproof as fp
from validation import api

ROOT = Path(__file__).resolve().parents[1]
FUNCTIONS = [name for name in fp.__all__ if inspect.isfunction(getattr(fp, name))]
QUICK = {"compare_measured", "converge", "forces", "load", "solve"}
# Ten seconds to half a minute each, with commands of the same name tested elsewhere.
LONG = {"adequacy", "identify", "identify_free", "run", "vary", "workspace"}
ERRORS = (fp.InputError, fp.ComputationError)
RESULTS = [n for n in fp.__all__ if inspect.isclass(vars(fp)[n]) and vars(fp)[n] not in ERRORS]
# Members that other modules of the project call; the API reference leaves them out.
INTERNAL = {
    "ConvergenceStudy": {
        *("chart", "column", "panel", "picture", "record", "refined", "short_summary"),
        *("stated_count", "studies", "title"),
    },
    "Forces": {"chart"},
    "WorkspaceMaps": {"chart"},
}
PARSER = doctest.DocTestParser()


def run_examples(text, names, where):
    """Run the examples of a text with the variables `names`; return all variables by name."""
    test = PARSER.get_doctest(text, names, where, None, None)
    assert test.examples, f"{where} has no example"
    runner = doctest.DocTestRunner(verbose=False)
    report = []
    runner.run(test, out=report.append, clear_globs=False)
    assert runner.failures == 0, "".join(report)
    return test.globs


def once(function):
    """Wrap `function` so that it is called once for equal arguments."""
    values = {}

    def remembered(*args, **kwargs):
        key = repr((args, sorted(kwargs.items())))
        if key not in values:
            values[key] = function(*args, **kwargs)
        return values[key]

    return remembered


@pytest.mark.parametrize(
    "name",
    [
        name
        if name in QUICK
        else pytest.param(name, marks=pytest.mark.soak if name in LONG else pytest.mark.exhaustive)
        for name in FUNCTIONS
    ],
)
def test_docstring_examples_of_functions_run(name, tmp_path, monkeypatch):
    """Run the examples of a function, then those of the class of its result and its methods."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    variables = {**vars(api), name: once(getattr(api, name))}
    variables |= run_examples(api.__doc__, {}, "validation.api")
    run_examples(getattr(api, name).__doc__, dict(variables), name)
    result = inspect.signature(getattr(api, name)).return_annotation
    if getattr(result, "__name__", "") in RESULTS:
        run_examples_of_result(result.__name__, variables)


def test_docstring_examples_of_tables_run():
    """Examples of `ResultTable`, the class of all tables."""
    run_examples_of_result("ResultTable", {})


def run_examples_of_result(name, variables):
    """Run the examples of a class. They make the result on which its methods are called."""
    variables = run_examples(getattr(fp, name).__doc__, {**vars(fp), **variables}, name)
    (result,) = [value for value in variables.values() if type(value) is getattr(fp, name)]
    assert name == "ResultTable" or len(repr(result)) < 200
    for member, value in members(name).items():
        run_examples(value.__doc__, dict(variables), f"{name}.{member}")


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstrings_have_all_parameters(name):
    """The form of numpydoc: Parameters by name, Returns, Raises, Examples."""
    text = inspect.getdoc(getattr(api, name))
    for heading in ("Parameters", "Returns", "Raises", "Examples"):
        assert f"\n{heading}\n{'-' * len(heading)}\n" in text, heading
    described = text.partition("\nParameters\n")[2].partition("\nReturns\n")[0]
    lines = [line for line in described.splitlines() if line and not line.startswith(" ")]
    names = [name.strip(" *") for line in lines[1:] for name in line.split(",")]
    assert names == list(inspect.signature(getattr(fp, name)).parameters)


def members(name):
    """Public methods and properties of a class of results, by name."""
    public = {
        member: value
        for member, value in vars(getattr(fp, name)).items()
        if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property))
    }
    return {key: public[key] for key in public if key not in INTERNAL.get(name, ())}


@pytest.mark.parametrize("name", RESULTS)
def test_method_docstrings_have_all_parameters(name):
    """Methods of results: Parameters by name, and Returns or Raises."""
    for member, value in members(name).items():
        if isinstance(value, property):
            continue
        text, signature = inspect.getdoc(value), inspect.signature(value)
        described = text.partition("\nParameters\n")[2].partition("\n\n")[0]
        names = re.findall(r"^([a-z_, ]+)$", described, re.MULTILINE)
        listed = [name.strip() for line in names for name in line.split(",")]
        assert listed == list(signature.parameters)[1:], f"{name}.{member}"
        returns = "Raises" if signature.return_annotation is None else "Returns"
        assert f"\n{returns}\n{'-' * len(returns)}\n" in text, f"{name}.{member}"


@pytest.mark.parametrize("name", RESULTS)
def test_every_result_has_a_table_and_a_plot(name):
    """Each result class has `table`, `plot` and a form for notebooks."""
    result_class = getattr(fp, name)
    if name == "ResultTable":
        return
    assert inspect.signature(result_class.table).return_annotation in (
        fp.ResultTable,
        "ResultTable",
    )
    assert inspect.signature(result_class.plot).return_annotation == "Figure"
    assert "_repr_html_" in vars(result_class)
