"""Pictures of the robot and its legs: VTK draws the bodies, matplotlib what is written on them.

The same scenes can be turned in the page.
"""
