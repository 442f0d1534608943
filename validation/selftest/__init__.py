"""What a user's machine can fail: published benchmarks, meshers, solvers and programs beside it.

In: nothing but what is installed. Out: a table of known numbers beside ours, and an exit code.
"""
