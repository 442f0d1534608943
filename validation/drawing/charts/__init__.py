"""Figures of curves, bars and matrices: declared, with the scales of their axes, and drawn."""
