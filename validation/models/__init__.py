"""The models of bodies and robots behind one name each, and what is kept of them.

In: a robot and the options of a model. Out: compliance, frequencies, matrices.
"""
