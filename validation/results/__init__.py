"""What a run found, as plain data.

Records between processes and on the disk, results.json, and runs side by side.
"""
