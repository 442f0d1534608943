"""`flexproof solve`: one model of a robot, or of one of its legs, printed or as JSON.

In: a robot file and what was typed. Out: answers, and the text for people or programs.
"""
