"""What a robot's models are held against, over the poses of its path, and why they are off.

In: a robot file of bodies and joints. Out: references and steps towards them, for the judgement.
"""
