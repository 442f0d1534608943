"""Rules of the code base: one-way imports, small folders, and no paths of a machine."""

import ast
import re
import runpy
import subprocess
import sys
from fnmatch import fnmatch
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FLOORS = ("lumped", "meshes", "fem", "validation", "tests")
# The script that draws the house knows its rooms and who imports whom.
MAP = runpy.run_path(str(ROOT / "docs" / "pictures" / "architecture.py"))
MODULES = MAP["modules"]()
HOME = re.compile(r"(?<![\w./])/(?:home|Users|root|work|tmp)/[A-Za-z0-9_.-]|[A-Z]:\\\\Users")
# What a lock or a script may name by host: the homes of projects, never an index of packages.
INDEX = re.compile(r"https?://(?!pypi\.org/)[^\s/\"')]*(?:pypi|simple|artifactory|nexus|devpi)")
# Attributes that persons read, or that name something; what is meant has a field of its own.
TEXTS = re.compile(
    "id|title|citation|section|label|caption|message|meaning|text|reason|sentence|quantity|remedy"
)
TAKEN_APART = re.compile(
    r"(?:start|end)swith|r?partition|r?split|splitlines|remove\w+|r?find|r?index|[lr]?strip|isdecimal"
)
EMPTY = re.compile(r"\[\]|\{\}|(?:list|dict|set|deque|(?:\w+\.)?defaultdict)\((?:list|dict|set)?\)")


def tracked() -> list[Path]:
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z"],  # noqa: S607  whichever git the developer uses
            cwd=ROOT,
            capture_output=True,
            check=True,
            text=True,
        ).stdout.split("\0")
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git clone")
    return [ROOT / name for name in listed if name and (ROOT / name).is_file()]


def test_every_tests_folder_is_collected(pytestconfig):
    """The pattern of .gitignore for a run's report would also match the tests of the report."""
    patterns = pytestconfig.getini("norecursedirs")
    for module in (ROOT / "tests").rglob("test_*.py"):
        rooms = module.relative_to(ROOT).parts[:-1]
        assert not [room for room in rooms for pattern in patterns if fnmatch(room, pattern)], (
            module
        )


def test_endless_test_is_stopped(pytestconfig, tmp_path):
    """pytest-timeout stops a test after the limit of pyproject.toml."""
    assert float(pytestconfig.getini("timeout")) > 0.0
    endless = tmp_path / "test_endless.py"
    endless.write_text("def test_endless():\n    while True:\n        pass\n")
    options = ["-q", "-c", ROOT / "pyproject.toml", "-o", "timeout=1", "-p", "no:cacheprovider"]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *options, endless],
        cwd=tmp_path,
        capture_output=True,
        check=False,
        text=True,
    )
    assert ended.returncode == pytest.ExitCode.TESTS_FAILED
    assert "Timeout (>1.0s)" in ended.stdout


def test_imports_go_one_way_without_circles():
    """Imports in functions and for type checking count, too."""
    arrows = {name: MAP["imports"](path, MODULES) - {name} for name, path in MODULES.items()}
    for name, imports in arrows.items():
        allowed = FLOORS[: FLOORS.index(name.split(".")[0]) + 1]
        assert {imported.split(".")[0] for imported in imports} <= set(allowed), name
    TopologicalSorter(arrows).prepare()


def test_architecture_drawing_is_current():
    """The picture is the one that docs/pictures/architecture.py draws."""
    assert MAP["drawing"]() == MAP["PICTURE"].read_text(encoding="utf-8")


def test_no_module_has_mutable_state():
    """Data that changes is passed as arguments.

    The memos of `lumped.memo` are cleared before each test.
    """
    assert states("found: list[int] = []\nLIMITS = {1: 2}\n") == ["found"]
    assert states("seen = set()\nfrom collections import deque\ntodo = deque()") == ["seen", "todo"]
    assert states("def f():\n    global count\n    count = 1") == ["count"]
    mutable = {
        f"{name}.{state}"
        for name, path in MODULES.items()
        for state in states(path.read_text(encoding="utf-8"))
    }
    assert mutable == {"lumped.memo._memoised"}


