"""Figures of any mechanism: its picture, its curves over the path, its modes and how it yields.

Each is computed in the run like a case.
"""
