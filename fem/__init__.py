"""Finite elements for legs and robots: beams, solids, and their couplings."""
