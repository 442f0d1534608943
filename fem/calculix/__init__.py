"""Independent solutions by CalculiX: input decks, runs, a single leg and whole mechanisms.

Input: meshes and materials. Output: results computed without any solver code of this project.
"""
