"""What the biglide and any other mechanism share in their assessment.

References known on two meshes, plausible masses of given legs, ladders of causes.
"""
