"""A finished run takes the place of the earlier one, so that a kill at any moment loses neither.

The new run is computed in `unfinished/` below the earlier one. When it is whole, that folder is
renamed `.arriving`, in one step: from then on the new run is the one that counts. Its files are
then moved up, each in one step, and what is left of the earlier run is removed. Whoever opens the
folder next finishes what a kill interrupted. Files that no run wrote stay where they are.
"""

import os

from validation.store import manifest as manifests
from validation.store import mark
from validation.store.manifest import Manifest, manifest_of
from validation.store.tree import Tree

UNFINISHED = "unfinished"
ARRIVING = ".arriving"
# Where a run has files; removed when they are empty.
FOLDERS = ("export", "figures", "records", "sweeps")
# What people and programs look at comes last, and last of all what the folder is known by.
_LAST = ("report.html", "results.json", mark.FILE, manifests.FILE)


def is_run(tree: Tree, name: str = "") -> bool:
    """Whether a folder is a run's, known by what its mark or its manifest says."""
    if name and tree.kind(name) != "folder":
        return False
    with tree.below(name) as inner:
        return mark.mark_in(inner) is not None or manifest_of(inner).run is not None


def has_results(tree: Tree) -> bool:
    """Whether there is anything in a run's folder that could be lost."""
    return not tree.lacks("results.json") or bool(tree.names("records"))


def discard(tree: Tree, name: str = "") -> None:
    """Remove what a run wrote into a folder, and the folder if nothing else is in it."""
    with tree.below(name) as inner:
        for file in manifest_of(inner).own():
            inner.remove(file)
        _prune(inner)
    if name:
        tree.remove(name)


def replace(tree: Tree) -> list[str]:
    """Put the finished run in `unfinished/` in the place of the earlier one; see `settle`."""
    with tree.below(UNFINISHED) as new:
        listed = manifest_of(new)
        for name in new.files():
            if name not in listed.digests and name != manifests.FILE and listed.owns(name):
                listed.expect(name, new.read(name) or b"")
        os.fsync(new.descriptor)
    tree.move(UNFINISHED, ARRIVING)
    os.fsync(tree.descriptor)
    return settle(tree)


def settle(tree: Tree) -> list[str]:
    """Finish a replacement, if one was begun; the remarks say what was moved out of its way."""
    if tree.kind(ARRIVING) != "folder":
        return []
    remarks = []
    if is_run(tree, ARRIVING):
        with tree.below(ARRIVING) as new:
            earlier, arriving = manifest_of(tree), set(new.files())
            listed = manifest_of(new).digests.keys() | arriving
            # The new manifest comes last: until then a second attempt knows what was old.
            old = [name for name in earlier.own() if name not in listed]
            for name in sorted(arriving):
                if (obstacle := _in_the_way(tree, earlier, name)) is not None:
                    kept = tree.aside(obstacle)
                    remarks.append(f"{tree.path / obstacle} was no run's: kept as {kept}")
            for name in sorted(arriving - set(_LAST)):
                new.move(name, name, tree)
            for name in old if manifests.FILE in arriving else ():
                tree.remove(name)
            for name in _LAST:
                if name in arriving:
                    new.move(name, name, tree)
    tree.prune(ARRIVING)
    _prune(tree)
    os.fsync(tree.descriptor)
    return remarks


def _in_the_way(tree: Tree, earlier: Manifest, name: str) -> str | None:
    folder = name.rpartition("/")[0]
    if folder and not tree.lacks(folder) and tree.kind(folder) != "folder":
        return folder
    return name if not (tree.lacks(name) or earlier.owns(name)) else None


def _prune(tree: Tree) -> None:
    for folder in FOLDERS:
        tree.prune(folder)
