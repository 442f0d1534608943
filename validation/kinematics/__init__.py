"""What a person asks of a mechanism before any model: mobility, postures, pictures of them.

In: a robot file and poses. Out: text, JSON, a picture.
"""
