"""Robot files with random changes, equal for equal seeds, valid or not.

The changes are slips of editing (a key is lost or renamed, a value is at another key) and absurd
values.
"""

import json
import math
import random
from collections.abc import Iterator
from copy import deepcopy
from functools import partial
from typing import Any

_VALUES: tuple[Any, ...] = (
    *(0, -1, 1, 10**30, 2**63 - 1, True, 1e300, 1e-300, 5e-324, -1e-9, -0.0, math.nan, math.inf),
    *("", "ground", "A", "rigid", "x" * 5000, "\x1b[2J\u202e", [], {}, [[]], [1.0], ["x", "x"]),
    *([[1, 2], [3]], {"shape": []}, [math.inf] * 3, ["a", "b"], [["a"]]),
    *([0.0] * 3, [1.0, 0.0, 0.0], [math.nan] * 3, [1e300] * 3, [0.0, 0.0, 1e-12]),
    *(["ground", "ground"], ["x", "y", "z", "phi_x", "phi_y", "phi_z"], [[1.0, 0.0, 0.0]] * 2),
)
_KEYS = ("x", "ground", "", "a.b", "\u202e", "k" * 3000, "P")
_FACTORS = (-1.0, 0.0, 1e6, 1e-6, 1.001, 3.0)
_Path = tuple[str | int, ...]


def places(tree: Any, path: _Path = ()) -> Iterator[_Path]:
    """Paths to all entries of nested tables and lists."""
    entries = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in entries:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


def _at(tree: Any, path: _Path) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def mutated(rng: random.Random, tree: dict[str, Any]) -> dict[str, Any]:
    """Nested tables in which one to three entries are removed, renamed or replaced."""
    tree = deepcopy(tree)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        ways = list(places(tree))
        path, other = rng.choice(ways), rng.choice(ways)
        table, key = _at(tree, path[:-1]), path[-1]
        match rng.randrange(5):
            case 0:
                del table[key]
            case 1:
                table[key] = deepcopy(rng.choice(_VALUES))
            case 2:
                table[key] = deepcopy(_at(tree, other))
            case 3 if isinstance(table, dict):
                table[rng.choice(_KEYS)] = table.pop(key)
            case _ if isinstance(table[key], float):
                table[key] *= rng.choice(_FACTORS)
    return tree


def toml(tables: dict[str, Any]) -> str:
    """TOML text of the tables, with nested tables and lists as inline values."""
    inline = partial(json.dumps, separators=(", ", " = "))
    text = "".join(f"{json.dumps(key)} = {inline(value)}\n" for key, value in tables.items())
    return text.replace("NaN", "nan").replace("Infinity", "inf")
