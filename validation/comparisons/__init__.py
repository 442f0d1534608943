"""Comparisons of the formulations with each other: element count, mesh, beam against solid."""
