"""A run: tasks computed in processes, the disk cache, the run folder, its results and records.

Cases and figures are computed in worker processes. Each result is stored before the next one is
handled.
"""
