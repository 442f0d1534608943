"""What a case may use: the robot, the preset, and results that other cases computed before."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from hashlib import blake2b
from pathlib import PurePath
from typing import Any, Literal, ParamSpec, TypeAlias, TypeVar

import msgspec
import numpy as np

from lumped.robot_file import RobotFile

Preset: TypeAlias = Literal["quick", "standard", "fine"]
About: TypeAlias = Literal["robot", "leg"]
PRESETS: tuple[Preset, ...] = ("quick", "standard", "fine")
# The robot whose numbers the paper prints.
BUILT_IN = "ifw"
# The option that holds the run's folder of finished units of sweeps, if its session names one.
SWEEPS_FOLDER = "sweeps"
P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class Context:
    """Robot file, preset and options of a run, and a memo of expensive results.

    `context.get(solid_leg, leg, divisions)` is `solid_leg(leg, divisions)`, computed once per
    process for equal arguments. The function must be pure and defined at the top of a module.
    """

    robot_file: RobotFile
    preset: Preset = "standard"
    options: Mapping[str, str] = field(default_factory=dict)
    _memo: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def get(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The function's value for these arguments, from the memo if it has been computed."""
        return self.recall(memo_key(function, args, kwargs), lambda: function(*args, **kwargs))

    def recall(self, key: str, compute: Callable[[], T]) -> T:
        """The memo's entry of a key, computed where there is none."""
        if key not in self._memo:
            self._memo[key] = compute()
        value: T = self._memo[key]
        return value


def memo_key(
    function: Callable[..., object], args: tuple[object, ...], kwargs: Mapping[str, object]
) -> str:
    """Name of the function and hash of its arguments; ValueError for one without a fixed name."""
    name = f"{function.__module__}.{function.__qualname__}"
    if "<" in name:
        raise ValueError(f"{name}: only functions at the top of a module have a fixed name")
    return f"{name} {fingerprint((args, dict(kwargs)))}"


def fingerprint(value: object) -> str:
    """Hash of plain data: numbers, texts, paths, arrays, frozen records, and collections of them.

    Equal data give equal hashes in every process. Raises TypeError for anything else.
    """
    digest = blake2b(digest_size=16)
    _feed(digest.update, value)
    return digest.hexdigest()


def _feed(update: Callable[[bytes], object], value: Any) -> None:
    match value:
        case np.ndarray():
            update(f"array {value.dtype.str} {value.shape} ".encode())
            update(np.ascontiguousarray(value).tobytes())
        case PurePath():
            update(f"path {value};".encode())
        case None | bool() | int() | float() | complex() | str() | bytes() | np.generic():
            update(f"{type(value).__name__} {value!r};".encode())
        case tuple() | list():
            update(f"sequence {len(value)} ".encode())
            for item in value:
                _feed(update, item)
        case dict():
            update(f"mapping {len(value)} ".encode())
            for key in sorted(value):
                _feed(update, key)
                _feed(update, value[key])
        case _ if is_dataclass(value) and not isinstance(value, type):
            update(f"record {type(value).__module__}.{type(value).__qualname__} ".encode())
            # What serves messages alone makes no other record of it.
            for entry in (entry for entry in fields(value) if entry.compare):
                _feed(update, getattr(value, entry.name))
        case msgspec.Struct():
            update(f"record {type(value).__module__}.{type(value).__qualname__} ".encode())
            _feed(update, msgspec.structs.astuple(value))
        case _ if callable(value) and hasattr(value, "__qualname__"):
            update(f"function {value.__module__}.{value.__qualname__};".encode())
        case _:
            raise TypeError(f"{type(value).__name__} is no plain data: it cannot key the memo")
