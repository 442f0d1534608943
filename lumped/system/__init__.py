"""Stiffness and mass of any mechanism in one posture, assembled from models of its bodies.

In: a posture and a model of every body that is not rigid. Out: compliance, modes and energies.
"""
