"""Bodies reduced to their interfaces: constraint modes, fixed-interface modes, recovery.

Input: bodies with fixed interfaces and factorised stiffness. Output: small dense matrices, and
matrices that recover all displacements of the unreduced body.
"""
