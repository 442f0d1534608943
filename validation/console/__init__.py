"""What lies between commands and shell: streams, and the numbers and files that people type.

Everything the commands print goes through here, whatever became of the terminal.
"""
