"""The command `extras`: optional packages for the environment of the launcher.

They are those of requirements-dev.lock and requirements-gpu.lock, pinned by hash, with all that
they depend on. The environment notes their names, and the launcher adds them again after a later
set-up.
"""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fem.extras import EXTRAS
from lumped.errors import InputError
from lumped.posix import fcntl
from lumped.text import did_you_mean
from validation.console.streams import mention, say

ROOT = Path(__file__).resolve().parents[2]
# In the folder of the environment: names of extras, one a line.
NOTE = "flexproof-extras"


def extras(*names: str) -> int:
    """Add optional packages to the environment of ./flexproof; without names list them.

    Parameters
    ----------
    names
        cluster, docs, exudyn, gpu, hammer, nastran; several at once are allowed.
    """
    if not names:
        width = max(map(len, EXTRAS))
        for name, extra in EXTRAS.items():
            state = "installed" if extra.installed else "not installed"
            say(f"{name:{width}}  {state:13}  {extra.needed_for}")
        return 0
    if unknown := [name for name in names if name not in EXTRAS]:
        known = f"must be of {', '.join(EXTRAS)}"
        raise InputError(
            f"extras {name}: no such extra; {known}{did_you_mean(name, EXTRAS)}" for name in unknown
        )
    if Path(sys.prefix).resolve() != (ROOT / ".venv").resolve():
        raise InputError(
            "extras: adds to the environment of ./flexproof alone; in this one type, beside the "
            f"sources, pip install '.[{','.join(names)}]'"
        )
    # Every other command starts sooner without.
    from validation.console.locked import add  # noqa: PLC0415

    with _alone():
        added = add(ROOT, names)
        _note(names)
    told = f"added {', '.join(added)}" if added else "installed already, nothing to do"
    mention(f"extras {' '.join(dict.fromkeys(names))}: {told}")
    return 0


def _note(names: Iterable[str]) -> None:
    note = Path(sys.prefix) / NOTE
    earlier = note.read_text("utf-8").split() if note.exists() else []
    text = "".join(f"{name}\n" for name in sorted({*earlier, *names}))
    note.write_text(text, encoding="utf-8")


@contextmanager
def _alone() -> Iterator[None]:
    """The lock of set-ups of this clone, which the launcher takes, too."""
    if fcntl is None:
        raise InputError("extras: belongs to the launcher, for Linux; type pip install '.[NAME]'")
    with (ROOT / "pyproject.toml").open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
