"""Self-test of an installation: published benchmarks that use meshers, solvers and other programs.

In: the installed packages and programs. Out: a table of known and computed numbers, and an exit
code.
"""
