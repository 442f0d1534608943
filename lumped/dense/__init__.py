"""Dense solution of small systems: displacements, natural frequencies, and their round-off.

In: stiffness and mass matrices with loads. Out: flexibilities and modes with bounds on round-off.
"""
