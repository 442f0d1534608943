"""Figures that `.plot()` returns, for the gallery: sphinx-gallery finds those of pyplot alone."""

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

# Dots per inch of pictures on a page, at least.
DOTS = 150.0
# Name under which sphinx-gallery keeps the value of the last expression of a cell.
LAST = "___"


def save_returned_figure(
    _block: object, block_vars: dict[str, Any], gallery_conf: dict[str, Any]
) -> str:
    """Save the figure that is the last expression of a cell, and return its reST."""
    values = block_vars["example_globals"]
    if not isinstance(figure := values.get(LAST), Figure):
        return ""
    # A later cell without a value of its own must not show it again.
    values[LAST] = None
    path = next(block_vars["image_path_iterator"])
    figure.savefig(path, dpi=max(DOTS, figure.dpi))
    return str(figure_rst([path], gallery_conf["src_dir"]))
