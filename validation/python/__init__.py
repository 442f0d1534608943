"""Result records of the Python interface: designs, finished runs, measured comparisons.

Input: curves, outcomes and matrices of other packages. Output: frozen records with tables and
plots.
"""
