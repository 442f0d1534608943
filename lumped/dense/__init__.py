"""Small systems solved densely: displacements, natural frequencies, and what rounding leaves.

In: stiffness and mass matrices with loads. Out: flexibilities and modes with the digits that hold.
"""
