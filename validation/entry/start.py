"""The entry of the command: Ctrl-C while it is still loading ends it with one line, too."""

import os
import sys

# Commands that solve many small dense systems: further threads of BLAS would wait for the first.
_ONE_THREAD = frozenset({"converge"})


def main() -> int:
    """Load and run the command line; returns the exit code."""
    if _ONE_THREAD.intersection(sys.argv[1:2]):
        # Read once, as numpy is loaded.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from validation.cli import main as run  # noqa: PLC0415  takes a fifth of a second
    except KeyboardInterrupt:
        sys.stderr.write("flexproof: interrupted\n")
        return 3
    return run()
