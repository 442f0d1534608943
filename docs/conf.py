"""Documentation site: `./flexproof docs` builds it with Sphinx."""

import sys
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS.parent), str(DOCS)]

# The files of MathJax, so that equations need no network. One of them draws glyphs as outlines.
MATHJAX = Path(find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"

project = "flexproof"
author = "the flexproof developers"
version = release = metadata.version("flexproof")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build", "examples", "pictures"]

sphinx_gallery_conf = {
    "examples_dirs": str(DOCS.parent / "examples" / "gallery"),
    "gallery_dirs": "gallery",
    # EXUDYN has no wheels for some machines.
    "ignore_pattern": "__init__" if find_spec("exudyn") else "__init__|exudyn",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("matplotlib", "gallery_figures.save_returned_figure"),
    "capture_repr": ("_repr_html_",),
    "abort_on_example_error": True,
    "remove_config_comments": True,
    # An example is unchanged, and what it runs may have changed.
    "run_stale_examples": True,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
}

myst_enable_extensions = ["dollarmath", "colon_fence"]
# Pages link to headings by their slugs, as code hosts do.
myst_heading_anchors = 4

autodoc_typehints = "description"
autodoc_member_order = "bysource"
mathjax_path = "tex-svg.js"
html_static_path = [str(MATHJAX / mathjax_path)]

html_theme = "pydata_sphinx_theme"
html_title = "flexproof"
html_theme_options = {
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "show_nav_level": 2,
    "show_prev_next": True,
    "footer_start": [],
    "footer_end": [],
}
html_show_sourcelink = False
html_copy_source = False
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True


def setup(app: Sphinx) -> None:
    """Show tables of comma-separated values, for which Pygments has no lexer, as they are."""
    app.add_lexer("csv", TextLexer)
