"""Comparison of models with measured values, by the method of the standard ASME V&V 20.

Input: measured values in a robot file, or a modal test. Output: for each model the comparison
error, the validation uncertainty due to numerics, inputs and measurement, and a verdict.
"""
