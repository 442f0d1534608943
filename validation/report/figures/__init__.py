"""The figures of a run: curves of all models in the same axes, pictures of the robot, studies.

Curves and pictures are computed in the run like cases (`PlannedFigure`); plots of studies and
budgets are drawn with the page, from the measurements of the cases.
"""
