"""Mistakes in what judges: pairing and decks, verdicts and uncertainties, what is shown.

Each is a function under the place where it is put in; the catalogue gathers them.
"""
