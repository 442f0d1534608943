"""References of a robot over its path: its solids, their uncertainty by source, steps to models.

In: a run's robot file and preset. Out: responses of models and references, half-widths, causes.
"""
