"""Displacements and modes of a model in all poses, and comparison with another model.

Input: arrays of compliances, frequencies and sampled mode shapes. Output: relative displacement
errors, and pairs of modes with the same shape.
"""
