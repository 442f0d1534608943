"""The program's checks of itself, made once for an installation and a preset and then kept.

In go their records as they are finished, out come those that still hold for the same versions.
"""
