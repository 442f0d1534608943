"""CalculiX as the independent judge: decks, runs, a leg and the whole robot.

In: meshes and materials. Out: numbers that share no solver code with ours.
"""
