"""A mistake as a small reversible change: one function of a model replaced by a faulty one."""

import gc
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property, wraps
from importlib import import_module
from types import ModuleType
from typing import Any, Literal, TypeAlias

FaultKind: TypeAlias = Literal["physics", "numerics", "data"]
Faulty: TypeAlias = Callable[..., Any]
# From the sound function to the faulty one.
Change: TypeAlias = Callable[[Faulty], Faulty]

PACKAGES = ("lumped", "meshes", "fem", "validation")


@dataclass(frozen=True)
class Fault:
    """A mistake that somebody could make.

    `where` is "module:function", "module:Class.method" or "module:Class.property"; `change` makes
    the faulty function from the sound one.
    """

    id: str
    title: str
    where: str
    kind: FaultKind
    change: Change

    @contextmanager
    def inject(self) -> Iterator[None]:
        """The mistake is made as long as the context lasts, wherever the function is used."""
        with replaced({self.where: self.change}):
            yield


@contextmanager
def replaced(changes: Mapping[str, Change]) -> Iterator[None]:
    """Functions by their place, each replaced in every module of this project that has it.

    Values cached by the project's functions and objects are dropped, before and after.
    """
    with ExitStack() as stack:
        stack.callback(forget)
        for where, change in changes.items():
            owner, name = _place(where)
            for holder, attribute, sound, faulty in _replacements(owner, name, change):
                stack.callback(setattr, holder, attribute, sound)
                setattr(holder, attribute, faulty)
        forget()
        yield


def result(change: Callable[[Any], Any]) -> Change:
    """The function's value is changed."""

    def make(sound: Faulty) -> Faulty:
        @wraps(sound)
        def faulty(*args: Any, **kwargs: Any) -> Any:
            return change(sound(*args, **kwargs))

        return faulty

    return make


def instead(function: Faulty) -> Change:
    """Another function takes its place."""

    def make(sound: Faulty) -> Faulty:
        @wraps(sound)
        def faulty(*args: Any, **kwargs: Any) -> Any:
            return function(*args, **kwargs)

        return faulty

    return make


def around(function: Faulty) -> Change:
    """`function(sound, *arguments)` takes its place: the arguments are changed, or the value."""

    def make(sound: Faulty) -> Faulty:
        @wraps(sound)
        def faulty(*args: Any, **kwargs: Any) -> Any:
            return function(sound, *args, **kwargs)

        return faulty

    return make


def sound_function(where: str) -> Faulty:
    """The function at a place, of a property that which computes it."""
    owner, name = _place(where)
    return _function(vars(owner)[name])


def forget() -> None:
    """Drop what the project's functions and objects have cached."""
    forget_functions()
    cached: dict[type, tuple[str, ...]] = {}
    for thing in gc.get_objects():
        kind = type(thing)
        if kind not in cached:
            cached[kind] = _cached_names(kind)
        for name in cached[kind]:
            vars(thing).pop(name, None)


def forget_functions() -> None:
    """Drop what the project's functions have cached."""
    for module in _modules():
        for value in list(vars(module).values()):
            if callable(value) and hasattr(value, "cache_clear"):
                value.cache_clear()


def _cached_names(kind: type) -> tuple[str, ...]:
    if str(kind.__module__).partition(".")[0] not in PACKAGES:
        return ()
    return tuple(
        name
        for base in kind.__mro__
        for name, value in vars(base).items()
        if isinstance(value, cached_property)
    )


def _place(where: str) -> tuple[Any, str]:
    module, _, path = where.partition(":")
    *outer, name = path.split(".")
    owner: Any = import_module(module)
    for step in outer:
        owner = getattr(owner, step)
    return owner, name


def _replacements(owner: Any, name: str, change: Change) -> list[tuple[Any, str, Any, Any]]:
    """Holder, attribute, sound and faulty value of each place that holds the function."""
    sound = vars(owner)[name]
    faulty = _rebuilt(sound, change)
    if not isinstance(owner, ModuleType):
        return [(owner, name, sound, faulty)]
    return [
        (module, attribute, sound, faulty)
        for module in _modules()
        for attribute, value in list(vars(module).items())
        if value is sound
    ]


def _function(value: Any) -> Faulty:
    match value:
        case property(fget=getter) if getter is not None:
            return getter
        case cached_property():
            return value.func
        case classmethod() | staticmethod():
            return value.__func__
        case _:
            function: Faulty = value
            return function


def _rebuilt(value: Any, change: Change) -> Any:
    """A function, property or method of the same kind with the change made."""
    faulty = change(_function(value))
    match value:
        case property():
            return property(faulty)
        case cached_property():
            made: Any = cached_property(faulty)
            made.attrname = value.attrname
            return made
        case classmethod():
            return classmethod(faulty)
        case staticmethod():
            return staticmethod(faulty)
        case _:
            return faulty


def _modules() -> list[ModuleType]:
    return [
        module
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in PACKAGES and module is not None
    ]
