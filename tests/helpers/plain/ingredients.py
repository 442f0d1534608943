"""What a comparison takes from the memo of its context, and each of it made wrong in turn."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cache
from typing import Any, ParamSpec, TypeVar

import numpy as np

from lumped.robot_file import load_robot
from validation.context import Context, memo_key

P = ParamSpec("P")
T = TypeVar("T")
# What both sides of a comparison are about: the robot's data and its postures.
DATA = ("lumped.legs.equivalent_leg ", "validation.adequacy.mechanism.path._postures ")


@dataclass(frozen=True)
class Asked(Context):
    """A context that notes which entries of its memo are asked for, and lets one be exchanged."""

    asked: set[str] = field(default_factory=set, repr=False, compare=False)

    def get(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """As that of a context."""
        self.asked.add(memo_key(function, args, kwargs))
        return super().get(function, *args, **kwargs)

    def with_other(self, key: str, value: object) -> Context:
        """A plain context with one entry exchanged."""
        memo = {**self._memo, key: value}
        return Context(self.robot_file, self.preset, self.options, memo, finer=self.finer)

    def entry(self, key: str) -> object:
        """What the memo holds."""
        return self._memo[key]


@cache
def quick_context(name: str) -> Asked:
    """One for all tests of a process: what they share is computed once."""
    return Asked(load_robot(name), "quick")


def disturbed(value: Any, share: float) -> Iterator[Any]:
    """The value with one of its arrays or numbers larger by `share`, each in turn."""
    if isinstance(value, float | np.floating):
        yield value * (1.0 + share)
    elif isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and value.size:
            yield value * (1.0 + share)
    elif isinstance(value, dict):
        for key in value:
            yield from ({**value, key: other} for other in disturbed(value[key], share))
    elif type(value) in (tuple, list):
        for place, item in enumerate(value):
            for other in disturbed(item, share):
                yield type(value)([*value[:place], other, *value[place + 1 :]])
    elif is_dataclass(value) and not isinstance(value, type):
        for name in (one.name for one in fields(value) if one.init):
            for other in disturbed(getattr(value, name), share):
                yield replace(value, **{name: other})
