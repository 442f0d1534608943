"""Cross-sections of legs and their constants.

Input: dimensions in m. Output: area, second moments of area, torsion constant, shear centre and
shear coefficients.
"""

from lumped.sections.composite import Composite, CompositePart
from lumped.sections.constants import SectionProperties
from lumped.sections.laminate import Laminate, LaminateBox, LaminateTube, Layer
from lumped.sections.outlined import (
    Angle,
    Channel,
    OutlinedSection,
    Polygon,
    Tee,
    distances_to_edges,
    distances_to_segments,
)
from lumped.sections.polygons import Loop, Partition, is_inside, partition_edges
from lumped.sections.shapes import (
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Section,
    Tube,
    rectangle_torsion_constant,
)
from lumped.sections.symmetric_moments import (
    SymmetricMoments,
    flexure_moments,
    symmetric_moments,
)

SHAPES: dict[str, type[Section]] = {
    cls.shape: cls
    for cls in (
        Rectangle,
        HollowRectangle,
        Circle,
        Tube,
        ISection,
        Channel,
        Angle,
        Tee,
        Polygon,
        SectionProperties,
        Composite,
        LaminateTube,
        LaminateBox,
    )
}

__all__ = [
    "SHAPES",
    "Angle",
    "Channel",
    "Circle",
    "Composite",
    "CompositePart",
    "HollowRectangle",
    "ISection",
    "Laminate",
    "LaminateBox",
    "LaminateTube",
    "Layer",
    "Loop",
    "OutlinedSection",
    "Partition",
    "Polygon",
    "Rectangle",
    "Section",
    "SectionProperties",
    "SymmetricMoments",
    "Tee",
    "Tube",
    "distances_to_edges",
    "distances_to_segments",
    "flexure_moments",
    "is_inside",
    "partition_edges",
    "rectangle_torsion_constant",
    "symmetric_moments",
]
