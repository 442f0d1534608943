"""The assembler against the obvious way: every node and every joint written out, one null space.

All nodes have six unknowns, every joint six more for its relative twist, and every condition (a
rigid body, a joint's direction that does not give way) is a row. K̂ = TᵀKT with the null space T of
all rows by SVD; idle motions are left out by the pseudo-inverse.
"""

from contextlib import suppress

import numpy as np
import pytest
from random_mechanisms import random_posture

from lumped.errors import ComputationError
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.mechanism import GROUND, Posture
from lumped.models import serial_chains
from lumped.models.bodies import links, tip_compliances
from lumped.screws import shift, turn_matrix
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, modes, solved

# Legs and joints have compliances up to 1e-5: a robot softer than this is near a singular posture,
# and rounding grows as its compliance does.
SOFTEST_PART = 1e-5


class Naive:
    """Stiffness, mass and conditions of a mechanism on all its nodes and springs."""

    def __init__(self, posture: Posture, legs) -> None:
        self.posture, self.mechanism, self.legs = posture, posture.mechanism, legs
        bodies = self.mechanism.bodies
        self.nodes = [(n, p) for n, b in bodies.items() if n != GROUND for p in b.interfaces]
        joints = self.mechanism.joints
        self.springs = [j for j in joints if j.compliance is not None or sprung(j)]
        self.size = 6 * (len(self.nodes) + len(self.springs))
        self.held = []
        self.stiffness, self.mass = np.zeros((2, self.size, self.size))
        for name, body in bodies.items():
            if name != GROUND:
                self.add_body(name, body)
        for joint in joints:
            self.add_joint(joint)
        tool = self.mechanism.tool
        self.tool = self.rows(6 * self.nodes.index((tool.body, tool.point)))
        self.mass += tool.mass * self.tool[:3].T @ self.tool[:3]

    def rows(self, first: int):
        return np.eye(self.size)[first : first + 6]

    def at(self, side, point):
        if side.body == GROUND:
            return np.zeros((6, self.size))
        offset = point - interface_position(self.posture, side)
        return shift(offset) @ self.rows(6 * self.nodes.index((side.body, side.point)))

    def add_body(self, name, body) -> None:
        base = self.posture.frames[name]
        place = [(base @ frame).position for frame in body.interfaces.values()]
        own = [self.rows(6 * self.nodes.index((name, p))) for p in body.interfaces]
        if name in self.legs:
            tip = np.linalg.inv(turn_matrix(self.legs[name], base.rotation))
            relative = own[1] - shift(place[1] - place[0]) @ own[0]
            self.stiffness += relative.T @ tip @ relative
            return
        for point, twist in zip(place[1:], own[1:], strict=True):
            self.held.append(twist - shift(point - place[0]) @ own[0])
        moving = shift(base.position + base.rotation @ body.shape.centre - place[0]) @ own[0]
        weight = np.diag([body.shape.mass] * 3 + [0.0] * 3)
        weight[3:, 3:] = base.rotation @ body.shape.inertia @ base.rotation.T
        self.mass += moving.T @ weight @ moving

    def add_joint(self, joint) -> None:
        point = interface_position(self.posture, joint.first)
        apart = self.at(joint.second, point) - self.at(joint.first, point)
        free = free_twists(self.posture, joint)
        if joint in self.springs:
            # The spring's own deflection s, six unknowns, of which the rigid directions are held.
            i = 6 * (len(self.nodes) + self.springs.index(joint))
            apart = apart - self.rows(i)
            values, vectors = np.linalg.eigh(self.give(joint, free))
            soft = values > 1e-12 * values[-1]
            self.held.append(vectors[:, ~soft].T @ self.rows(i))
            self.stiffness[i : i + 6, i : i + 6] = (vectors[:, soft] / values[soft]) @ vectors[
                :, soft
            ].T
        passive = free if joint.drive is None else free[:, 1:]
        across = np.linalg.qr(passive, mode="complete")[0][:, passive.shape[1] :]
        self.held.append(across.T @ apart)

    def give(self, joint, free):
        give = np.zeros((6, 6))
        if joint.compliance is not None:
            body = joint.first.body
            since = self.posture.frames[body].rotation @ self.mechanism.reference[body].rotation.T
            give += turn_matrix(joint.compliance, since)
        if sprung(joint):
            give += np.outer(free[:, 0], free[:, 0]) / joint.drive.stiffness
        return give


