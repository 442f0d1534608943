"""Stiffness and mass of any mechanism in one posture, assembled from models of its bodies.

Input: a posture and a model of each deformable body. Output: compliance of the tool, natural modes,
responses to harmonic forces, buckling factors and strain energies.
"""
