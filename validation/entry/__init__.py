"""The entry of the command.

The command line goes in; its exit code comes out.
"""
