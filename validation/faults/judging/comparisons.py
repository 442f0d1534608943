"""Mistakes in what models are compared by: pairing of modes, allowances, energies, CalculiX."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fem.calculix.deck import ElementSet, Equation
from fem.calculix.mechanism import MechanismDeck
from fem.elements.elasticity import mass
from lumped.arrays import Array, SparseMatrix
from lumped.legs import BeamProperties, Material
from lumped.mechanism.joint import Joint
from lumped.mechanism.mechanism import Posture
from meshes.solid_mesh import SolidMesh
from validation.agreement.mode_pairing import Pairing
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_around(
    "pairing.unweighted",
    "MAC without mass weighting: metres beside radians",
    "validation.agreement.mode_pairing.mac_matrix",
)
@fault_around(
    "pairing.angle-unweighted",
    "Angle between spaces of modes without mass weighting",
    "validation.agreement.mode_pairing.largest_angle",
)
def _without_weights(sound: Faulty, first: Array, second: Array, weights: Array) -> Any:
    return sound(first, second, np.ones_like(weights))


@fault_around(
    "pairing.by-number",
    "Modes paired by their number instead of their shape",
    "validation.agreement.mode_pairing.pair_modes",
)
def _by_number(sound: Faulty, first: Array, second: Array, weights: Array) -> Pairing:
    found: Pairing = sound(first, second[:, : first.shape[1]], weights)
    numbers = np.arange(first.shape[1])
    return replace(found, partner=numbers)


@fault_around(
    "pairing.not-normalised",
    "MAC without the norm of one of the shapes",
    "validation.agreement.mode_pairing.mac_matrix",
)
def _not_normalised(sound: Faulty, first: Array, second: Array, weights: Array) -> Array:
    largest: Array = np.sqrt(weights)[:, None] * first
    sizes = np.square(np.linalg.norm(largest, axis=0))
    found: Array = sound(first, second, weights)
    return np.asarray(found * sizes[:, None])


@fault_around(
    "pairing.no-rotary-inertia",
    "Weights of sampled twists without rotary inertia",
    "validation.agreement.mode_pairing.centreline_weights",
)
def _without_rotary(sound: Faulty, properties: BeamProperties, lengths: Array) -> Array:
    found: Array = sound(replace(properties, rho_J=0.0, rho_Iy=0.0, rho_Iz=0.0), lengths)
    return found


@fault_in_value(
    "pairing.equal-weights",
    "Gauss stations with equal weights, twice the mass",
    "validation.agreement.mode_pairing.centreline_samples",
)
def _equal_lengths(found: tuple[Array, Array]) -> tuple[Array, Array]:
    stations, lengths = found
    return stations, np.full_like(lengths, 2.0 * lengths.mean())


def _rod_with(**factors: float) -> Any:
    def changed(rod: Any) -> Any:
        return replace(rod, **{name: f * getattr(rod, name) for name, f in factors.items()})

    return changed


@fault_around(
    "torsion.wave-length",
    "Torsional wave of half the length",
    "fem.sections.nonuniform_torsion.wave_frequency",
)
def _one_wave_more(sound: Faulty, constants: Any, material: Material, k: float) -> float:
    found: float = sound(constants, material, 2.0 * k)
    return found


@fault_in_value(
    "waveguide.mass",
    "Waves in a leg: inertia of motion along z left out",
    "fem.sections.waveguide.mass_matrix",
)
def _one_direction_massless(matrix: Array) -> Array:
    changed = matrix.copy()
    # A millionth is left, so that the matrix stays positive definite.
    changed[2::3] *= 1e-3
    changed[:, 2::3] *= 1e-3
    return changed


@fault_around(
    "waveguide.shear",
    "Waves in a leg: half the shear modulus (γ for ε)",
    "fem.sections.waveguide.elasticity",
)
def _weak_shear(sound: Faulty, material: Material) -> Array:
    found: Array = sound(replace(material, G=0.5 * material.G))
    return found


@fault_in_value(
    "waveguide.strain-sign",
    "Waves in a leg: sign of the axial derivative in γxy and γxz",
    "fem.sections.waveguide.strains",
)
def _shear_sign(strains: Array) -> Array:
    """γxy and γxz with −∂u/∂x: ∂/∂x of sin kx with the sign of cos kx."""
    changed = strains.copy()
    changed[:, :, 4, 2::3] *= -1.0
    changed[:, :, 5, 1::3] *= -1.0
    return changed


@fault_in_value(
    "energies.kinds-swapped",
    "Energies of solid legs: bending y for bending z",
    "fem.bodies.leg_energies.kind_energies",
)
def _kinds_swapped(energies: dict[str, Array]) -> dict[str, Array]:
    swapped = {"bending y": "bending z", "bending z": "bending y"}
    return {kind: energies[swapped.get(kind, kind)] for kind in energies}


@fault(
    "calculix.cubic-permuted",
    "CalculiX deck: cubic constants in the wrong order",
    "fem.calculix.deck._elastic",
)
def _permuted(material: Material) -> Iterator[str]:
    E, G, nu = material.E, material.G, material.nu
    C11 = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    C12 = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    yield "*ELASTIC, TYPE=ORTHO"
    yield ", ".join(f"{c:.12e}" for c in (C11, C12, C12, C11, C12, C11, G, G))
    yield f"{G:.12e}"


@fault_around(
    "calculix.isotropic",
    "CalculiX deck: shear modulus of its own ignored",
    "fem.calculix.deck._elastic",
)
def _isotropic(sound: Faulty, material: Material) -> Iterator[str]:
    lines: Iterator[str] = sound(replace(material, G=material.E / (2.0 * (1.0 + material.nu))))
    return lines


def _part_with(change: Any) -> Any:
    def changed(sound: Faulty, part: ElementSet, name: str, first: int) -> Any:
        return sound(change(part), name, first)

    return changed


def _other_mid_nodes(part: ElementSet) -> ElementSet:
    order = np.arange(part.cells.shape[1])
    order[-2:] = order[:-3:-1]
    return replace(part, cells=part.cells[:, order])


def _lighter(part: ElementSet) -> ElementSet:
    # g/cm³ is 1000 kg/m³, not 1024.
    return replace(part, material=replace(part.material, rho=part.material.rho / 1.024))


@fault_around(
    "calculix.equation-cut",
    "CalculiX deck: equations cut off after two terms",
    "fem.calculix.deck._equation",
)
def _two_terms_only(sound: Faulty, equation: Equation) -> Any:
    return sound(replace(equation, terms=equation.terms[:2]))


@fault_in_value(
    "calculix.rotation-sign",
    "CalculiX deck: rigid faces turn the other way",
    "fem.calculix.deck.rigid_face",
)
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


@fault_in_value(
    "robot-calculix.no-platform",
    "CalculiX deck of the robot: platform without mass",
    "fem.calculix.mechanism.mechanism_deck",
)
def _without_platform(made: MechanismDeck) -> MechanismDeck:
    return replace(made, deck=replace(made.deck, masses=()))


@fault_around(
    "robot-calculix.joints-held",
    "CalculiX deck of the robot: passive revolute joints forgotten",
    "fem.calculix.mechanism._freedoms",
)
def _pins_held(sound: Faulty, posture: Posture, *rest: Any) -> Any:
    joints = [
        replace(joint, kind="fixed", axes=np.zeros((0, 3)))
        if joint.kind == "revolute" and joint.drive is None
        else joint
        for joint in posture.mechanism.joints
    ]
    return sound(replace(posture, mechanism=replace(posture.mechanism, joints=joints)), *rest)


@fault_around(
    "robot-calculix.springs-diagonal",
    "CalculiX deck of the robot: springs of feet and tool without their couplings",
    "fem.calculix.mechanism._give",
)
def _springs_without_couplings(sound: Faulty, posture: Posture, joint: Joint) -> Any:
    if joint.compliance is None:
        return sound(posture, joint)
    return sound(posture, replace(joint, compliance=np.diag(np.diag(joint.compliance))))


@fault_in_value(
    "robot-calculix.material-axes",
    "CalculiX deck of the robot: the legs' cubic material not turned with them",
    "fem.calculix.mechanism.mechanism_deck",
)
def _axes_untouched(made: MechanismDeck) -> MechanismDeck:
    parts = tuple(replace(part, axes=None) for part in made.deck.parts)
    return replace(made, deck=replace(made.deck, parts=parts))


@fault(
    "calculix.mass-rule",
    "CalculiX's mass rule taken for the exact one",
    "fem.calculix.leg.mass_at_stiffness_points",
)
def _exact_mass(mesh: SolidMesh, rho: float) -> SparseMatrix:
    return mass(mesh, rho)


fault_in_value(
    "torsion.bimoment",
    "Torsion with warping: a tenth of the warping stiffness EΓ",
    "fem.sections.nonuniform_torsion.warping_rod",
)(_rod_with(bimoment=0.1))
fault_in_value(
    "torsion.shear",
    "Torsion with warping: a tenth of the shear stiffness G(Ip − J)",
    "fem.sections.nonuniform_torsion.warping_rod",
)(_rod_with(shear=0.1))
fault_around(
    "calculix.node-order",
    "CalculiX deck: two middle nodes of each element exchanged",
    "fem.calculix.deck._part",
)(_part_with(_other_mid_nodes))
fault_around(
    "calculix.density",
    "CalculiX deck: density in a wrong unit, 2.4 % off",
    "fem.calculix.deck._part",
)(_part_with(_lighter))
