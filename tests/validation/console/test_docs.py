"""Documentation site: it builds without warnings, opens offline, and its search finds pages."""

import os
import re
import shutil
import subprocess
import sys
import time
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import quote, urlsplit

import pytest

import flexproof as fp
from validation.console import docs
from validation.console.docs import MARK

ROOT = Path(__file__).resolve().parents[3]


class Addresses(HTMLParser):
    """Addresses that a page loads, those to which it links, and its anchors."""

    def __init__(self):
        super().__init__()
        self.loaded, self.linked, self.anchors = [], [], set()

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if "id" in attributes:
            self.anchors.add(attributes["id"])
        if tag == "a" and "href" in attributes:
            self.linked.append(attributes["href"])
        elif tag in {"script", "img", "iframe"} and "src" in attributes:
            self.loaded.append(attributes["src"])
        elif tag == "link" and "href" in attributes:
            self.loaded.append(attributes["href"])


# Examples whose scripts run while the site is built: one that draws with pyplot, and one whose last
# value is a figure. tests/test_gallery.py runs all of them.
EXECUTED = ("plot_02_convergence", "plot_07_buckling")
# Command `docs` with the examples whose path matches the first argument.
BUILD = """
import sys
import sphinx.cmd.build
from validation.cli import main

build = sphinx.cmd.build.build_main
pattern = f"sphinx_gallery_conf.filename_pattern={sys.argv[1]}"
sphinx.cmd.build.build_main = lambda options: build(["-D", pattern, *options])
sys.exit(main(["docs", "--out", sys.argv[2]]))
"""


