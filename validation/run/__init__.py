"""A run: tasks computed in processes, the disk cache, the run folder, its results and records.

Computing of a case or figure happens in worker processes; each result is kept before the next one
is looked at.
"""
