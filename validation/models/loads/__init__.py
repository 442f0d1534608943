"""What acts on every model of a mechanism: its own loads, on the masses that bodies have.

In: a mechanism with loads, and models of its bodies. Out: how far the tool moves.
"""
