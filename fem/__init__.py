"""Finite element models of legs and robots: beams, solids, their couplings and their reduction."""
