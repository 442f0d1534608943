"""Independent solutions by CalculiX: decks, runs, a leg and the whole robot.

In: meshes and materials. Out: numbers that share no solver code with ours.
"""
