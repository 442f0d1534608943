"""Robots with perturbed inputs or digits, and transfers of their changes to the reference.

A reference of solids is not solved anew for uncertain inputs. Its distance from beams of the
sections' own constants, held alike, stays the same if inputs are a few per cent off: a congruence
C = T C_beams Tᵀ of compliances with T from both Cholesky factors, and a factor of each frequency.
"""

from dataclasses import replace

import numpy as np

from lumped.mechanism.mechanism import Mechanism
from validation.kinematics.poses import postures_of
from validation.models.reduced_parts import unknowns_of, with_unknowns
from validation.references.robot_on_path import Factors, Reading, RobotOnPath, known_legs, robot_at
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes, Statics


def perturbed_robot(robot: RobotOnPath, reading: Reading) -> RobotOnPath:
    """Robot with the perturbed inputs and the perturbed digit of a reading, in its poses.

    Raises InputError if there is no such robot.
    """
    if reading.factors:
        mechanism = _with_factors(robot, reading.factors)
        poses = [posture.pose for posture in robot.postures]
        robot = robot_at(robot.context, postures_of(mechanism, poses))
    if reading.rounding is not None:
        postures = robot.roundings[reading.rounding].postures
        legs = known_legs(postures[0].mechanism)
        robot = replace(robot, postures=tuple(postures), legs=legs)
    return robot


def _with_factors(robot: RobotOnPath, factors: Factors) -> Mechanism:
    """Mechanism with perturbed inputs, its CAD parts on meshes as fine as the robot's."""
    unknowns = {name: unknowns_of(body) for name, body in robot.mechanism.parts.items()}
    mechanism = robot.context.robot_file.with_factors(dict(factors))
    return with_unknowns(mechanism, unknowns)


def congruent(reference: Statics, nominal: Statics, perturbed: Statics) -> Statics:
    """Reference with the changes of a stand-in's statics from `nominal` to `perturbed`.

    Displacements under loads change by T times the change of the stand-in's.
    """
    change = perturbed - nominal
    try:
        lower = np.linalg.cholesky(reference.compliances)
        lower = lower @ np.linalg.inv(np.linalg.cholesky(nominal.compliances))
    except np.linalg.LinAlgError:
        # In directions in which the robot is rigid, both compliances are equal.
        return Statics(
            reference.compliances + change.compliances,
            reference.load_displacements + change.load_displacements,
        )
    upper = np.swapaxes(lower, 1, 2)
    return Statics(
        lower @ perturbed.compliances @ upper,
        reference.load_displacements + change.load_displacements @ upper,
    )


def scaled(reference: PathModes, nominal: PathModes, perturbed: PathModes) -> PathModes:
    """Reference with the relative changes of a stand-in's frequencies, mode by mode of one shape.

    Peaks of responses change by the same ratios as the stand-in's.
    """
    count = min(modes.frequencies.shape[1] for modes in (reference, nominal, perturbed))
    number = partners(reference, nominal, count).number
    number = np.where(number >= 0, number, np.arange(count))
    changes = perturbed.frequencies[:, :count] / nominal.frequencies[:, :count]
    ratio = np.take_along_axis(changes, number, 1)
    with np.errstate(invalid="ignore"):
        peaks = reference.peaks * (perturbed.peaks / nominal.peaks)
    return replace(
        reference,
        frequencies=reference.frequencies[:, :count] * ratio,
        samples=reference.samples[:, :, :count],
        seen=reference.seen[:, :count],
        peaks=peaks,
    )
