"""Reference solutions of a robot along its path, with the uncertainty of each by source.

Input: the robot file and the mesh preset of a run. Output: displacements and modes of the reference
(3-D solids) and of all judged models, half-widths of the reference's numbers by source of
uncertainty, and for each model a sequence of intermediate models that separates the causes of its
error.
"""
