"""Results of Python functions that have no record of their own elsewhere.

In: matrices and curves of the computing packages. Out: frozen records with tables and plots.
"""
