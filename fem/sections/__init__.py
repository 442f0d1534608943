"""Cross-sections by finite elements: constants, Saint-Venant's flexure, warping, waves.

Input: section meshes and materials. Output: section constants and fields.
"""
