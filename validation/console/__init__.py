"""What lies between the commands and the shell: its streams, and the numbers that people type.

Everything the commands print goes through here, whatever became of the terminal.
"""