def states(source: str) -> list[str]:
    """Names of a module's mutable state: empty collections that are filled later, and globals."""
    tree, mutable = ast.parse(source), list[str]()
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            mutable += [
                ast.unparse(target)
                for target in targets
                if EMPTY.fullmatch(ast.unparse(node.value))
            ]
    globals_ = (node for node in ast.walk(tree) if isinstance(node, ast.Global))
    return [*mutable, *(name for node in globals_ for name in node.names)]


def test_no_machine_path_is_committed():
    """No home folders and no addresses of package indices in tracked files."""
    assert HOME.search("see /home/someone/x")
    assert not HOME.search("#!/bin/sh and docs/home/page")
    assert INDEX.search("--index-url https://pypi.example.org/simple")
    assert not INDEX.search("https://pypi.org/project/gmsh")
    for path in set(tracked()) - {Path(__file__).resolve()}:
        text = path.read_text(encoding="utf-8", errors="ignore")
        assert not HOME.search(text), path
        assert not INDEX.search(text), path


def test_program_does_not_parse_its_own_texts():
    """No decision depends on the text of a message, title or remedy, but on fields and classes."""
    steering = (
        *("case.id.startswith('robot.')", "'solid' in case.title", "case.quantity[0]"),
        *("quantity.startswith('load:')", "one.quantity.name[:1]", "quantity.key.partition('.')"),
        *("str(error).startswith('ran out')", "step.remedy.text.partition('--')"),
        *("remedy = one.remedy\n'--ends' in remedy", "said = str(error)\nsaid[:3] == 'out'"),
        *("for fault in error.faults:\n    fault.removeprefix('x')", "re.search('a', case.title)"),
        "[fault for fault in error.faults if fault.endswith('memory')]",
    )
    for text in steering:
        assert parsed_texts(ast.parse(text)), text
    # Blanks of a message may be counted and joined; collections that hold texts are no texts.
    for text in ("str(error).split()", "case.id in known", "name = 'x'\nname.split('.')"):
        assert not parsed_texts(ast.parse(text)), text
    for path in MODULES.values():
        if name := parsed_texts(ast.parse(path.read_text(encoding="utf-8"))):
            assert str(path.relative_to(ROOT)) in READERS, (path, name)


# A file that somebody wrote is read line by line.
READERS = {"meshes/part/reading/deck.py"}


def parsed_texts(tree: ast.Module) -> list[str]:
    """Expressions that search or split a text written for persons, such as an error message."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return [
        expression
        for scope in (tree, *functions)
        for expression in parsed_in(list(ast.walk(scope)))
    ]


def parsed_in(nodes: list[ast.AST]) -> list[str]:
    names = {"quantity", "remedy"}
    for node in nodes:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if is_text(value, names):
                names.add(name)
            case ast.For(target=ast.Name(id=name), iter=ast.Attribute(attr="faults")):
                names.add(name)
            case ast.comprehension(target=ast.Name(id=name), iter=ast.Attribute(attr="faults")):
                names.add(name)
    expressions = []
    for node in nodes:
        match node:
            case ast.Call(func=ast.Attribute(value=value, attr=method), args=args):
                blanks = method == "split" and not args
                bad = bool(TAKEN_APART.fullmatch(method)) and not blanks and is_text(value, names)
                of_re = isinstance(value, ast.Name) and value.id == "re"
                bad |= of_re and any(is_text(argument, names) for argument in args)
            case ast.Subscript(value=value):
                bad = is_text(value, names)
            case ast.Compare(ops=[ast.In() | ast.NotIn()], comparators=[value]):
                bad = is_text(value, names)
            case _:
                bad = False
        expressions += [ast.unparse(node)] if bad else []
    return expressions


def is_text(node: ast.expr, names: set[str]) -> bool:
    match node:
        case ast.Name(id=name):
            return name in names
        case ast.Attribute(attr="name" | "key", value=ast.Name(id=owner)):
            return owner in {"quantity", "remedy"}
        case ast.Attribute(attr="name" | "key", value=ast.Attribute(attr=owner)):
            return owner in {"quantity", "remedy"}
        case ast.Attribute(attr=attribute):
            return bool(TEXTS.fullmatch(attribute))
        case ast.Call(func=ast.Name(id="str"), args=[ast.Name(id=name)]):
            return name.endswith("error")
    return False
