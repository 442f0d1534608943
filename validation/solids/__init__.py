"""Solid legs: choice of meshes, and compliances and frequencies with uncertainty.

Input: legs of constant section and limits on unknowns. Output: compliances and modes of solids on
several meshes, with their discretisation uncertainty, and beams with section constants computed on
the same section meshes.
"""
