"""Plots of what the cases brought: families of studies and error budgets.

They are drawn when the page is made, from plain data.
"""
