"""Loads of a robot file on each model of a mechanism.

Input: a mechanism with loads and models of its bodies. Output: displacements of the tool under each
load, and buckling factors.
"""
