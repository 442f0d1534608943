"""The report of a run: one self-contained HTML page, with its tables, sentences and figures.

Input: results of a run. Output: HTML, CSV tables, and lines for the terminal.
"""
