"""Legs as beams: beam elements, exact theory of the cantilever, stepped legs, loaded legs.

Input: section constants and lengths. Output: `LegMatrices`, and frequencies in closed form.
"""
