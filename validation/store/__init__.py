"""The folder of a run on the disk.

What was finished survives a kill and a full disk, and nothing that others wrote is touched.
"""
