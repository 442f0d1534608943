"""Command line support: output streams, progress, arguments, result files and extras.

Input: arguments and results of commands. Output: text on stdout, messages on stderr, files. All
output passes through `streams`, which handles closed or full streams.
"""
