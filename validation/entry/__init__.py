"""The entry of the command.

In: the command line. Out: its exit code.
"""
