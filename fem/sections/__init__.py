"""Cross-sections by finite elements: constants, Saint-Venant flexure, warping, waves.

In: section meshes and materials. Out: constants and functions of the section.
"""
