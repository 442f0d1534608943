"""Reactions, drive forces, section forces and stresses of legs under the loads of a robot file.

Input: a `Question`, with a model and poses. Output: forces with their numerical uncertainty, as
tables, JSON and figures.
"""
