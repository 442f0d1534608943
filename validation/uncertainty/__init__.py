"""Numerical uncertainty of a number, from several meshes, element counts or perturbations.

Input: values on successive meshes, or changes due to perturbations. Output: observed order,
extrapolated limit and half-width of the 95 % interval.
"""
