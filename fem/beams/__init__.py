"""Legs as beams: beam elements, exact theory of the cantilever, stepped legs, loaded legs.

Input: section constants and lengths. Output: matrices of a leg (`LegMatrices`), and frequencies in
closed form.
"""
