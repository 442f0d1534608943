"""The viewer of 3-D scenes (vtk.js, as trame's export carries it), once for the whole page."""

import gzip
from importlib.resources import files

from validation.drawing.text import base64

# The viewer asks this place for an icon of its own; the report asks no network for anything.
_ICONS = b"https://kitware.github.io/vtk-js/icon/"
# It tells the console what it reads; the page wants to know it instead, to set modes in motion.
_TELLS, _KEEPS = b"console.log(Object.keys(s))", b"global.scene=s"


def packed() -> str:
    """The viewer's page, gzip in base64; a browser unpacks it when the first scene is opened."""
    page = files("trame_vtk.tools").joinpath("static_viewer.html").read_bytes()
    page = page.replace(_ICONS, b"data:,").replace(_TELLS, _KEEPS)
    return base64(gzip.compress(page, compresslevel=9, mtime=0))
