"""Requirements on a robot's models: accepted errors and measured values.

In: tables [accept] and [[measured]] of robot files. Out: limits and measurements by quantity.
"""
