"""What a cross-section does: constants, Saint-Venant flexure, warping, waves along it.

In: section meshes and materials. Out: constants and functions of the section.
"""
