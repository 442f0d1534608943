"""Kinematics of a mechanism without elasticity: mobility, postures and pictures of them.

Input: a robot file and poses. Output: text, JSON or a picture.
"""
