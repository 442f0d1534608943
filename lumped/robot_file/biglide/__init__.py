"""Robot files of schema 1: the biglide and the corrections of what its paper prints.

In: checked tables. Out: a `Mechanism`, or every fault with its key.
"""
