"""What rigid end faces take from a prism's compliance: Saint-Venant's end effects, exact along x.

On the section's mesh a prism obeys E₀u″ + Gu′ − E₂u = 0 (semi-analytical finite elements, u the 3N
displacements of a section). Its solutions are twelve polynomials, rigid motions and Saint-Venant's
states of tension, torsion, bending and flexure, and fields e^{∓γx} that decay from either end
(R. A. Toupin, Arch. Rat. Mech. Anal. 18 (1965) 83; those of a strip are Papkovich's and Fadle's,
γc = 2.106 + 1.125i with c half its height). A face that stays plane and rigid needs these as well:
they hold warping by torque and shear, and with ν > 0 contraction by tension and bending.
"""

import numpy as np
from scipy.linalg import eig

from fem.couplings.section_fields import (
    SectionFields,
    SectionState,
    saint_venant_states,
    section_fields,
)
from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Differences between c_ij and c_ji, in units of √(c_ii c_jj), beyond which digits are missing that
# comparisons of solids (0.1 %) would show.
_UNEVEN = 1e-5


def restrained_compliance(mesh: SectionMesh, material: Material, length: float) -> Array:
    """6×6 change (SI, leg axes, at the tip) of a prism's tip compliance by rigid end faces.

    That of plane, rigid faces at root and tip less that with Saint-Venant's tractions on both, work
    conjugate: nowhere positive. Exact in x for any length, so that both ends may interact. Raises
    InputError for a section that is not symmetric about both of its axes, ComputationError where
    moduli are so different that rounding loses the slowest decay, or a leg so long that it loses
    what its faces hold.
    """
    change = np.zeros((6, 6))
    for fields in section_fields(mesh, material):
        change[np.ix_(fields.twists, fields.twists)] = _change(fields, length)
    return change


def _decays(fields: SectionFields) -> tuple[Array, Array]:
    """Decay rates γ (k, Re γ > 0) and the fields (n×k) of e^{γ(x − L)}, which decay from the tip.

    Those of e^{−γx}, from the root, have u_x of the other sign.
    """
    left, right = fields.squares_problem()
    squares, shapes = eig(np.linalg.solve(right, left))
    kept = np.argsort(np.abs(squares))[fields.chain :]
    rates = np.sqrt(squares[kept].astype(complex))
    if not np.all(rates.real > 0.0):
        # Rates are about √(G/E) of the section's size, their squares beside four zeros of a chain.
        raise ComputationError(
            "end effects: the slowest decay along the leg is lost in rounding; moduli (E and G, "
            "say) or sides of the section differ by too much"
        )
    shapes = shapes[:, kept].astype(complex)
    shapes[: fields.axial] /= rates
    return rates, np.asarray(shapes / np.linalg.norm(shapes, axis=0))


def _change(fields: SectionFields, length: float) -> Array:
    """Compliance (m×m) of the class with held faces less that with Saint-Venant's tractions."""
    root, tip = saint_venant_states(fields, 0.0), saint_venant_states(fields, length)
    carried = fields.rigid.copy()
    if fields.chain == 2:
        # A rotation about the root moves the tip sideways: φ_z along +y, φ_y along −z.
        carried[:, 1] += (length if fields.twists == (1, 5) else -length) * fields.rigid[:, 0]
    unit = np.linalg.inv(fields.rigid.T @ tip.forces)
    root = SectionState(root.fields @ unit, root.forces @ unit)
    tip = SectionState(tip.fields @ unit, tip.forces @ unit)

    rates, from_tip = _decays(fields)
    from_root = from_tip.copy()
    from_root[: fields.axial] *= -1.0
    faded = np.exp(-rates * length)
    # u = 0 at the root, the twist of the tip unknown; a rigid motion may be added to the states.
    nothing = np.zeros_like(fields.rigid)
    system = np.block(
        [
            [from_root, from_tip * faded, fields.rigid, nothing],
            [from_root * faded, from_tip, carried, -fields.rigid],
        ]
    )
    loads = -np.vstack([root.fields, tip.fields])
    held = np.linalg.solve(system, loads.astype(complex))[-fields.rigid.shape[1] :].real
    free = tip.forces.T @ tip.fields - root.forces.T @ root.fields
    # Maxwell and Betti: what is not symmetric is rounding, of long thin legs some 1e-7.
    taken = held - free
    sizes = np.sqrt(np.maximum(np.diag(free), 0.0))
    if not np.all(np.abs(taken - taken.T) <= _UNEVEN * np.outer(sizes, sizes)):
        raise ComputationError(
            "end effects: the end restraint of rigid faces is lost in rounding; the leg is "
            "too long for its section, or its moduli differ by too much"
        )
    return np.asarray(0.5 * (taken + taken.T))
