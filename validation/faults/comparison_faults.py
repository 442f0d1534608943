"""Mistakes in what models are compared by: pairing of modes, allowances, energies, CalculiX."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fem.calculix.deck import Equation, Part
from fem.calculix.mechanism import MechanismDeck
from fem.elements.elasticity import mass
from lumped.arrays import Array, SparseMatrix
from lumped.legs import BeamProperties, Material
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import Posture
from meshes.solid_mesh import SolidMesh
from validation.faults.fault import Fault, Faulty, around, instead, result
from validation.studies.mode_pairing import Pairing


def _without_weights(sound: Faulty, first: Array, second: Array, weights: Array) -> Any:
    return sound(first, second, np.ones_like(weights))


def _by_number(sound: Faulty, first: Array, second: Array, weights: Array) -> Pairing:
    found: Pairing = sound(first, second[:, : first.shape[1]], weights)
    numbers = np.arange(first.shape[1])
    return replace(found, partner=numbers)


def _not_normalised(sound: Faulty, first: Array, second: Array, weights: Array) -> Array:
    largest: Array = np.sqrt(weights)[:, None] * first
    sizes = np.square(np.linalg.norm(largest, axis=0))
    found: Array = sound(first, second, weights)
    return np.asarray(found * sizes[:, None])


def _without_rotary(sound: Faulty, properties: BeamProperties, lengths: Array) -> Array:
    found: Array = sound(replace(properties, rho_J=0.0, rho_Iy=0.0, rho_Iz=0.0), lengths)
    return found


def _equal_lengths(found: tuple[Array, Array]) -> tuple[Array, Array]:
    stations, lengths = found
    return stations, np.full_like(lengths, 2.0 * lengths.mean())


def _rod_with(**factors: float) -> Any:
    def changed(rod: Any) -> Any:
        return replace(rod, **{name: f * getattr(rod, name) for name, f in factors.items()})

    return result(changed)


def _one_wave_more(sound: Faulty, constants: Any, material: Material, k: float) -> float:
    found: float = sound(constants, material, 2.0 * k)
    return found


def _one_direction_massless(matrix: Array) -> Array:
    changed = matrix.copy()
    # A millionth is left, so that the matrix stays positive definite.
    changed[2::3] *= 1e-3
    changed[:, 2::3] *= 1e-3
    return changed


def _weak_shear(sound: Faulty, material: Material) -> Array:
    found: Array = sound(replace(material, G=0.5 * material.G))
    return found


def _shear_sign(strains: Array) -> Array:
    """γxy and γxz with −∂u/∂x: ∂/∂x of sin kx with the sign of cos kx."""
    changed = strains.copy()
    changed[:, :, 4, 2::3] *= -1.0
    changed[:, :, 5, 1::3] *= -1.0
    return changed


def _kinds_swapped(energies: dict[str, Array]) -> dict[str, Array]:
    swapped = {"bending y": "bending z", "bending z": "bending y"}
    return {kind: energies[swapped.get(kind, kind)] for kind in energies}


def _permuted(material: Material) -> Iterator[str]:
    E, G, nu = material.E, material.G, material.nu
    C11 = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C12 = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    yield "*ELASTIC, TYPE=ORTHO"
    yield ", ".join(f"{c:.12e}" for c in (C11, C12, C12, C11, C12, C11, G, G))
    yield f"{G:.12e}"


def _isotropic(sound: Faulty, material: Material) -> Iterator[str]:
    lines: Iterator[str] = sound(replace(material, G=material.E / (2.0 * (1.0 + material.nu))))
    return lines


def _part_with(change: Any) -> Any:
    def changed(sound: Faulty, part: Part, name: str, first: int) -> Any:
        return sound(change(part), name, first)

    return around(changed)


def _other_mid_nodes(part: Part) -> Part:
    order = np.arange(part.cells.shape[1])
    order[-2:] = order[:-3:-1]
    return replace(part, cells=part.cells[:, order])


def _lighter(part: Part) -> Part:
    # g/cm³ is 1000 kg/m³, not 1024.
    return replace(part, material=replace(part.material, rho=part.material.rho / 1.024))


def _two_terms_only(sound: Faulty, equation: Equation) -> Any:
    return sound(replace(equation, terms=equation.terms[:2]))


def _turned_equations(equations: tuple[Equation, ...]) -> tuple[Equation, ...]:
    """Rotations with the opposite sign: u = u_ref − φ × r."""
    return tuple(
        replace(
            equation,
            terms=tuple(
                (freedom, factor if factor == 1.0 else -factor)
                for freedom, factor in equation.terms
            ),
        )
        for equation in equations
    )


def _without_platform(made: MechanismDeck) -> MechanismDeck:
    return replace(made, deck=replace(made.deck, masses=()))


def _feet_held(sound: Faulty, posture: Posture, *rest: Any) -> Any:
    """Revolute joints at A and C forgotten."""
    joints = [
        replace(joint, kind="fixed", axes=np.zeros((0, 3)))
        if joint.name.startswith("foot")
        else joint
        for joint in posture.mechanism.joints
    ]
    return sound(replace(posture, mechanism=replace(posture.mechanism, joints=joints)), *rest)


def _springs_without_couplings(sound: Faulty, posture: Posture, joint: Joint) -> Any:
    if joint.compliance is None:
        return sound(posture, joint)
    return sound(posture, replace(joint, compliance=np.diag(np.diag(joint.compliance))))


def _axes_untouched(made: MechanismDeck) -> MechanismDeck:
    parts = tuple(replace(part, axes=None) for part in made.deck.parts)
    return replace(made, deck=replace(made.deck, parts=parts))


def _exact_mass(mesh: SolidMesh, rho: float) -> SparseMatrix:
    return mass(mesh, rho)


FAULTS = (
    Fault(
        "pairing.unweighted",
        "MAC without mass weighting: metres beside radians",
        "validation.studies.mode_pairing:mac_matrix",
        "numerics",
        around(_without_weights),
    ),
    Fault(
        "pairing.not-normalised",
        "MAC without the norm of one of the shapes",
        "validation.studies.mode_pairing:mac_matrix",
        "numerics",
        around(_not_normalised),
    ),
    Fault(
        "pairing.by-number",
        "Modes paired by their number instead of their shape",
        "validation.studies.mode_pairing:pair_modes",
        "numerics",
        around(_by_number),
    ),
    Fault(
        "pairing.angle-unweighted",
        "Angle between spaces of modes without mass weighting",
        "validation.studies.mode_pairing:largest_angle",
        "numerics",
        around(_without_weights),
    ),
    Fault(
        "pairing.no-rotary-inertia",
        "Weights of sampled twists without rotary inertia",
        "validation.studies.mode_pairing:centreline_weights",
        "physics",
        around(_without_rotary),
    ),
    Fault(
        "pairing.equal-weights",
        "Gauss stations with equal weights, twice the mass",
        "validation.studies.mode_pairing:centreline_samples",
        "numerics",
        result(_equal_lengths),
    ),
    Fault(
        "torsion.bimoment",
        "Torsion with warping: a tenth of the warping stiffness EΓ",
        "fem.sections.nonuniform_torsion:warping_rod",
        "physics",
        _rod_with(bimoment=0.1),
    ),
    Fault(
        "torsion.shear",
        "Torsion with warping: a tenth of the shear stiffness G(Ip − J)",
        "fem.sections.nonuniform_torsion:warping_rod",
        "physics",
        _rod_with(shear=0.1),
    ),
    Fault(
        "torsion.wave-length",
        "Torsional wave of half the length",
        "fem.sections.nonuniform_torsion:wave_frequency",
        "physics",
        around(_one_wave_more),
    ),
    Fault(
        "waveguide.mass",
        "Waves in a leg: inertia of motion along z left out",
        "fem.sections.waveguide:_mass",
        "physics",
        result(_one_direction_massless),
    ),
    Fault(
        "waveguide.shear",
        "Waves in a leg: half the shear modulus (γ for ε)",
        "fem.sections.waveguide:elasticity",
        "physics",
        around(_weak_shear),
    ),
    Fault(
        "waveguide.strain-sign",
        "Waves in a leg: sign of the axial derivative in γxy and γxz",
        "fem.sections.waveguide:strains",
        "physics",
        result(_shear_sign),
    ),
    Fault(
        "energies.kinds-swapped",
        "Energies of solid legs: bending y for bending z",
        "fem.bodies.leg_energies:kind_energies",
        "physics",
        result(_kinds_swapped),
    ),
    Fault(
        "calculix.cubic-permuted",
        "CalculiX deck: cubic constants in the wrong order",
        "fem.calculix.deck:_elastic",
        "data",
        instead(_permuted),
    ),
    Fault(
        "calculix.isotropic",
        "CalculiX deck: shear modulus of its own ignored",
        "fem.calculix.deck:_elastic",
        "physics",
        around(_isotropic),
    ),
    Fault(
        "calculix.node-order",
        "CalculiX deck: two middle nodes of each element exchanged",
        "fem.calculix.deck:_part",
        "numerics",
        _part_with(_other_mid_nodes),
    ),
    Fault(
        "calculix.density",
        "CalculiX deck: density in a wrong unit, 2.4 % off",
        "fem.calculix.deck:_part",
        "data",
        _part_with(_lighter),
    ),
    Fault(
        "calculix.equation-cut",
        "CalculiX deck: equations cut off after two terms",
        "fem.calculix.deck:_equation",
        "data",
        around(_two_terms_only),
    ),
    Fault(
        "calculix.rotation-sign",
        "CalculiX deck: rigid faces turn the other way",
        "fem.calculix.deck:rigid_face",
        "physics",
        result(_turned_equations),
    ),
    Fault(
        "calculix.mass-rule",
        "CalculiX's mass rule taken for the exact one",
        "fem.calculix.leg:mass_at_stiffness_points",
        "numerics",
        instead(_exact_mass),
    ),
    Fault(
        "robot-calculix.no-platform",
        "CalculiX deck of the robot: platform without mass",
        "fem.calculix.mechanism:mechanism_deck",
        "data",
        result(_without_platform),
    ),
    Fault(
        "robot-calculix.joints-held",
        "CalculiX deck of the robot: revolute joints at A and C forgotten",
        "fem.calculix.mechanism:_freedoms",
        "physics",
        around(_feet_held),
    ),
    Fault(
        "robot-calculix.springs-diagonal",
        "CalculiX deck of the robot: springs of feet and tool without their couplings",
        "fem.calculix.mechanism:_give",
        "physics",
        around(_springs_without_couplings),
    ),
    Fault(
        "robot-calculix.material-axes",
        "CalculiX deck of the robot: the legs' cubic material not turned with them",
        "fem.calculix.mechanism:mechanism_deck",
        "physics",
        result(_axes_untouched),
    ),
)
