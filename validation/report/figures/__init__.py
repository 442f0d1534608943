"""Figures of a run: curves of all models, pictures of the robot, and plots of studies.

Input: the context of a run, or its outcomes. Output: charts and scenes. Curves and pictures are
tasks of the run like cases (`PlannedFigure`); plots of studies and error budgets are drawn from the
outcomes when the page is written.
"""
