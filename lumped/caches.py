"""Caches that can be emptied, as when a model is about to be changed under what was kept of it.

They are functools' own, and tell where they are when they first keep something.
"""

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar
from weakref import WeakValueDictionary

P = ParamSpec("P")
T = TypeVar("T")

_FUNCTIONS: list[Callable[[], None]] = []
# Objects by their address and the name of what they keep.
_HOLDERS: WeakValueDictionary[tuple[int, str], object] = WeakValueDictionary()

if TYPE_CHECKING:
    from functools import cached_property as cached_property  # noqa: PLC0414  exported
else:

    class cached_property(functools.cached_property):  # noqa: N801  it is functools' own
        """functools.cached_property, computed again after `forget`."""

        def __get__(self, instance: object, owner: type | None = None) -> Any:
            """The value to be kept; what is kept already is not asked for here."""
            if instance is not None:
                _HOLDERS[id(instance), self.attrname] = instance
            return super().__get__(instance, owner)


def lru_cache(maxsize: int | None) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """functools.lru_cache, emptied by `forget`."""

    def kept(function: Callable[P, T]) -> Callable[P, T]:
        made = functools.lru_cache(maxsize)(function)
        _FUNCTIONS.append(made.cache_clear)
        return made  # type: ignore[return-value]

    return kept


def on_forget(clear: Callable[[], None]) -> None:
    """Have `forget` call this too, for what is kept in another way."""
    _FUNCTIONS.append(clear)


def forget() -> None:
    """Drop what functions and objects keep."""
    for clear in _FUNCTIONS:
        clear()
    for (_, name), thing in list(_HOLDERS.items()):
        vars(thing).pop(name, None)
    _HOLDERS.clear()