def built_once(shared, executed):
    """Folder of the built site in `shared`, a folder for all workers of a test session.

    The worker that makes the folder builds the site, and the others wait for its last line. Scripts
    of the gallery run if their path matches the regular expression `executed`.
    """
    folder, log = shared / "site", shared / "site.log"
    try:
        folder.mkdir()
    except FileExistsError:
        while not (log.is_file() and log.read_text("utf-8").startswith("exit code ")):
            time.sleep(0.5)
    else:
        line = [sys.executable, "-c", BUILD, executed, str(folder)]
        completed = subprocess.run(line, capture_output=True, text=True, check=False)
        log.with_suffix(".new").write_text(
            f"exit code {completed.returncode}\n{completed.stderr}", "utf-8"
        )
        log.with_suffix(".new").rename(log)
    text = log.read_text("utf-8")
    assert text.startswith("exit code 0\n"), text
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder of the site, and its pages by file, as parsed addresses."""
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder = built_once(shared, "|".join(EXECUTED))
    return folder, parsed_pages(folder)


def parsed_pages(folder):
    """Addresses of each page of a site, by its file."""
    pages = {}
    for file in folder.rglob("*.html"):
        pages[file] = page = Addresses()
        page.feed(file.read_text("utf-8"))
    return pages


@pytest.mark.exhaustive
def test_site_has_every_guide_page(site):
    """Each file of docs/guide is a page of the site."""
    folder, pages = site
    guide = {file.stem for file in (docs.SOURCES / "guide").glob("*.md")}
    assert {page.stem for page in pages if page.parent == folder / "guide"} == guide


@pytest.mark.exhaustive
def test_site_needs_no_network(site):
    """Pages load scripts, styles and pictures from files only."""
    _, pages = site
    for file, page in pages.items():
        assert page.loaded, file
        for address in page.loaded:
            assert not re.match(r"(\w+:)?//", address), (file, address)


@pytest.mark.exhaustive
def test_site_links_are_valid(site):
    """Files and anchors of all links within the site."""
    _, pages = site
    checked = 0
    for file, page in pages.items():
        for address in page.linked:
            target, _, anchor = address.partition("#")
            if "://" in target or address == "#":
                continue
            linked = (file.parent / target).resolve() if target else file
            assert linked.is_file(), (file, address)
            if anchor and linked in pages:
                assert anchor in pages[linked].anchors, (file, address)
            checked += 1
    assert checked > 500


@pytest.mark.exhaustive
def test_external_links_are_well_formed(site):
    """The links are not followed, so that the test needs no network."""
    _, pages = site
    addresses = {address for page in pages.values() for address in page.linked if "://" in address}
    for address in addresses:
        parts = urlsplit(address)
        assert parts.scheme == "https", address
        assert re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+)+", parts.netloc), address
        assert not re.search(r"\s", address), address
    assert len(addresses) >= 3


def check_pictures(folder, pages, scripts):
    """Each example has a thumbnail on the index page and a picture on its own page."""
    thumbnails = pages[folder / "gallery" / "index.html"].loaded
    for name in scripts:
        assert any(f"{name}_thumb" in address for address in thumbnails), name
        loaded = pages[folder / "gallery" / f"{name}.html"].loaded
        assert any(f"sphx_glr_{name}_001" in address for address in loaded), name


@pytest.mark.exhaustive
def test_executed_examples_have_pictures(site):
    """Of the examples that are executed here; all examples have a page."""
    folder, pages = site
    check_pictures(folder, pages, EXECUTED)
    scripts = {path.stem for path in (ROOT / "examples/gallery").glob("plot_*.py")}
    assert scripts <= {page.stem for page in pages if page.parent == folder / "gallery"}


@pytest.mark.soak
def test_all_examples_have_pictures(tmp_path):
    """The site as the command builds it, with every example executed."""
    folder = built_once(tmp_path, "plot_")
    scripts = {path.stem for path in (ROOT / "examples/gallery").glob("plot_*.py")}
    check_pictures(folder, parsed_pages(folder), scripts)


@pytest.mark.exhaustive
def test_api_reference_has_all_names(site):
    """Names in `flexproof.__all__`."""
    folder, pages = site
    anchors = {anchor.rpartition(".")[2] for anchor in pages[folder / "api.html"].anchors}
    assert set(fp.__all__) <= anchors


# Questions of a newcomer: words to type, a page that must be among the first three results, and the
# answer that it contains.
QUESTIONS = {
    "How do I install it?": ("install", "guide/start.html", "./flexproof run"),
    "How do I describe a leg that is a tube?": ("section", "guide/sections.html", "thickness"),
    "How many elements does a leg need?": (
        "elements needed",
        "guide/convergence.html",
        "1 % needs",
    ),
    "Is my model good enough?": ("good enough", "guide/adequacy.html", "rely ="),
    "How do I use a part from CAD?": ("CAD part", "guide/parts.html", 'step = "leg1.step"'),
    "What does exit code 1 mean?": ("exit code", "guide/commands.html", "disagree"),
    "How do I compare with a hammer test?": ("hammer test", "guide/measured.html", "--measured"),
    "How do I assert a limit in pytest?": ("pytest", "guide/programs.html", "assert_adequate"),
}
CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium (Debian: chromium)")


def found_pages(folder, words, tmp_path):
    """Pages that the search of the site finds, best first, without a network."""
    flags = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage")
    offline = ("--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={tmp_path}")
    address = f"{(folder / 'search.html').as_uri()}?q={quote(words)}"
    line = [CHROMIUM, *flags, *offline, "--virtual-time-budget=20000", "--dump-dom", address]
    completed = subprocess.run(line, capture_output=True, text=True, check=True, timeout=120.0)
    results = completed.stdout.partition('id="search-results"')[2]
    pages = [link.partition("#")[0] for link in re.findall(r'<a href="([^"?]+)', results)]
    return list(dict.fromkeys(pages))


@pytest.mark.exhaustive
@needs_browser
@pytest.mark.parametrize("question", QUESTIONS)
def test_search_finds_newcomer_questions(site, question, tmp_path):
    """One search in a browser, from files and without a network, and one result page."""
    folder, _ = site
    words, page, answer = QUESTIONS[question]
    assert page in found_pages(folder, words, tmp_path)[:3]
    assert answer in unescape(re.sub("<[^>]*>", "", (folder / page).read_text("utf-8")))


@pytest.mark.exhaustive
@needs_browser
@pytest.mark.parametrize(
    ("words", "page"),
    [
        ("buckling", "guide/loads.html"),
        ("torsion warp", "guide/theory.html"),
        ("nastran", "guide/export.html"),
        ("windows", "guide/platforms.html"),
        ("dictionary robot", "gallery/plot_04_five_bar.html"),
    ],
)
def test_search_finds_subject_pages(site, words, page, tmp_path):
    """Words such as "buckling" and "nastran" find the page on them."""
    folder, _ = site
    assert page in found_pages(folder, words, tmp_path)


def test_foreign_output_folder_is_refused(command, tmp_path):
    """A folder with other files is not overwritten."""
    (tmp_path / "notes.txt").write_text("mine", "utf-8")
    assert "is not an earlier site" in command.error_line("docs", "--out", str(tmp_path))
    assert [file.name for file in tmp_path.iterdir()] == ["notes.txt"]


def test_earlier_site_is_replaced(tmp_path, monkeypatch):
    """A folder with the mark of an earlier site is passed to Sphinx again."""
    (tmp_path / MARK).write_text("", "utf-8")
    calls = []
    monkeypatch.setattr("sphinx.cmd.build.build_main", lambda options: calls.append(options) or 0)
    assert docs.docs(out=tmp_path) == 0
    assert calls[0][-1] == str(tmp_path)


def test_docs_without_sources_are_refused(command, monkeypatch):
    """An installed package has no docs folder."""
    monkeypatch.setattr(docs, "SOURCES", Path("/nonexistent-sources"))
    assert re.search("in a clone of the sources", command.error_line("docs"))
