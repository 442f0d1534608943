"""The notebook of first steps equals its scripts, has no outputs, and runs."""

import json
import runpy
from pathlib import Path

import pytest
from matplotlib.figure import Figure

MAKER = Path(__file__).resolve().parents[1] / "examples" / "make_notebook.py"


@pytest.fixture(scope="module")
def maker():
    return runpy.run_path(str(MAKER))


def test_notebook_equals_its_scripts(maker):
    """The notebook is made of three scripts of the guide."""
    assert len(maker["SCRIPTS"]) == 3
    assert maker["NOTEBOOK"].read_text("utf-8") == maker["text_of"](maker["notebook"]())


@pytest.mark.exhaustive
def test_notebook_cells_return_figures(maker, monkeypatch, tmp_path):
    """IPython runs them as a kernel does. The values of the cells are figures."""
    shell_of = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.chdir(tmp_path)

    class Shell(shell_of):
        def enable_gui(self, gui=None):
            """A kernel without windows has none to enable."""

    shell = Shell()
    cells = json.loads(maker["NOTEBOOK"].read_text("utf-8"))["cells"]
    values = []
    for cell in cells:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            completed = shell.run_cell("".join(cell["source"]))
            completed.raise_error()
            values.append(completed.result)
    assert sum(isinstance(value, Figure) for value in values) == 4
