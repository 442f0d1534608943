"""What a person does with CAD parts at the command line: pick faces, identify, paste.

In: part files. Out: text, JSON, pictures, TOML tables for robot files.
"""
