"""Command line support: output streams, progress, arguments, result files and extras.

Input: arguments and results of commands. Output: text on stdout, messages on stderr, files. All
output is written by `streams`, which handles closed and full streams.
"""
