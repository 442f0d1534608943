"""Command line: streams, progress, typed arguments, result files, extras and documentation.

All output of the commands passes through `streams`, which handles closed or full streams.
"""
