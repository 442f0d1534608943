"""Mistakes in lumped models: sections and legs, postures and virtual joints, assembled robots.

Each is a function under the place where it is put in; the catalogue gathers them.
"""
