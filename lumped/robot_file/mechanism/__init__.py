"""Robot files of schema 2: any mechanism in its reference posture.

In: the file's tables. Out: a mechanism, or every fault of the description.
"""
