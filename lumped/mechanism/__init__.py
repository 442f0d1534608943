"""Any robot as data: bodies, the joints between them, the tool, and postures with closed loops.

In: robot files and constructors (`lumped.robot_file`, the biglide). Out: what every model is
assembled from.
"""
