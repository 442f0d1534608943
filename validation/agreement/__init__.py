"""How far two results agree: order and uncertainty of a refinement, modes paired by their shape.

In: numbers on several grids, shapes of two models. Out: limits with their uncertainty, partners.
"""
