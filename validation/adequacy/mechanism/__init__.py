"""Any mechanism with its models and what they are held against, over the poses of its path.

In: a robot file of bodies and joints. Out: its subject for the judgement.
"""
