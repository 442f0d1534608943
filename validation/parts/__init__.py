"""CAD parts at the command line: lists and pictures of faces, identification, tables to paste.

In: part files. Out: text, JSON, pictures, TOML tables for robot files.
"""
