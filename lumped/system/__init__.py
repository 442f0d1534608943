"""Stiffness and mass of any mechanism in one posture, assembled from models of its bodies.

In: a posture and a model of each deformable body. Out: compliance, modes and energies.
"""
