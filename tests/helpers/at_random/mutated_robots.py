"""Robot files with something done to them, always the same for one seed, sound or not.

What slips while one edits a table (a key lost, renamed, a value in another's place), and values
that nobody means.
"""

import json
import math
import random
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

from sound_biglide import SOUND

import lumped.robots

NAMES = ("five-bar", "3-rrr", "delta", "orthoglide", "hexapod")
_FOLDER = Path(lumped.robots.__file__).parent
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
    """Ways to all entries of nested tables and lists."""
    entries = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in entries:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


def _at(tree: Any, path: _Path) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _mutated(rng: random.Random, tree: dict[str, Any]) -> dict[str, Any]:
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


def _toml(value: Any) -> str:
    match value:
        case bool():
            return str(value).lower()
        case float() | int():
            return repr(value)
        case str():
            return json.dumps(value)
        case list():
            return f"[{', '.join(map(_toml, value))}]"
    entries = (f"{json.dumps(key)} = {_toml(one)}" for key, one in value.items())
    return f"{{ {', '.join(entries)} }}"


def mutated_robots(count: int, seed: int) -> Iterator[str]:
    """`count` files, of a biglide of schema 1 and of every kind of mechanism in turn."""
    rng = random.Random(seed)  # noqa: S311  any choice will do
    texts = [SOUND, *((_FOLDER / f"{name}.toml").read_text(encoding="utf-8") for name in NAMES)]
    sound = [tomllib.loads(text) for text in texts]
    for number in range(count):
        tree = _mutated(rng, sound[number % len(sound)])
        yield "".join(f"{json.dumps(key)} = {_toml(value)}\n" for key, value in tree.items())
