"""The models of bodies and robots by name, with stored results.

In: a robot and the options of a model. Out: compliance, frequencies, matrices.
"""
