"""The entry of the command: Ctrl-C while it is still loading ends it with one line, too."""

import sys


def main() -> int:
    """Load and run the command line; returns the exit code."""
    try:
        from validation.cli import main as run  # noqa: PLC0415  takes a fifth of a second
    except KeyboardInterrupt:
        sys.stderr.write("flexproof: interrupted\n")
        return 3
    return run()
