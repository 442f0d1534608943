"""Joints in the terms of catalogues: stiffnesses and dashpots along named directions.

`directions` names the directions of each kind of joint and makes matrices of numbers along them.
"""
