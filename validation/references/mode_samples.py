"""Points of a mechanism at which mode shapes of different models are compared.

Input: a mechanism, and mode shapes of a model in the unknowns of the model. Output: displacements
at the same points for each model, the mass that each point represents, and the part of each mode's
kinetic energy that these displacements account for. Points of a leg lie on twelve sections, four in
each, placed so that they have the section's mass and rotary inertia.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import GivenLeg, LineLeg
from lumped.mechanism.body import Body, Rigid
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import leg_of, legs_of
from lumped.screws import shift, turn
from lumped.system.assembly import System
from validation.models.reduced_parts import identified
from validation.responses.mode_pairing import centreline_samples

_STATIONS = 12
# Sample points of a section about its centroid, in radii of gyration.
_CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Samples:
    """Sample points of all bodies of a mechanism, and the mass of each sampled displacement.

    `weights` (k): mass (kg) of each sampled displacement, moment of inertia (kg m²) of each sampled
    rotation. The keys of the mappings are body names. `points` (m×3, in metres, body axes): sample
    points of each leg and CAD part. `turned`: principal axes of inertia (3×3, columns) of each
    rigid body with mass. `prisms`: masses (m, kg) of the points of each leg with a cross-section,
    that is, of each leg that is not specified by its 6×6 compliance.
    """

    mechanism: Mechanism
    points: Mapping[str, Array]
    turned: Mapping[str, Array]
    prisms: Mapping[str, Array]
    weights: Array

    def of_models(self, models: Mapping[str, BodyModel]) -> dict[str, Array]:
        """Matrices (3k×n) that map n unknowns of each model to displacements of its k points.

        The keys of `models` and of the result are body names.
        """
        matrices: dict[tuple[BodyModel, bytes], Array] = {}
        matrix_by_body = {}
        for name, model in models.items():
            points = self.points[name]
            key = model, points.tobytes()
            if key not in matrices:
                matrices[key] = model.displacements(points).toarray()
            matrix_by_body[name] = matrices[key]
        return matrix_by_body

    def at(self, system: System, shapes: Array, of_models: Mapping[str, Array]) -> Array:
        """Samples of m mode shapes: k displacements and rotations of each (k×m).

        `shapes` (n×m): mode shapes in the n unknowns of `system`. `of_models`: result of
        `Samples.of_models`. A body without a matrix in `of_models` moves rigidly.
        """
        outer = shapes[: system.outer]
        rows = [(system.tool @ shapes)[:3]]
        for name, axes in self.turned.items():
            frame, shape = system.posture.frames[name], self.mechanism.bodies[name].shape
            centre = shape.centre if isinstance(shape, Rigid) else np.zeros(3)
            point = next(iter(self.mechanism.bodies[name].interfaces))
            position = frame.position + frame.rotation @ centre
            twist = system.motions.at(name, point, position) @ outer
            rows.append(turn(frame.rotation @ axes).T @ twist)
        for name, points in self.points.items():
            if name in of_models:
                rows.append(of_models[name] @ system.body_unknowns(name, shapes))
                continue
            frame = system.posture.frames[name]
            point = next(iter(self.mechanism.bodies[name].interfaces))
            twist = turn(frame.rotation).T @ system.motions.at(name, point, frame.position) @ outer
            rows += [(shift(position) @ twist)[:3] for position in points]
        return np.vstack(rows)

    def energy_shares(self, system: System, shapes: Array, of_models: Mapping[str, Array]) -> Array:
        """Share (m) of each mode's kinetic energy that the sampled displacements represent.

        `shapes` (n×m, in the n unknowns of the system) are mass-normalised. `of_models`: result of
        `Samples.of_models`. Samples of a leg with a cross-section represent motions of rigid
        cross-sections, as in a beam; they do not contain the energy of a deformation of the
        sections. All energy of other bodies counts as sampled.
        """
        inside = np.zeros(shapes.shape[1])
        for name in self.prisms.keys() & of_models.keys():
            unknowns = system.body_unknowns(name, shapes)
            sampled_energy = np.repeat(self.prisms[name], 3) @ np.square(of_models[name] @ unknowns)
            energy = np.sum(unknowns * (system.models[name].mass @ unknowns), axis=0)
            inside += np.maximum(energy - sampled_energy, 0.0)
        return np.asarray(np.clip(1.0 - inside, 0.0, 1.0))

    def section_motions(self, leg: str, samples: Array) -> Array:
        """Motions (s×3×m) of the s sampled sections of a leg in their planes, in m mode shapes.

        `samples` (k×m): result of `Samples.at`, or of `PathModes.samples`. The three motions of a
        section are translations along its y and z axes and the rotation about its normal, each
        times the root of its mass or moment of inertia. Their squares are shares of the kinetic
        energy if the shapes are mass-normalised.
        """
        names = list(self.points)
        before = names[: names.index(leg)]
        first = 3 + 6 * len(self.turned) + 3 * sum(len(self.points[name]) for name in before)
        corners = self.points[leg].reshape(-1, len(_CORNERS), 3)
        moved = samples[first : first + corners.size].reshape(*corners.shape, -1)
        masses = self.prisms[leg].reshape(-1, len(_CORNERS))
        axes = np.stack([corners[:, 0] - corners[:, 1], corners[:, 0] - corners[:, 3]])
        axes /= np.linalg.norm(axes, axis=2, keepdims=True)
        offsets = corners - corners.mean(axis=1, keepdims=True)
        y, z = np.einsum("ask,sck->asc", axes, offsets)
        along = np.einsum("ask,sckm->ascm", axes, moved)
        momentum = np.einsum("sc,ascm->asm", masses, along)
        angular = np.einsum("sc,scm->sm", masses * y, along[1])
        angular -= np.einsum("sc,scm->sm", masses * z, along[0])
        inertia = (masses * (y**2 + z**2)).sum(axis=1)
        motions = [
            *(momentum / np.sqrt(masses.sum(axis=1))[:, None]),
            angular / np.sqrt(inertia)[:, None],
        ]
        return np.stack(motions, axis=1)


def samples_of(mechanism: Mechanism) -> Samples:
    """Sample points of a mechanism: tool, rigid bodies with mass, legs and CAD parts."""
    weights = [np.full(3, mechanism.tool.mass)]
    turned = {}
    for name, body in mechanism.bodies.items():
        if isinstance(body.shape, Rigid) and body.shape.mass:
            moments, turned[name] = np.linalg.eigh(body.shape.inertia)
            weights += [np.full(3, body.shape.mass), np.maximum(moments, 0.0)]
    points, prisms = {}, {}
    for name, leg in legs_of(mechanism).items():
        points[name], masses = _leg_points_and_masses(mechanism.bodies[name])
        if not isinstance(leg, GivenLeg):
            prisms[name] = masses
        weights.append(np.repeat(masses, 3))
    for name, body in mechanism.parts.items():
        part = identified(body)
        points[name] = part.places
        weights.append(np.repeat(part.shares, 3))
    return Samples(mechanism, points, turned, prisms, np.concatenate(weights))


def _leg_points_and_masses(body: Body) -> tuple[Array, Array]:
    """Sample points (k×3, body axes) of a leg, and the mass (k, in kg) that each represents."""
    described = leg_of(body)
    if isinstance(described, LineLeg):
        stations, lengths = centreline_samples(described.line.length, _STATIONS)
        points, mu = described.inertia_points(stations, _CORNERS)
        return points.reshape(-1, 3), np.repeat(mu * lengths / len(_CORNERS), len(_CORNERS))
    leg = equivalent_leg(described)
    properties = leg.timoshenko
    stations, lengths = centreline_samples(leg.length, _STATIONS)
    radii = np.sqrt(np.array([properties.rho_Iz, properties.rho_Iy]) / properties.mu)
    corners = np.tile(_CORNERS * radii, (_STATIONS, 1))
    points = np.column_stack([np.repeat(stations, len(_CORNERS)), corners])
    return points, np.repeat(properties.mu * lengths / len(_CORNERS), len(_CORNERS))
