"""The command line in a process of its own, with a catalogue of the tests in place of the real one.

python command_line.py FUNCTION_OF_TOY_CATALOGUE [ARGUMENTS OF FLEXPROOF]

With SLOW_STEPS in the environment every file is renamed or removed after that many seconds.
"""

import os
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any


def main() -> int:
    import toy_catalogue  # noqa: PLC0415  the workers import this file too, and need none of it

    from validation.cli import main as flexproof  # noqa: PLC0415
    from validation.run import provenance  # noqa: PLC0415

    replacement = ModuleType("validation.catalogue")
    replacement.catalogue = getattr(toy_catalogue, sys.argv[1])  # type: ignore[attr-defined]
    sys.modules["validation.catalogue"] = replacement
    # Editing a source file while the tests run must not make a resumed run another one.
    provenance.suite_digest = lambda: "0"
    if "SLOW_STEPS" in os.environ:
        slow_down(float(os.environ["SLOW_STEPS"]))
    return flexproof(sys.argv[2:])


def slow_down(seconds: float) -> None:
    for name in ("rename", "unlink"):
        step = getattr(Path, name)

        def slowly(*arguments: Any, step: Any = step, **named: Any) -> Any:
            time.sleep(seconds)
            return step(*arguments, **named)

        setattr(Path, name, slowly)


if __name__ == "__main__":
    sys.exit(main())
