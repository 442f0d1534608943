"""Legs and robots in three dimensions as a run looks at them: which meshes, and how uncertain.

Legs go in; compliances, modes and energies of solids come out with what refinement leaves open.
"""
