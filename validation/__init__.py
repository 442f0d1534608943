"""Comparisons as typed cases, the run that judges them, and the report that shows it."""
