"""Bodies reduced to their interfaces: constraint modes, fixed-interface modes, recovery.

In: held and factorised bodies. Out: small dense matrices, and the way back.
"""
