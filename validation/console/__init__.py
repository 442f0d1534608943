"""What lies between commands and shell: streams, numbers that people type, files that they name.

Everything the commands print goes through here, whatever became of the terminal.
"""
