"""Legs as solids, as beams of the same section meshes, and what both are at their tips."""

from dataclasses import dataclass

import numpy as np

from fem.beams.beam import beam_leg
from fem.bodies.solid import Ends, clamped_leg, solid_leg, solid_mesh
from fem.couplings.end_effects import restrained_compliance
from fem.reduction.superelement import HeldLeg, held_solid_leg
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array
from lumped.errors import InputError, naming
from lumped.legs import ConstantLeg, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from meshes.section.section_mesh import section_mesh
from validation.context import Preset
from validation.solids.legs import (
    COARSEST_WALLS,
    doubled_tip,
    face_mesh,
    own_properties,
    static_ladder,
    static_slices,
)

# Tasks of this group share what is kept of the robot's solids.
SHARED_SOLIDS = "robot.solid.modes"
# Divisions of rectangles where legs vibrate; the next coarser ones give the numerical uncertainty.
# Up to four, walls have one element across: half of that shows what the length of elements does,
# and what the section mesh leaves out it leaves out of the constants alike.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 3, "fine": 4}
WALL_DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 8}
# Of beams beside them.
ELEMENTS = 20


def held_solid(leg: ConstantLeg, divisions: int, ends: Ends, section: int | None = None) -> HeldLeg:
    """The solid leg with the twists of both ends given; `ends` as in its coupling.

    `section`: divisions of its section, where they are others than `divisions` along it.
    """
    solid = solid_leg(leg, solid_mesh(leg, divisions, section=section))
    with naming(leg.name):
        mesh = solid.mesh
        return held_solid_leg(clamped_leg(solid, ends), mesh)


def own_beam(leg: ConstantLeg, divisions: int) -> LegMatrices:
    """Timoshenko beam of the constants of the very section mesh that the solid has."""
    material = leg.material
    mesh = section_mesh(leg.section, divisions)
    constants = section_constants(mesh, material.nu, material.G / material.E)
    return beam_leg(beam_properties(constants, material), leg.length, ELEMENTS)


@dataclass(frozen=True)
class TipCompliances:
    """6×6 tip compliances (SI, leg axes) of one mesh of a leg and of its section.

    The solid's with `rigid` and with `free` ends, `own`: the Timoshenko cantilever's with the
    constants of the same section mesh, and `restrained`: what rigid faces take from it in theory.
    """

    rigid: Array
    free: Array
    own: Array
    restrained: Array

    @property
    def held(self) -> Array:
        """The cantilever's with end faces held plane and rigid."""
        return np.asarray(self.own + self.restrained)


@dataclass(frozen=True)
class TwoMeshes:
    """A leg on two similar meshes; sizes of the `coarse` one are `ratio` times the `fine` one's."""

    coarse: TipCompliances
    fine: TipCompliances
    ratio: float


def two_meshes(leg: ConstantLeg, most: int) -> TwoMeshes:
    """Tip compliances of a leg by doubling, on the meshes of `mesh_pair`."""
    coarse, fine = mesh_pair(leg, most)
    with naming(leg.name):
        return TwoMeshes(
            coarse=_compliances(leg, *coarse),
            fine=_compliances(leg, *fine),
            ratio=fine[1] / coarse[1],
        )


def mesh_pair(leg: ConstantLeg, most: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Divisions of the section and slices along it of the two finest meshes, coarse and fine.

    Their section meshes have at most `most` unknowns. Where one alone of thin walls can have so
    few, both share it and the coarser one is half as fine along the leg: what the section mesh
    leaves out of a solid it leaves out of the constants alike. Raises InputError where not even
    that one is small enough.
    """
    ladder = static_ladder(leg, most)
    if ladder:
        coarse, fine = ladder[-2:]
        return (coarse, static_slices(leg, coarse)), (fine, static_slices(leg, fine))
    if (unknowns := _coarsest_unknowns(leg)) > most:
        raise InputError(
            f"{leg.name or 'leg'}: the coarsest section mesh of its {leg.section.shape} has "
            f"{unknowns} unknowns, more than {most}"
        )
    along = static_slices(leg, COARSEST_WALLS)
    return (COARSEST_WALLS, along), (COARSEST_WALLS, 2 * along)


def has_meshes(leg: ConstantLeg, most: int) -> bool:
    """Whether there is a `mesh_pair` of a leg."""
    return bool(static_ladder(leg, most)) or _coarsest_unknowns(leg) <= most


def _coarsest_unknowns(leg: ConstantLeg) -> int:
    return 3 * len(face_mesh(leg, COARSEST_WALLS).nodes)


def _compliances(leg: ConstantLeg, divisions: int, along: int) -> TipCompliances:
    return TipCompliances(
        rigid=doubled_tip(leg, divisions, along, "rigid"),
        free=doubled_tip(leg, divisions, along, "free"),
        own=tip_compliance(own_properties(leg, divisions), leg.length),
        restrained=restrained_compliance(face_mesh(leg, divisions), leg.material, leg.length),
    )
