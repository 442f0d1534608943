"""Robots by the method of Ritz: polynomials along their legs, energies by quadrature.

A way of its own to deflections and frequencies, which takes nothing but the robot's data.
"""
