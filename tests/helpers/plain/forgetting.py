"""What functions and objects of the program keep in memory, dropped."""

import gc
from functools import cached_property, lru_cache

from validation.parts import kept

PACKAGES = {"lumped", "meshes", "fem", "validation"}
FUNCTION = type(lru_cache(repr))


def forget():
    """Have everything computed again, as when a model is changed under what was kept of it."""
    kept._in_memory.clear()
    properties = {}
    for thing in gc.get_objects():
        kind = type(thing)
        if kind is FUNCTION:
            if thing.__module__.partition(".")[0] in PACKAGES:
                thing.cache_clear()
        elif str(kind.__module__).partition(".")[0] in PACKAGES:
            if kind not in properties:
                own = {name: one for base in kind.__mro__ for name, one in vars(base).items()}
                properties[kind] = [n for n, one in own.items() if type(one) is cached_property]
            for name in properties[kind]:
                vars(thing).pop(name, None)
