"""A robot's models as files for other programs.

Models go in; VTU, VTP, npz and Matrix Market files come out.
"""
