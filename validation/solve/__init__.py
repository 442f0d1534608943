"""The command `flexproof solve`: compliance and frequencies of one model of a robot or leg.

Input: a robot file and options. Output: answers as records, text and JSON.
"""
