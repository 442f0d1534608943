"""The biglide as a subject of adequacy: what its models answer and what they are held against.

In: a robot and a preset. Out: `response.Subject`, which knows nothing of legs and strokes.
"""
