"""Command `docs` of the command line.

Input: a folder. Output: the documentation site in this folder, built with Sphinx from docs/.
"""

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from cyclopts import Parameter

from fem.extras import require_extra
from lumped.errors import ComputationError, InputError
from validation.console.streams import write_message

SOURCES = Path(__file__).resolve().parents[2] / "docs"
# File that Sphinx writes to each folder that it builds.
MARK = ".buildinfo"


def docs(*, out: Annotated[Path, Parameter(show_default=True)] = Path("site")) -> int:
    """Build the documentation site: static pages with search that open offline in any browser.

    Parameters
    ----------
    out
        Folder for the pages. A folder that contains anything but an earlier site is refused.
    """
    if not (SOURCES / "conf.py").is_file():
        raise InputError(
            "docs: no folder docs/ in the current folder; run the command in a clone of the sources"
        )
    require_extra("docs", "docs")
    if out.exists() and not (out.is_dir() and (not any(out.iterdir()) or (out / MARK).is_file())):
        raise InputError(
            f"docs: {out} exists and is not an earlier site; choose another folder with --out"
        )
    # Examples of the gallery solve small matrices, on which more threads of BLAS lose time.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Sphinx takes half a second to import.
    from sphinx.cmd.build import build_main  # noqa: PLC0415

    with TemporaryDirectory() as doctrees:
        options = ["--fail-on-warning", "--keep-going", "--quiet", "--doctree-dir", doctrees]
        failed = build_main([*options, "--builder", "html", str(SOURCES), str(out)])
    sys.stdout.flush()
    if failed:
        raise ComputationError("docs: Sphinx reported warnings or errors (see above)")
    write_message(f"{out / 'index.html'} written")
    return 0
