"""Second mathematics beside the models: Ritz's method, waves in legs.

Postures and legs go in; compliances and frequencies come out.
"""
