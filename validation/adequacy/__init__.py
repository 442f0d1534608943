"""Verdicts on the models of a robot: adequate, inadequate or undecided for each quantity.

Input: displacements and natural modes of all judged models and of the reference, in all poses.
Output: a matrix with one row for each model and one column for each quantity; each entry has the
error, its interval, the verdict, the causes of the error and a remedy whose effect is computed.
"""
