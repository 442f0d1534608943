"""Reactions, drive forces, member forces and stresses under the loads of a robot file.

In: a question about a model and poses. Out: forces with their numerical uncertainty, as tables,
JSON and figures.
"""
