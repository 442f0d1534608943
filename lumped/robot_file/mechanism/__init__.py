"""Robot files of schema 2: any mechanism, described in its reference posture.

Input: tables of the file. Output: a mechanism, or all faults of the description.
"""
