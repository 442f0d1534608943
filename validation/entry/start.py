"""The entry of the command: Ctrl-C while it is still loading ends it with one line, too."""

import os
import sys


def main() -> int:
    """Load and run the command line; returns the exit code."""
    try:
        # BLAS reads this once, when numpy is loaded.
        from fem.machine import ONE_BLAS_THREAD  # noqa: PLC0415

        os.environ.update(ONE_BLAS_THREAD)
        from validation.cli import main as run  # noqa: PLC0415  import takes 0.2 s
    except KeyboardInterrupt:
        sys.stderr.write("flexproof: interrupted\n")
        return 3
    return run()
