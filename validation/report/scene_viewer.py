"""The viewer of 3-D scenes (vtk.js, as trame's export carries it), once for the whole page."""

import gzip
from importlib.resources import files

from validation.report.text import base64

# The viewer asks this place for an icon of its own; the report asks no network for anything.
_ICONS = b"https://kitware.github.io/vtk-js/icon/"


def packed() -> str:
    """The viewer's page, gzip in base64; a browser unpacks it when the first scene is opened."""
    page = files("trame_vtk.tools").joinpath("static_viewer.html").read_bytes()
    page = page.replace(_ICONS, b"data:,")
    return base64(gzip.compress(page, compresslevel=9, mtime=0))
