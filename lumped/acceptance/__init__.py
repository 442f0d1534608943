"""What a robot's models are held to: the accuracy that its use asks for, and measured values.

In: tables [accept] and [[measured]] of robot files. Out: limits and measurements by quantity.
"""
