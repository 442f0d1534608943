"""Stresses of the fibre layers of a thin wall under section forces, by laminate theory.

Input: a laminate section and its section forces. Output: the stresses of each layer along and
across its fibres, at points around the wall. Rule: sections stay plane, so that the axial strain is

    e = N/EA + My z/EIy − Mz y/EIz

at the point (y, z) of a face of a layer. The shear flow q follows from equilibrium alone (torque
over twice the enclosed area, Bredt; shear forces along the middle line). The wall has no resultant
force along its circumference, hence the strains (εx, εs, γxs) = a (e/a11, 0, q) with a = A⁻¹ of
`lumped.sections.laminate`; γ of a tube in torsion is T r/GJ at its radius r. Layers at −θ without
+θ are coupled by a16: tension shears the wall, and a torque stretches it. The stresses Q̄ε of a
layer are turned into its own axes (R. M. Jones, Mechanics of Composite Materials, §2.5).

The theory leaves out that strains of shear vary with the radius, and that layers at different radii
strain each other along the circumference, by half the thickness t over the radius r. In the shear
flow of forces along y and z, 0.6 t/r of the largest stress was found. `half_widths` are the
stresses of strains of 3/4 t/r, the same for σ of layers that are alike and balanced with (t/r)².
Concentrations at sharp corners of boxes and stresses between layers are not included.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.beam_properties import BeamProperties
from lumped.sections.laminate import Laminate, LaminateBox, LaminateTube, Layer

# Relative error of strains, over the thickness divided by the radius.
_ERROR = 0.75
# Axial strain that layers at +θ and −θ at different radii cause in torsion, over the shear strain
# and `_ERROR`: 0.1 in layers at 45°, −45° and 0°.
_COUPLING = 0.2
# Points around the wall: multiples of four include the extremes under forces along y and z.
_AROUND = 72
# Points on each side of a box, with its corners.
_ON_SIDE = 19


@dataclass(frozen=True, eq=False)
class LayerStresses:
    """Stresses (p×3, Pa) of layers at p points: along the fibres, across them, and in shear.

    `points` (p×2) are positions (y, z, in m) on the inner and the outer face of each layer.
    `layers` (p) are the indices of the layers from the inside. `half_widths` (p×3, Pa) are
    estimates of the error of laminate theory.
    """

    points: Array
    layers: IntArray
    stresses: Array
    half_widths: Array


def layer_stresses(section: Laminate, beam: BeamProperties, forces: Array) -> LayerStresses:
    """Stresses of all layers under the section `forces` (6: N, Qy, Qz, T, My, Mz; N, N m).

    `beam` has the stiffnesses of the section by laminate theory.
    """
    flexibility = np.linalg.inv(section.wall)
    middle, outwards, flows, torsional = _wall_line(section, forces)
    depths = np.cumsum([0.0, *section.thicknesses]) - 0.5 * section.thickness
    axial, _, _, torque, about_y, about_z = forces
    axial_error, shear_error = _relative_errors(section)
    points, layers, stresses, half_widths = [], [], [], []
    for number, layer in enumerate(section.layers):
        to_fibres = _into_fibres(layer) @ layer.stiffness
        for depth in depths[[number, number + 1]]:
            y, z = (middle + depth * outwards).T
            tension = axial / beam.EA + about_y * z / beam.EIy - about_z * y / beam.EIz
            shear = flows * flexibility[2, 2]
            if isinstance(section, LaminateTube):
                shear = shear + torque * np.hypot(y, z) / beam.GJ
            else:
                shear = shear + torsional * flexibility[2, 2]
            strains = np.outer(tension / flexibility[0, 0], flexibility[0]) + np.outer(
                shear / flexibility[2, 2], flexibility[2]
            )
            errors = np.abs(strains) * np.array([axial_error, axial_error, shear_error])
            errors[:, 1] += axial_error * np.abs(strains[:, 0])
            errors[:, 0] += _COUPLING * axial_error * np.abs(strains[:, 2])
            points.append(np.column_stack([y, z]))
            layers.append(np.full(len(y), number))
            stresses.append(strains @ to_fibres.T)
            half_widths.append(errors @ np.abs(to_fibres).T)
    return LayerStresses(
        np.vstack(points), np.concatenate(layers), np.vstack(stresses), np.vstack(half_widths)
    )


def _relative_errors(section: Laminate) -> tuple[float, float]:
    """Relative errors of axial strains and of shear strains by laminate theory, see the module."""
    ratio = 2.0 * section.thickness / (min(section.extent) - section.thickness)
    first = section.layers[0].stiffness
    alike = all(np.allclose(layer.stiffness, first, rtol=1e-9) for layer in section.layers)
    error = _ERROR * ratio
    return ratio**2 if alike and section.is_balanced else error, error


def _into_fibres(layer: Layer) -> Array:
    """Matrix (3×3) from the stresses (σx, σs, τxs) of a layer to those along its fibres."""
    c, s = cos(radians(layer.angle)), sin(radians(layer.angle))
    return np.array(
        [[c * c, s * s, 2.0 * c * s], [s * s, c * c, -2.0 * c * s], [-c * s, c * s, c * c - s * s]]
    )


def _wall_line(section: Laminate, forces: Array) -> tuple[Array, Array, Array, float]:
    """Points (p×2) of the middle line, outward directions (p×2), and shear flows (N/m).

    The flows (p) are those of the shear forces, positive from y to z. The last number is the flow
    of the torque.
    """
    _, along_y, along_z, torque, _, _ = forces
    b, h = (size - section.thickness for size in section.extent)
    if not isinstance(section, LaminateBox):
        angles = 2.0 * pi * np.arange(_AROUND) / _AROUND
        outwards = np.column_stack([np.cos(angles), np.sin(angles)])
        flows = (along_z * outwards[:, 0] - along_y * outwards[:, 1]) / (0.5 * pi * b)
        return 0.5 * b * outwards, outwards, flows, torque / (0.5 * pi * b**2)
    sides = np.linspace(-0.5, 0.5, _ON_SIDE)
    ones = np.ones(_ON_SIDE)
    per_z, per_y = along_z / (b * h**2 / 2.0 + h**3 / 6.0), along_y / (h * b**2 / 2.0 + b**3 / 6.0)
    points, flows = [], []
    for sign in (1.0, -1.0):
        z, y = h * sides, b * sides
        points += [np.column_stack([sign * 0.5 * b * ones, z])]
        flows += [sign * per_z * (b * h / 4.0 + h**2 / 8.0 - z**2 / 2.0) - per_y * z * b / 2.0]
        points += [np.column_stack([y, sign * 0.5 * h * ones])]
        flows += [per_z * y * h / 2.0 - sign * per_y * (b * h / 4.0 + b**2 / 8.0 - y**2 / 2.0)]
    line = np.vstack(points)
    # At a corner the outer faces of both sides meet.
    at_edge = np.isclose(np.abs(line), [0.5 * b, 0.5 * h])
    outwards = np.where(at_edge, np.sign(line), 0.0)
    return line, outwards, np.concatenate(flows), torque / (2.0 * b * h)
