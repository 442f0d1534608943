"""Curves of several models in the same axes: over the stroke, the family, the refinement.

Declared as lines and panels; how they are drawn is said once.
"""
