"""How many eigenvalues lie below a frequency: the certificate that no mode was missed.

In: stiffness and mass. Out: counts by Sylvester's law of inertia.
"""
