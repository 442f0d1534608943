"""Robot files of schema 2: any mechanism as it stands in one reference posture.

In: the file's tables. Out: a mechanism, or every fault of the description.
"""
