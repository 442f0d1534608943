"""Entry point that sets BLAS to one thread and loads the command line.

Input: the command line. Output: its exit code. Ctrl-C during loading ends the command with one
line.
"""

import os
import sys


def main() -> int:
    """Load and run the command line. Returns the exit code."""
    try:
        # BLAS reads this setting once, when numpy is loaded.
        from fem.machine import ONE_BLAS_THREAD, search_cycles_rarely  # noqa: PLC0415

        os.environ.update(ONE_BLAS_THREAD)
        search_cycles_rarely()
        from validation.cli import main as run  # noqa: PLC0415  import takes 0.2 s
    except KeyboardInterrupt:
        sys.stderr.write("flexproof: interrupted\n")
        return 3
    return run()
