"""Command `extras`: install optional packages in the environment of the launcher.

The packages and their dependencies are pinned by hash in requirements-dev.lock and
requirements-gpu.lock. Their names are stored in the environment, so that the launcher installs them
again after a later set-up.
"""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fem.extras import EXTRAS
from lumped.errors import InputError
from lumped.posix import fcntl
from lumped.text import did_you_mean
from validation.console.streams import write_message, write_results

ROOT = Path(__file__).resolve().parents[2]
# File in the folder of the environment with the names of extras, one per line.
NOTE = "flexproof-extras"


def extras(*names: str) -> int:
    """Add optional packages to the environment of ./flexproof. List them if no name is given.

    Parameters
    ----------
    names
        One or more of cluster, docs, exudyn, gpu, hammer, nastran.
    """
    if not names:
        width = max(map(len, EXTRAS))
        for name, extra in EXTRAS.items():
            state = "installed" if extra.installed else "not installed"
            write_results(f"{name:{width}}  {state:13}  {extra.needed_for}")
        return 0
    if unknown := [name for name in names if name not in EXTRAS]:
        allowed = f"must be one of {', '.join(EXTRAS)}"
        raise InputError(
            f"extras {name}: unknown extra; {allowed}{did_you_mean(name, EXTRAS)}"
            for name in unknown
        )
    if Path(sys.prefix).resolve() != (ROOT / ".venv").resolve():
        raise InputError(
            "extras: adds packages only to the environment of ./flexproof; for this "
            f"environment run pip install '.[{','.join(names)}]' in the folder of the "
            "sources"
        )
    # Imported here, so that other commands start sooner.
    from validation.console.locked import add  # noqa: PLC0415

    with _setup_lock():
        added = add(ROOT, names)
        _store_names(names)
    result = f"added {', '.join(added)}" if added else "already installed"
    write_message(f"extras {' '.join(dict.fromkeys(names))}: {result}")
    return 0


def _store_names(names: Iterable[str]) -> None:
    note = Path(sys.prefix) / NOTE
    earlier = note.read_text("utf-8").split() if note.exists() else []
    text = "".join(f"{name}\n" for name in sorted({*earlier, *names}))
    note.write_text(text, encoding="utf-8")


@contextmanager
def _setup_lock() -> Iterator[None]:
    """Context that holds the lock of this clone's environment, which the launcher also uses."""
    if fcntl is None:
        raise InputError(
            "extras: needs the launcher ./flexproof on Linux; elsewhere run pip install '.[NAME]'"
        )
    with (ROOT / "pyproject.toml").open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
