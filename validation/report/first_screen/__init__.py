"""The first screen: whether the lumped models may be trusted for this robot, for what, and why.

In: the matrix of adequacy. Out: one sentence, a table, causes with what to do, their sheets.
"""
