"""`flexproof solve`: one model of a robot, or of one of its legs, printed or as JSON.

In: a robot file and the typed options. Out: answers as records, text and JSON.
"""
