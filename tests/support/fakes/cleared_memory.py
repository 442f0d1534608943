"""Removal of all results that the program keeps in memory."""

import gc
from functools import cached_property

from lumped import memo

PACKAGES = {"lumped", "meshes", "fem", "validation"}


def forget():
    """Discard memoised values and cached properties, so that a changed model is computed again."""
    memo.forget()
    properties = {}
    for item in gc.get_objects():
        kind = type(item)
        if str(kind.__module__).partition(".")[0] in PACKAGES:
            if kind not in properties:
                attributes = {
                    name: value for base in kind.__mro__ for name, value in vars(base).items()
                }
                properties[kind] = [
                    n for n, value in attributes.items() if type(value) is cached_property
                ]
            for name in properties[kind]:
                vars(item).pop(name, None)
