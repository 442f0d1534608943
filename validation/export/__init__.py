"""Export of a robot's models to files for other programs.

Input: a mechanism. Output: fields for ParaView, matrices as .npz and Matrix Market, decks for
CalculiX, and reduced models for EXUDYN, Simscape and Nastran.
"""
