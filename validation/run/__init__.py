"""A run: tasks computed in processes, with a cache on disk, a run folder and stored results.

Input: cases and figures. Output: records in the run folder, results.json, and the comparison of two
runs. Each result is stored before the next one is processed.
"""
