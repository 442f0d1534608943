"""Solution of small systems with dense matrices: displacements, natural frequencies, round-off.

Input: stiffness and mass matrices, and loads. Output: flexibilities and modes with bounds on
round-off.
"""
