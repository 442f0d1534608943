"""Any robot as data: bodies, the joints between them, the tool, and postures with closed loops.

In: robot files and constructors (`lumped.robot_file`, the biglide). Out: the data from which each
model is assembled.
"""
