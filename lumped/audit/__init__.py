"""What a robot's data say about themselves.

In: a robot file, as printed and as used. Out: findings, each with the number that shows it.
"""
