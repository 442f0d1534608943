"""Half-widths of numbers: from their mesh, from refinement series, from combined perturbations.

In: values on successive meshes, or changes by perturbations. Out: orders, limits, half-widths.
"""
