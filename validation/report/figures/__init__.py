"""The figures of a run: curves of all models in the same axes, pictures of the robot, studies.

Curves and pictures are computed in the run like cases (`PlannedFigure`); plots of studies and
budgets are drawn when the page is made, from what the cases brought.
"""
