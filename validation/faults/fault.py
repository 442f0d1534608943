"""A mistake as a small reversible change: one function of a model replaced by a faulty one."""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from types import ModuleType
from typing import Any, TypeAlias, TypeVar

from lumped.caches import cached_property, forget

Faulty: TypeAlias = Callable[..., Any]
# From the sound function to the faulty one.
Change: TypeAlias = Callable[[Faulty], Faulty]
F = TypeVar("F", bound=Faulty)

PACKAGES = ("lumped", "meshes", "fem", "validation")
_DECLARED: dict[str, "Fault"] = {}


@dataclass(frozen=True)
class Fault:
    """A mistake that somebody could make.

    `where` is "module.function", "module.Class.method" or "module.Class.property"; `change` makes
    the faulty function from the sound one.
    """

    id: str
    title: str
    where: str
    change: Change

    @contextmanager
    def inject(self) -> Iterator[None]:
        """The mistake is made as long as the context lasts, wherever the function is used."""
        with replaced({self.where: self.change}):
            yield


def fault(identifier: str, title: str, where: str) -> Callable[[F], F]:
    """Declare that the function below, put in place of that at `where`, is a mistake."""
    return _declared(identifier, title, where, _instead)


def fault_around(identifier: str, title: str, where: str) -> Callable[[F], F]:
    """The same of a function that gets the sound one, and then its arguments."""
    return _declared(identifier, title, where, around)


def fault_in_value(identifier: str, title: str, where: str) -> Callable[[F], F]:
    """The same of a function that gets the sound one's value."""
    return _declared(identifier, title, where, _of_value)


def declared() -> tuple[Fault, ...]:
    """The faults of all modules that have been imported."""
    return tuple(_DECLARED.values())


@contextmanager
def replaced(changes: Mapping[str, Change]) -> Iterator[None]:
    """Functions by their place, each replaced in every module of this project that has it.

    What functions and objects keep of their values is dropped, before and after.
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


def around(function: Faulty) -> Change:
    """`function(sound, *arguments)` takes its place: the arguments are changed, or the value."""

    def make(sound: Faulty) -> Faulty:
        @wraps(sound)
        def faulty(*args: Any, **kwargs: Any) -> Any:
            return function(sound, *args, **kwargs)

        return faulty

    return make


def sound_function(where: str) -> Faulty:
    """The function at a place, of a property that which computes it.

    Raises LookupError where there is none.
    """
    owner, name = _place(where)
    return _function(vars(owner)[name])


def _instead(function: Faulty) -> Change:
    return around(lambda _sound, *args, **kwargs: function(*args, **kwargs))


def _of_value(change: Faulty) -> Change:
    return around(lambda sound, *args, **kwargs: change(sound(*args, **kwargs)))


def _declared(
    identifier: str, title: str, where: str, how: Callable[[Faulty], Change]
) -> Callable[[F], F]:
    def declare(function: F) -> F:
        if identifier in _DECLARED:
            raise ValueError(f"two faults are called {identifier}")
        _DECLARED[identifier] = Fault(identifier, title, where, how(function))
        return function

    return declare


def _place(where: str) -> tuple[Any, str]:
    """What holds the function, a module or a class, and its name there."""
    *path, name = where.split(".")
    owner: Any = None
    for number, step in enumerate(path, start=1):
        if isinstance(owner, ModuleType | None) and not hasattr(owner, step):
            owner = import_module(".".join(path[:number]))
        else:
            owner = getattr(owner, step)
    if name not in vars(owner):
        raise LookupError(f"no function {where}")
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
