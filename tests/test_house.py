"""The house keeps its rules: arrows downwards, small rooms, nothing of the builder's machine."""

import ast
import re
import runpy
import subprocess
from collections import Counter
from collections.abc import Mapping
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FLOORS = ("lumped", "meshes", "fem", "validation")
# The script that draws the house knows its rooms and who imports whom.
MAP = runpy.run_path(str(ROOT / "docs" / "pictures" / "architecture.py"))
MODULES = [path for floor in FLOORS for path in sorted((ROOT / floor).rglob("*.py"))]
HOME = re.compile(r"(?<![\w./])/(?:home|Users|root|work|tmp)/[A-Za-z0-9_.-]|[A-Z]:\\\\Users")
# What a lock or a script may name by host: the homes of projects, never an index of packages.
INDEX = re.compile(r"https?://(?!pypi\.org/)[^\s/\"')]*(?:pypi|simple|artifactory|nexus|devpi)")


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


def test_no_room_of_tests_is_passed_over(pytestconfig):
    """A pattern for the folder of a run's report, too, hides the tests of the page."""
    patterns = pytestconfig.getini("norecursedirs")
    rooms = {module.parent.relative_to(ROOT) for module in (ROOT / "tests").rglob("test_*.py")}
    hidden = [
        str(room)
        for room in rooms
        if any(fnmatch(name, pattern) for name in room.parts for pattern in patterns)
    ]
    assert not hidden


@cache
def arrows() -> dict[str, set[str]]:
    """What each module imports of the house, in functions and for types alone too."""
    known = MAP["modules"]()
    return {name: MAP["imports"](path, known) - {name} for name, path in known.items()}


def test_imports_go_one_way():
    floors = (*FLOORS, "tests")
    wrong = {
        f"{name} imports {imported}"
        for name, found in arrows().items()
        for imported in found
        if floors.index(imported.split(".")[0]) > floors.index(name.split(".")[0])
    }
    assert not wrong


def in_circles(arrows: Mapping[str, set[str]]) -> list[str]:
    def reached(start: str) -> set[str]:
        seen, todo = set(), [start]
        while todo:
            onwards = arrows[todo.pop()] - seen
            seen |= onwards
            todo += onwards
        return seen

    return [name for name in arrows if name in reached(name)]


def test_no_module_imports_itself_in_a_circle():
    assert in_circles(arrows()) == []


def test_rooms_look_one_way():
    """A room is a folder of a floor, or a module that lies loose on it."""
    rooms: dict[str, set[str]] = {}
    for name, imported in arrows().items():
        rooms.setdefault(MAP["room_of"](name), set()).update(map(MAP["room_of"], imported))
    assert in_circles({room: found - {room} for room, found in rooms.items()}) == []


def test_at_most_nine_modules_lie_loose_in_a_room():
    loose = Counter(module.parent for module in MODULES if module.name != "__init__.py")
    crowded = {str(room.relative_to(ROOT)): count for room, count in loose.items() if count > 9}
    assert crowded == {}


def test_every_module_and_public_name_is_documented():
    wanting = []
    for module in MODULES:
        tree = ast.parse(module.read_text(encoding="utf-8"))
        public = [
            node
            for node in tree.body
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
        ]
        wanting += [
            f"{module.relative_to(ROOT)}: {getattr(node, 'name', 'the module')}"
            for node in [tree, *public]
            if not ast.get_docstring(node)
        ]
    assert wanting == []


def test_no_path_of_a_machine_and_no_package_index_is_committed():
    assert HOME.search("see /home/someone/x")
    assert not HOME.search("#!/bin/sh and docs/home/page")
    assert INDEX.search("--index-url https://pypi.example.org/simple")
    assert not INDEX.search("https://pypi.org/project/gmsh")
    found = []
    for path in tracked():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        if path == Path(__file__).resolve():
            continue
        found += [
            f"{path.relative_to(ROOT)}: {match.group()}"
            for pattern in (HOME, INDEX)
            for match in pattern.finditer(text)
        ]
    assert found == []


def test_the_drawing_of_the_house_is_as_its_imports_are():
    assert MAP["drawing"]() == MAP["PICTURE"].read_text(encoding="utf-8")


TEXTS = {"id", "title", "citation", "quantity", "section", "label", "caption", "message"}
TAKEN_APART = {
    *("startswith", "endswith", "partition", "rpartition", "split", "rsplit", "splitlines"),
    *("removeprefix", "removesuffix", "find", "index", "strip", "isdecimal"),
}


def parsed_texts(tree: ast.AST) -> list[str]:
    """Where an id, a title or the like is taken apart: what is meant has a field of its own."""

    def is_text(node: ast.AST) -> bool:
        return isinstance(node, ast.Attribute) and node.attr in TEXTS

    found = []
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Attribute(value=of, attr=name), args=args):
                by_pattern = isinstance(of, ast.Name) and of.id == "re" and any(map(is_text, args))
                parsed = by_pattern or (name in TAKEN_APART and is_text(of))
            case ast.Compare(ops=ops, comparators=[*others]):
                within = zip(ops, others, strict=True)
                parsed = any(
                    isinstance(op, ast.In | ast.NotIn) and is_text(of) for op, of in within
                )
            case ast.Subscript(value=of):
                parsed = is_text(of)
            case _:
                parsed = False
        if parsed:
            found.append(ast.unparse(node))
    return found


def test_nothing_is_parsed_out_of_ids_and_titles():
    for text in ("case.id.startswith('robot.')", "'solid' in case.title", "case.quantity[0]"):
        assert parsed_texts(ast.parse(text)), text
    found = {
        str(module.relative_to(ROOT)): parsed
        for module in sorted((ROOT / "validation").rglob("*.py"))
        if (parsed := parsed_texts(ast.parse(module.read_text(encoding="utf-8"))))
    }
    assert found == {}
