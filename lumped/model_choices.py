"""Choices of a formulation, with the words that options and robot files have for them.

Input: none. Output: types. Rule: this module imports nothing that is slow to import, because the
commands take the choices of their options from it.
"""

from typing import Literal, TypeAlias

# Beam theory: without or with shear deformation and rotary inertia.
Theory: TypeAlias = Literal["euler-bernoulli", "timoshenko"]
# End faces of a solid leg: kept plane and rigid, or free to warp.
Ends: TypeAlias = Literal["rigid", "free"]
# Springs of segments: with half springs at both ends of a leg, or between segments only.
Layout: TypeAlias = Literal["half", "literal"]
# Release of rotation in the robot's revolute joints: by condensation, or by eq. (25) as printed.
Release: TypeAlias = Literal["condensed", "printed"]
# Matrix whose diagonal the equivalent prism has: the 6×6 stiffness or the 6×6 compliance.
EquivalentBy: TypeAlias = Literal["stiffness", "compliance"]
# Compliance of a leg in `vjm` and `links`: that of its section or robot file, or that of the
# equivalent prism.
LegSprings: TypeAlias = Literal["given", "equivalent"]
# CAD parts in `segments` and `beam`: a leg of one section, a leg of ten prismatic pieces, or
# stiffness and mass between its interfaces.
PartLegs: TypeAlias = Literal["equivalent", "stepped", "condensed"]
# Modes by which CAD parts are reduced: with all interfaces fixed, or free.
ReductionBy: TypeAlias = Literal["fixed", "free"]
