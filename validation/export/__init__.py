"""Export of a robot's models to files for other programs.

In: models of a robot. Out: VTU, VTP, npz and Matrix Market files, decks and reduced models.
"""
