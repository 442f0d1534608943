"""Second mathematics beside the models: Ritz's method, waves in legs, legs made ever longer.

Postures and legs go in; compliances, frequencies and the exponents of what ends do come out.
"""
