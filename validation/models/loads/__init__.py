"""Loads of a mechanism on each of its models, on the masses of the bodies.

In: a mechanism with loads, and models of its bodies. Out: displacements of the tool, and stability.
"""
