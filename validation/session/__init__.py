"""A run from the request to its report.

Cases are computed in worker processes; what each yields is kept before the next one is looked at.
"""
