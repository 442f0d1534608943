"""Self-test of an installation by published benchmarks.

Input: the installed packages and programs (meshers, solvers, CalculiX, EXUDYN). Output: a table of
known and computed numbers, and an exit code.
"""
