"""Kinematics of a mechanism without any model: mobility, postures, and pictures of them.

In: a robot file and poses. Out: text, JSON, a picture.
"""
