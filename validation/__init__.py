"""Checks of lumped robot models against finite elements: comparisons, verdicts, runs and reports.

Input: robot files. Output: verdicts on models and formulations, as a report, JSON or Python
records.
"""
