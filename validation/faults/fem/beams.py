"""Mistakes in beam elements, frames and the closed forms of beams."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, diags

from fem.elements.beam_elements import ElementLineBeam
from lumped.arrays import Array
from lumped.mechanism.body_model import LegMatrices
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


def _with_signs(first: float, second: float) -> Faulty:
    def bending(sound: Faulty, mesh: Any, **data: Any) -> Any:
        return sound(mesh, **data | {"signs": (first, second)})

    return bending


def _without(**data: float) -> Faulty:
    def bending(sound: Faulty, mesh: Any, **given: Any) -> Any:
        return sound(mesh, **given | data)

    return bending


@fault_around("beam.three-for-twelve", "Beam elements: a third of EI", "fem.beams.beam._bending")
def _hermite(sound: Faulty, mesh: Any, **data: Any) -> Any:
    return sound(mesh, **data | {"EI": data["EI"] / 3.0})


@fault_in_value(
    "beam.lumped-mass",
    "Beam elements: row sums for the consistent mass",
    "fem.beams.beam.beam_leg",
)
def _row_sums(leg: LegMatrices) -> LegMatrices:
    sums = np.asarray(np.abs(leg.mass).sum(axis=1)).ravel()
    return replace(leg, mass=csr_matrix(diags(sums)))


@fault_around("beam.quadrature", "Beam elements: two points of integration", "fem.beams.beam.Basis")
def _few_points(sound: Faulty, *args: Any, **kwargs: Any) -> Any:
    return sound(*args, **kwargs | {"intorder": 2})


@fault_around(
    "beam.hermite-sign",
    "Hermite functions of the rotations with the wrong sign",
    "fem.elements.beam_elements.ElementLineBeam.gbasis",
)
def _turned_functions(sound: Faulty, self: Any, mapping: Any, X: Array, i: int, tind: Any) -> Any:
    # Rotations at both ends with the opposite sign.
    w, theta = sound(self, mapping, X, i, tind)
    if i not in {1, 3}:
        return w, theta
    return type(w)(-np.asarray(w), grad=-w.grad), theta


@fault_around("beam.element-missing", "Beam one element too short", "fem.beams.beam.beam_leg")
def _one_element_less(sound: Faulty, properties: Any, length: float, elements: int) -> Any:
    return sound(properties, length * (1.0 - 1.0 / (elements + 1)), elements)


@fault_around(
    "beam.shear-of-other-plane",
    "Beam elements: half the shear stiffness along y",
    "fem.beams.beam.beam_leg",
)
def _crossed_planes(sound: Faulty, properties: Any, *rest: Any) -> Any:
    p = properties
    return sound(replace(p, GAy=0.5 * p.GAz), *rest)


@fault(
    "closed-form.free-free-waves",
    "Closed form: half waves of a free bar for quarter waves",
    "fem.beams.beam_theory._quarter_waves",
)
def _even_waves(speed_squared: float, length: float, count: int) -> Array:
    orders = np.arange(1, count + 1)
    return np.asarray(orders * np.sqrt(speed_squared) / (2.0 * length))


@fault_around(
    "closed-form.rotary-inertia",
    "Closed form: rotary inertia left out of Huang's equation",
    "fem.beams.beam_theory._piece_stiffness",
)
def _without_rotation(sound: Faulty, beam: Any, l: float, omega: float) -> Array:
    found: Array = sound(replace(beam, rho_I=0.0), l, omega)
    return found


@fault_in_value(
    "frame.left-handed",
    "Frame members in left-handed axes: y and z exchanged",
    "fem.beams.frame._member_axes",
)
def _left_handed(axes: Array) -> Array:
    return axes[:, [0, 2, 1]]


@fault(
    "frame.mass-in-rotations",
    "Frame: mass of a body entered for its rotations as well",
    "fem.beams.frame._inertia",
)
def _arm_without(body: Any) -> Array:
    return np.diag([body.mass] * 6).astype(float)


fault_around(
    "beam.rotation-sign",
    "Beam elements: φy = +w′ where deflection is along z",
    "fem.beams.beam._bending",
)(_with_signs(1.0, 1.0))
fault_around(
    "beam.deflection-sign",
    "Beam elements: deflection with the opposite sign of the twist's",
    "fem.beams.beam._bending",
)(_with_signs(-1.0, 1.0))
fault_around(
    "beam.shear-left-out", "Beam elements: shear deformation left out", "fem.beams.beam._bending"
)(_without(GA=np.inf))
fault_around(
    "beam.rotary-inertia-left-out",
    "Beam elements: rotary inertia left out",
    "fem.beams.beam._bending",
)(_without(rho_I=0.0))
fault(
    "beam.inner-unknowns-left-out",
    "Timoshenko elements without unknowns of their own inside: second order",
    "fem.beams.beam.ElementLineShearBeam",
)(ElementLineBeam)
fault(
    "beam.shear-length",
    "Λ = κGA/EI·l² forgotten: shear functions of a slender beam",
    "fem.beams.beam.ElementLineShearBeam",
)(lambda square: ElementLineBeam(0.0 * square))
fault_around(
    "closed-form.roots-shifted",
    "Closed form: roots of clamped–free bending without the first",
    "fem.beams.beam_theory.euler_bernoulli_roots",
)(lambda sound, count: sound(count + 1)[1:])
