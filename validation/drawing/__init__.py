"""Surfaces, views, scenes, text and the style of plots: what is drawn, and how.

Knows nothing of robots.
"""
