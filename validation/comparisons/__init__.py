"""Comparisons of formulations of the same legs: convergence, and beams against solids.

Input: a robot file, and the limits of its table [agree]. Output: verdicts on each comparison, and
convergence studies over element count or mesh.
"""
