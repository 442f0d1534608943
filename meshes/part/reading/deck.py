"""Nodes, elements and node sets of an Abaqus or CalculiX input deck (.inp).

The syntax is that of CalculiX: blanks and case are not significant, lines that begin with ** are
comments, omitted coordinates are zero, GENERATE without a third value has the increment 1, elements
continue over lines until they have all their nodes, and a repeated set is extended. As in Abaqus,
keyword lines may continue after a comma, and parts and instances number their own nodes. *INCLUDE
inserts the lines of another file in the folder of the deck or below it.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from lumped.errors import InputError
from lumped.robot_file.included import DeckLine, deck_lines
from lumped.text import shown

# Keywords that create or move nodes and elements and are not supported. The only supported system
# of coordinates in the options of *NODE and *ELEMENT.
_UNSUPPORTED = frozenset({"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM"})
_CARTESIAN = "R"
# Options without a value that may occur alone on a continued keyword line.
_FLAGS = frozenset({"GENERATE", "INTERNAL", "UNSORTED"})
# Names of solid elements for stress and heat: the digits are the number of nodes, the letters that
# follow are formulations. Elements with 6 and 15 nodes are wedges.
_SOLID = re.compile(r"D?C3D(\d+)[A-Z]*")
_KIND = {
    4: "tetra",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    15: "wedge15",
    20: "hexahedron20",
}
# Names of other elements: shells, membranes, plane elements, beams, trusses, rigid surfaces,
# springs, dampers, masses, gaps and connectors.
_NO_SOLID = re.compile(
    r"(?:S\d|DS\d|STRI|SAX|SFM|M3D|CPS|CPE|CAX|DC2D|DCAX|R2D|R3D|RAX|RB\d|B\d\d|T\dD|PIPE|ELBOW"
    r"|FRAME|D$|D\d|SPRING|DASHPOT|MASS|ROTARYI|GAP|DCOUP|CONN|JOINTC|HEATCAP)"
)
# Text of the number of a node or an element.
_WHOLE = re.compile(r"\+?\d{1,18}", re.ASCII)
# A number in a notation of Fortran: 1.5D+3, or 1.5+3.
_FORTRAN = re.compile(r"([+-]?\d*\.?\d*)[DQdq]?([+-]?\d+)")

# Numbers of nodes or elements in a set.
Members: TypeAlias = list[int | range]


@dataclass(frozen=True)
class _Card:
    """A keyword of a deck with its options and the data lines below it, split into fields.

    `line` is the line with the keyword. `keyword` and the names of `options` are in capitals
    without blanks. The values of options are as in the file. `data` contains each data line with
    its fields.
    """

    line: DeckLine
    keyword: str
    options: dict[str, str]
    data: list[tuple[DeckLine, list[str]]]


@dataclass
class _Scope:
    """Nodes, elements and sets of a part, an instance, the assembly, or of the deck itself.

    Each scope has its own numbering of nodes and elements. `nodes` contains the index in the
    `points` of the deck for each node number. `elements` contains the node numbers of each element,
    by element number. Sets are keyed by their name in capitals.
    """

    nodes: dict[int, int] = field(default_factory=dict)
    elements: dict[int, list[int]] = field(default_factory=dict)
    node_sets: dict[str, Members] = field(default_factory=dict)
    element_sets: dict[str, Members] = field(default_factory=dict)


@dataclass
class _Deck:
    """Content of a deck while it is read.

    `points` (m or the unit of the deck) are the positions of all nodes of all scopes. `blocks`
    contains the solid elements by their type in meshio, each as a scope and its node numbers in
    this scope. `titles` contains the names of node sets as typed, by the name in capitals. `scopes`
    contains the scopes by keyword and name, "" for the deck itself. `open_scopes` are the keys of
    the scopes that have been opened and not closed, the innermost last.
    """

    path: Path
    points: list[tuple[float, float, float]] = field(default_factory=list)
    blocks: dict[str, list[tuple[_Scope, list[int]]]] = field(default_factory=dict)
    titles: dict[str, str] = field(default_factory=dict)
    scopes: dict[str, _Scope] = field(default_factory=lambda: {"": _Scope()})
    open_scopes: list[str] = field(default_factory=lambda: [""])

    @property
    def scope(self) -> _Scope:
        return self.scopes[self.open_scopes[-1]]


def read_deck(path: Path) -> Any:
    """Mesh of a deck as a meshio object: points, solid elements and node sets.

    Raises InputError with the line of a faulty or unsupported entry.
    """
    import meshio  # noqa: PLC0415  slow to import, and needed only for such files

    deck = _Deck(path)
    for card in _cards(deck_lines(path)):
        _require_supported(card)
        _open_scope(deck, card)
        if card.keyword == "NODE":
            _read_nodes(deck, card)
        elif card.keyword == "ELEMENT":
            _read_elements(deck, card)
        elif card.keyword in ("NSET", "ELSET"):
            _read_set(deck, card)
    cells = []
    for kind, elements in deck.blocks.items():
        rows = [[_row(deck, scope, node) for node in nodes] for scope, nodes in elements]
        cells.append((kind, np.array(rows, dtype=np.int64)))
    points = np.array(deck.points, dtype=float).reshape(-1, 3)
    return meshio.Mesh(points, cells, point_sets=_point_sets(deck))


def _cards(lines: Iterable[DeckLine]) -> Iterator[_Card]:
    card, goes_on = None, False
    for line in lines:
        text = line.text.strip()
        if not text or text.startswith("**"):
            continue
        fields = [part.strip() for part in text.split(",")]
        if text.startswith("*"):
            if card:
                yield card
            card = _Card(line, _plain(fields[0][1:]), _options(fields[1:]), [])
            goes_on = not fields[-1]
        elif card and goes_on and all(map(_is_option, filter(None, fields))):
            card.options.update(_options(fields))
            goes_on = not fields[-1]
        elif card:
            card.data.append((line, fields))
            goes_on = False
    if card:
        yield card


def _plain(word: str) -> str:
    return "".join(word.split()).upper()


def _is_option(text: str) -> bool:
    return "=" in text or _plain(text) in _FLAGS


def _options(fields: Iterable[str]) -> dict[str, str]:
    pairs = (text.partition("=") for text in fields if text)
    return {_plain(name): value.strip().strip('"') for name, _, value in pairs}


def _require_supported(card: _Card) -> None:
    """Raise InputError for a card that would change the mesh and is not supported.

    Materials, steps and other cards that do not affect nodes and elements are ignored.
    """
    wrong = [f"*{card.keyword}"] if card.keyword in _UNSUPPORTED else []
    if card.keyword in ("NODE", "ELEMENT"):
        wrong += [f"INPUT of *{card.keyword}"] if "INPUT" in card.options else []
        if card.options.get("SYSTEM", _CARTESIAN).upper() != _CARTESIAN:
            wrong.append(f"SYSTEM of *{card.keyword}")
    if card.keyword == "INSTANCE" and card.data:
        wrong.append("the place of *INSTANCE")
    if wrong:
        raise card.line.fault(
            f"{wrong[0]} is not supported; write all nodes and elements of the part into this "
            "file, in Cartesian coordinates",
        )


def _open_scope(deck: _Deck, card: _Card) -> None:
    """Open or close the scope of a part, an instance or the assembly.

    Other cards have no effect. Each scope has its own numbering of nodes and elements. An instance
    of a part shares the scope of this part.
    """
    name = card.options.get("NAME", "").upper()
    if card.keyword in ("PART", "ASSEMBLY", "INSTANCE"):
        part = f"PART {card.options.get('PART', '').upper()}"
        key = f"{card.keyword} {name}"
        if card.keyword == "INSTANCE" and part in deck.scopes:
            deck.scopes[key] = deck.scopes[part]
        deck.scopes.setdefault(key, _Scope())
        deck.open_scopes.append(key)
    elif card.keyword in ("ENDPART", "ENDASSEMBLY", "ENDINSTANCE") and len(deck.open_scopes) > 1:
        deck.open_scopes.pop()


def _read_nodes(deck: _Deck, card: _Card) -> None:
    numbers: Members = []
    for line, fields in card.data:
        number = _whole(line, fields[0])
        x, y, z = (_real(line, text) for text in (*fields[1:4], "", "", "")[:3])
        deck.scope.nodes[number] = len(deck.points)
        deck.points.append((x, y, z))
        numbers.append(number)
    _add_node_set(deck, deck.scope, card.options.get("NSET", ""), numbers)


def _add_node_set(deck: _Deck, scope: _Scope, title: str, members: Members) -> None:
    if title:
        deck.titles.setdefault(title.upper(), title)
        scope.node_sets.setdefault(title.upper(), []).extend(members)


def _read_elements(deck: _Deck, card: _Card) -> None:
    kind, count = _solid_kind(card)
    numbers: Members = []
    element: list[int] = []
    line = card.line
    for line, fields in card.data if kind else ():
        element += [_whole(line, text) for text in fields if text]
        if len(element) > count + 1:
            break
        if len(element) == count + 1:
            number, *nodes = element
            if number in deck.scope.elements:
                raise line.fault(f"element {number} is given twice; delete one of them")
            deck.scope.elements[number] = nodes
            deck.blocks.setdefault(kind, []).append((deck.scope, nodes))
            numbers.append(number)
            element = []
    if element:
        raise line.fault(
            f"element {element[0]} has {len(element) - 1} nodes; must have {count} "
            f"(type {card.options['TYPE']})",
        )
    if name := card.options.get("ELSET", "").upper():
        deck.scope.element_sets.setdefault(name, []).extend(numbers)


def _solid_kind(card: _Card) -> tuple[str, int]:
    """Name in meshio of the type of the elements below a card, and their number of nodes.

    The name is "" if the elements are not solid. Raises InputError for elements of an unknown type,
    which might be solid.
    """
    name = card.options.get("TYPE", "")
    solid = _SOLID.fullmatch(name.upper())
    count = int(solid[1]) if solid else 0
    if count in _KIND:
        return _KIND[count], count
    if not solid and _NO_SOLID.match(name.upper()):
        return "", 0
    names = ", ".join(f"C3D{count}" for count, kind in _KIND.items() if "wedge" not in kind)
    raise card.line.fault(
        f"elements of the type {shown(name)} are not known here; must be {names} with any letters "
        "behind, or no solid",
    )


def _read_set(deck: _Deck, card: _Card) -> None:
    title = card.options.get(card.keyword, "")
    if not title:
        raise card.line.fault(f"*{card.keyword} must have a name: {card.keyword}=…")
    instance = card.options.get("INSTANCE")
    scope = None if instance is None else _instance(deck, card.line, instance)
    members: Members = []
    for line, fields in card.data:
        words = [text for text in fields if text]
        if "GENERATE" in card.options:
            members += [_generated(line, words)] if words else []
            continue
        for text in words:
            scope, new_members = _members(deck, card.keyword, line, text, scope)
            members += new_members
    scope = scope or deck.scope
    if card.keyword == "ELSET":
        scope.element_sets.setdefault(title.upper(), []).extend(members)
        return
    elements = scope.element_sets.get(card.options.get("ELSET", "").upper(), [])
    for number in _present(elements, scope.elements):
        members += scope.elements[number]
    _add_node_set(deck, scope, title, members)


def _generated(line: DeckLine, words: list[str]) -> range:
    """Members of a set with GENERATE, from its `words`: first, last and increment (default 1)."""
    first, *rest = (_whole(line, text) for text in words)
    last, step = (*rest, 1)[:2] if rest else (first, 1)
    if step < 1:
        raise line.fault(f"the step of GENERATE is {step}; must be at least 1")
    return range(first, last + 1, step)


def _members(
    deck: _Deck, keyword: str, line: DeckLine, text: str, scope: _Scope | None
) -> tuple[_Scope | None, Members]:
    """Scope and members that one value in the data of a set adds to the set.

    `text` is the value: the number of a node or element, or the name of a set above it, whose
    members are added. `keyword` is NSET or ELSET. The value may be preceded by the name of an
    instance and a full stop. The returned scope is then the scope of this instance, otherwise the
    given `scope`, which is None for the scope that is open.
    """
    name = text.strip('"')
    if _WHOLE.fullmatch(name):
        return scope, [int(name)]
    current_scope = scope or deck.scope
    sets = current_scope.element_sets if keyword == "ELSET" else current_scope.node_sets
    if name.upper() in sets:
        return scope, list(sets[name.upper()])
    instance, point, remainder = name.partition(".")
    if point:
        return _members(deck, keyword, line, remainder, _instance(deck, line, instance))
    raise line.fault(f"there is no *{keyword} {shown(name)} above it, and no such number")


def _instance(deck: _Deck, line: DeckLine, name: str) -> _Scope:
    key = f"INSTANCE {name.strip().upper()}"
    if key not in deck.scopes:
        raise line.fault(f"there is no *INSTANCE {shown(name)} above it")
    return deck.scopes[key]


def _point_sets(deck: _Deck) -> dict[str, np.ndarray[Any, Any]]:
    """Indices of the points in each node set, by the name of the set as typed.

    Numbers in a set that belong to no node are ignored. CalculiX ignores them, too, with a warning.
    """
    rows: dict[str, list[int]] = {}
    for scope in {id(scope): scope for scope in deck.scopes.values()}.values():
        for name, members in scope.node_sets.items():
            set_rows = [scope.nodes[number] for number in _present(members, scope.nodes)]
            rows.setdefault(deck.titles[name], []).extend(set_rows)
    return {
        title: np.unique(np.array(set_rows, dtype=np.int64)) for title, set_rows in rows.items()
    }


def _present(members: Members, numbers: dict[int, Any]) -> list[int]:
    """Numbers in the `members` of a set that are keys of `numbers`."""
    present: list[int] = []
    for member in members:
        if isinstance(member, int):
            present += [member] if member in numbers else []
        elif len(member) < len(numbers):
            present += [number for number in member if number in numbers]
        else:
            present += [number for number in numbers if number in member]
    return present


def _row(deck: _Deck, scope: _Scope, node: int) -> int:
    if node not in scope.nodes:
        raise InputError(
            f"{deck.path}: cannot be read as a mesh: the file refers to node {node}, which it "
            "does not contain"
        )
    return scope.nodes[node]


def _whole(line: DeckLine, text: str) -> int:
    if not _WHOLE.fullmatch(text):
        raise line.fault(f"{shown(text)} is no number of a node or an element")
    return int(text)


def _real(line: DeckLine, text: str) -> float:
    """A coordinate from its text. Zero if the text is empty, because the coordinate is omitted."""
    if not text:
        return 0.0
    try:
        return float(text.replace("_", "?"))
    except ValueError:
        number = _FORTRAN.fullmatch(text)
    try:
        return float(f"{number[1]}e{number[2]}" if number else "?")
    except ValueError:
        raise line.fault(f"{shown(text)} is no number") from None
