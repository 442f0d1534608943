"""Adequacy of lumped models for a robot: each model by each quantity against the best reference.

In: responses of models and of references over poses, by name. Out: a matrix of errors with
uncertainty, verdict, causes and a computed remedy.
"""
