"""Libraries behind the verbs of `fem.solvers`, one module each, and the choice between them.

In: the lower triangle of a symmetric matrix. Out: its order of elimination, its factor, signs,
solutions. `rslab` computes on the processor, `cudss` on a graphics card, `petsc` in processes
outside this environment, `superlu` if rslab cannot be loaded.
"""
