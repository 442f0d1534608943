"""Responses of models, statics and modes, and their comparison: displacements, modes by shape.

In: arrays of compliances, frequencies and sampled shapes. Out: errors, and pairs of modes.
"""
