"""Lumped, beam and solid models of legs, CAD parts and whole mechanisms.

Input: a mechanism and the options of a model. Output: its compliance, natural frequencies and
displacements under loads, or stiffness and mass matrices of its bodies. Expensive results are
stored.
"""
