"""Removal of all results that the program keeps in memory."""

import gc
from functools import cached_property

from lumped import memo

PACKAGES = {"lumped", "meshes", "fem", "validation"}


def forget():
    """Discard memoised values and cached properties, so that a changed model is computed again."""
    memo.forget()
    properties = {}
    for thing in gc.get_objects():
        kind = type(thing)
        if str(kind.__module__).partition(".")[0] in PACKAGES:
            if kind not in properties:
                own = {name: one for base in kind.__mro__ for name, one in vars(base).items()}
                properties[kind] = [n for n, one in own.items() if type(one) is cached_property]
            for name in properties[kind]:
                vars(thing).pop(name, None)
