"""Whether a lumped model may be trusted for a robot: model by quantity, against the best reference.

In: responses of models and of references over poses, by name. Out: a matrix of errors with
uncertainty, verdict, causes and a computed remedy.
"""
