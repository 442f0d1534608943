"""Studies over strokes, meshes and choices of legs: what cases and figures rest on.

Robots and models go in; deflections, frequencies, paired modes, orders and decisions come out.
"""
