"""The command line in a process of its own, with a catalogue of the tests in place of the real one.

python command_line.py FUNCTION_OF_TOY_CATALOGUE [ARGUMENTS OF FLEXPROOF]
"""

import sys
from types import ModuleType


def main() -> int:
    import toy_catalogue  # noqa: PLC0415  the workers import this file too, and need none of it

    from validation.cli import main as flexproof  # noqa: PLC0415
    from validation.results import provenance  # noqa: PLC0415

    replacement = ModuleType("validation.catalogue")
    replacement.catalogue = getattr(toy_catalogue, sys.argv[1])  # type: ignore[attr-defined]
    sys.modules["validation.catalogue"] = replacement
    # Editing a source file while the tests run must not make a resumed run another one.
    provenance.suite_digest = lambda: "0"
    return flexproof(sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
