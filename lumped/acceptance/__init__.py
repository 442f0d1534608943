"""Accepted errors of a robot's models, and measured values with which the models are compared.

Input: tables [accept], [agree] and [[measured]] of robot files. Output: limits and measured values,
each for one quantity.
"""
