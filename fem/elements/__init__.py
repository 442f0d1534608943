"""Elements of beams and solids.

In: meshes and materials. Out: stiffness and mass matrices.
"""
