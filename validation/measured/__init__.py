"""Comparison of models with measured values, in the terms of ASME V&V 20.

In: measured values of a robot file or of a modal test. Out: comparison error, validation
uncertainty from numerics, inputs and measurement, and the verdict.
"""
