"""Curves of several models in the same axes: over the stroke, the family, the refinement.

Declared as charts of panels and series; how these are drawn is said in `validation.drawing.chart`.
"""
