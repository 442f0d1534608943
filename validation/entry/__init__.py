"""Entry point of the command `flexproof`.

Input: the command line. Output: its exit code.
"""
