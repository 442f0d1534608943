"""The report: one self-contained page, its figures and their common style."""