def naive(posture: Posture, legs):
    """Stiffness, mass and tool rows on the null space of everything that is held."""
    whole = Naive(posture, legs)
    _, values, right = np.linalg.svd(np.vstack(whole.held))
    free = right[int(np.sum(values > 1e-10)) :].T
    return free.T @ whole.stiffness @ free, free.T @ whole.mass @ free, whole.tool @ free


def sprung(joint) -> bool:
    return joint.drive is not None and joint.drive.stiffness is not None


def naive_compliance(posture: Posture, legs):
    """Compliance of the tool and number of idle motions; None where the tool is free to move."""
    stiffness, mass, tool = naive(posture, legs)
    values, vectors = np.linalg.eigh(stiffness)
    firm = values > 1e-11 * values.max(initial=1.0)
    if np.abs(tool @ vectors[:, ~firm]).max(initial=0.0) > 1e-6:
        return None
    felt = tool @ vectors[:, firm] / np.sqrt(values[firm])
    return felt @ felt.T, int(np.sum(~firm)), (values, vectors, firm, mass)


def free_mass(motions, mass):
    """(NᵀMN)⁻¹ of those motions N that have mass."""
    values, vectors = np.linalg.eigh(motions.T @ mass @ motions)
    heavy = values > 1e-11 * mass.max(initial=0.0)
    return (vectors[:, heavy] / values[heavy]) @ vectors[:, heavy].T


# Universal joints that give, away from the reference posture, come up from the fifteenth on.
@pytest.mark.parametrize(
    ("seed", "planar"), [*((n, False) for n in range(27)), *((n, True) for n in range(8))]
)
def test_compliance_idle_motions_and_frequencies_are_those_of_the_null_space(seed, planar):
    posture = random_posture(seed, planar=planar)
    legs = tip_compliances(posture.mechanism)
    system = assemble(posture, links(posture.mechanism, legs))
    expected = naive_compliance(posture, legs)
    if expected is None:
        with pytest.raises(ComputationError, match="the tool is free to"):
            solved(system)
        return
    solution = solved(system)
    flexibility, idle, (values, vectors, firm, mass) = expected
    found = compliance(solution)
    size = np.abs(flexibility).max()
    grown = max(1.0, size / SOFTEST_PART)
    # 1e-20: a tool that rigid joints alone hold.
    assert np.abs(found - flexibility).max() <= 1e-8 * grown * size + 1e-20
    assert solution.idle == idle
    # Eqs (3) to (9) share nothing with the assembler; where a chain is rigid they have no answer.
    with suppress(ComputationError):
        by_chains = serial_chains.compliance(posture, legs)
        assert np.abs(by_chains - flexibility).max() <= 1e-7 * grown * size + 1e-20
    # Idle motions run free: what is left is orthogonal to them in the mass.
    idle_motions = vectors[:, ~firm]
    drag = free_mass(idle_motions, mass)
    left = mass - mass @ idle_motions @ drag @ idle_motions.T @ mass
    root = vectors[:, firm] / np.sqrt(values[firm])
    inverse = np.linalg.eigvalsh(root.T @ left @ root)[::-1]
    inverse = inverse[inverse > 1e-20]
    count = min(3, int(np.sum(inverse > 1e-9 * inverse.max(initial=0.0))))
    if count:
        assert (2 * np.pi * modes(solution, count).frequencies) ** -2 == pytest.approx(
            inverse[:count], rel=1e-7 * grown
        )
