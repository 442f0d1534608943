"""Legs as beams: elements along a line, exact theory of the cantilever, stepped legs.

In: section constants and lengths. Out: `LegMatrices` and closed-form frequencies.
"""
