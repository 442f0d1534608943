"""Writes examples/first_steps.ipynb, the first three examples of the gallery as one notebook.

python examples/make_notebook.py

It has no outputs. Needs the extra docs.
"""

import json
import re
from pathlib import Path
from typing import Any

from sphinx_gallery.py_source_parser import split_code_and_text_blocks

EXAMPLES = Path(__file__).resolve().parent
NOTEBOOK = EXAMPLES / "first_steps.ipynb"
SCRIPTS = sorted((EXAMPLES / "gallery").glob("plot_0[123]_*.py"))
TITLE = """# First steps with flexproof

The first three examples of the gallery. Made from the scripts in `examples/gallery` by
`python examples/make_notebook.py`."""


def notebook() -> dict[str, Any]:
    """The notebook (format 4.4): a cell for each cell of the scripts."""
    cells = [_cell("markdown", TITLE), _cell("code", "%matplotlib inline")]
    for script in SCRIPTS:
        blocks = split_code_and_text_blocks(str(script))[1]
        cells += [
            _cell("code", block.content)
            if block.type == "code"
            else _cell("markdown", _markdown(block.content))
            for block in blocks
            if block.content.strip()
        ]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 4,
    }


def text_of(document: dict[str, Any]) -> str:
    """The notebook as the text of its file."""
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _markdown(text: str) -> str:
    headed = re.sub(r"^(.+)\n=+$", r"## \1", text.strip(), flags=re.MULTILINE)
    return headed.replace("``", "`")


def _cell(kind: str, text: str) -> dict[str, Any]:
    own: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    lines = text.strip("\n").splitlines(keepends=True)
    return {"cell_type": kind, "metadata": {}, "source": lines, **own}


if __name__ == "__main__":
    NOTEBOOK.write_text(text_of(notebook()), encoding="utf-8")
