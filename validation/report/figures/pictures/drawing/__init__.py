"""Surfaces, views and scenes: what a picture is drawn from, and how VTK draws it.

Knows nothing of robots.
"""
