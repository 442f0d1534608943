"""A robot as data: bodies, the joints between them, the tool, and postures with closed loops.

Input: robot files (`lumped.robot_file`) or the constructor of the biglide. Output: the data from
which each model is assembled.
"""
