"""Models held against measured values, in the terms of ASME V&V 20.

Comparison error, validation uncertainty from numerics, inputs and measurement, and the verdict.
"""
