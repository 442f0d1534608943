"""Draws docs/pictures/architecture.svg from the imports: rooms in rows, each above what it uses.

    python docs/pictures/architecture.py

A room is a folder of one of the four packages, or a module that lies loose in it. Its row is one
above the highest row that it imports from, so that every import points downwards.
"""

import ast
from collections.abc import Iterable, Mapping
from functools import cache
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PICTURE = Path(__file__).with_suffix(".svg")
FLOORS = ("validation", "fem", "meshes", "lumped")
COLOURS = {"validation": "#dbe9f6", "fem": "#e3f1dd", "meshes": "#fbeed5", "lumped": "#f3e1e7"}
# In px: of the picture, of a line, of the columns with packages and rooms; of a letter.
WIDTH, LINE, FLOOR, ROOM, LETTER = 1040, 23, 100, 230, 6.9


def modules() -> dict[str, Path]:
    """Dotted name and file of every module and package of the house."""
    found = {}
    for floor in FLOORS:
        for path in sorted((ROOT / floor).rglob("*.py")):
            name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
            found[name.removesuffix(".__init__")] = path
    return found


def room_of(name: str) -> str:
    """The folder of a package, or the loose module, that a module belongs to."""
    return ".".join(name.split(".")[:2])


def imports(path: Path, known: Mapping[str, Path]) -> set[str]:
    """Modules of the house that a file imports, wherever in it."""
    return imported(path) & set(known)


@cache
def imported(path: Path) -> set[str]:
    """Modules that a file imports, and whatever else it imports from them."""
    named: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            named |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            named |= {str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)}
    return named


def uses() -> dict[str, set[str]]:
    """Rooms that each room imports from."""
    known = modules()
    found: dict[str, set[str]] = {room_of(name): set() for name in known if name not in FLOORS}
    for name, path in known.items():
        if name in FLOORS:
            continue
        others = {room_of(one) for one in imports(path, known) if one not in FLOORS}
        found[room_of(name)] |= others - {room_of(name)}
    return found


def rows(floor: str, used: Mapping[str, set[str]]) -> list[list[str]]:
    """Rooms of a package, lowest row first. Raises RecursionError where rooms use each other."""
    level: dict[str, int] = {}

    def row(room: str) -> int:
        if room not in level:
            own = (row(one) for one in used[room] if one.startswith(f"{floor}."))
            level[room] = 1 + max(own, default=-1)
        return level[room]

    for room in used:
        if room.startswith(f"{floor}."):
            row(room)
    return [
        sorted(room for room, at in level.items() if at == number)
        for number in range(max(level.values()) + 1)
    ]


def sentence(room: str) -> str:
    """The first sentence of a room's docstring."""
    path = ROOT.joinpath(*room.split("."))
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    said = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or ""
    return said.split("\n\n")[0].replace("\n", " ").replace("`", "")


def lines(row: Iterable[str]) -> list[str]:
    """A room on each line, with place for what it says of itself; folders first."""
    return sorted(row, key=lambda room: (not is_folder(room), room))


def is_folder(room: str) -> bool:
    """Whether a room is a package rather than a module."""
    return ROOT.joinpath(*room.split(".")).is_dir()


def drawing() -> str:
    """The picture as SVG."""
    used = uses()
    parts: list[str] = []
    y = 0.0
    for floor in FLOORS:
        stacked = [line for row in reversed(rows(floor, used)) for line in lines(row)]
        height = len(stacked) * LINE + 10
        parts.append(
            f'<rect x="0" y="{y:g}" width="{WIDTH}" height="{height}" fill="{COLOURS[floor]}"/>'
            f'<text class="floor" x="12" y="{y + 22:g}">{floor}</text>'
        )
        for number, line in enumerate(stacked):
            parts.append(line_of(line, y + 22 + number * LINE))
        y += height + 4
    style = (
        "text{font:13px system-ui,sans-serif;fill:#222}.floor,.room{font-weight:600}"
        ".loose{font-style:italic;fill:#445}"
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y - 4:g}" role="img">'
        f"<title>Rooms of the house, each above what it imports</title><style>{style}</style>\n"
        + "\n".join(parts)
        + "</svg>\n"
    )


def line_of(room: str, y: float) -> str:
    """A room and its sentence."""
    said, most = sentence(room), int((WIDTH - ROOM - 12) / LETTER)
    if len(said) > most:
        said = said[:most].rsplit(" ", 1)[0].rstrip(",;:") + " …"
    kind, ending = ("room", "/") if is_folder(room) else ("loose", ".py")
    return (
        f'<text class="{kind}" x="{FLOOR}" y="{y:g}">{room.split(".")[1]}{ending}</text>'
        f'<text x="{ROOM}" y="{y:g}">{escape(said)}</text>'
    )


if __name__ == "__main__":
    PICTURE.write_text(drawing(), encoding="utf-8")
