"""Robots with changed inputs or digits, and the effect of changed inputs on a reference.

Input: a reading with relative changes of uncertain inputs. Output: the changed robot, or the
reference's statics and modes under these changes. Rule: a reference of solids is not solved again.
Beams with computed section constants and the same end conditions are solved with and without the
changes, and the reference changes in the same way: compliances by a congruence C = T C_beams Tᵀ,
where T = L L_beams⁻¹ and L, L_beams are the Cholesky factors of the compliances without changes;
each frequency by the ratio of the beam frequencies. This is accurate for changes of a few per cent.
"""

from dataclasses import replace

import numpy as np

from lumped.mechanism.mechanism import Mechanism
from validation.kinematics.poses import postures_of
from validation.models.reduced_parts import unknowns_of, with_unknowns
from validation.references.robot_on_path import Factors, Reading, RobotOnPath, robot_at
from validation.responses.mode_partners import partners
from validation.responses.statics_and_modes import PathModes, Statics


def perturbed_robot(robot: RobotOnPath, reading: Reading) -> RobotOnPath:
    """Robot with the changed inputs and printed number of `reading`, in the same poses.

    Raises InputError if the changed values make an invalid robot.
    """
    if reading.factors:
        mechanism = _with_factors(robot, reading.factors)
        poses = [posture.pose for posture in robot.postures]
        robot = robot_at(robot.context, postures_of(mechanism, poses))
    if reading.rounding is not None:
        robot = replace(robot, postures=tuple(robot.roundings[reading.rounding].postures))
    return robot


def _with_factors(robot: RobotOnPath, factors: Factors) -> Mechanism:
    """Mechanism with relative changes of its inputs. Meshes of CAD parts keep their size."""
    unknowns = {name: unknowns_of(body) for name, body in robot.mechanism.parts.items()}
    mechanism = robot.context.robot_file.with_factors(dict(factors))
    return with_unknowns(mechanism, unknowns)


def congruent(reference: Statics, nominal: Statics, perturbed: Statics) -> Statics:
    """Statics of a reference under perturbed inputs, from those of a cheaper beam model.

    `nominal` and `perturbed` are statics of the beam model (the stand-in) without and with the
    change of inputs. The change of displacements under loads is T (see the module docstring) times
    that of the beam model.
    """
    change = perturbed - nominal
    try:
        lower = np.linalg.cholesky(reference.compliances)
        lower = lower @ np.linalg.inv(np.linalg.cholesky(nominal.compliances))
    except np.linalg.LinAlgError:
        # There is no Cholesky factor if the robot is rigid in a direction: the change of the beam
        # model is added.
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
    """Modes of a reference under perturbed inputs, from those of a cheaper beam model.

    `nominal` and `perturbed` are modes of the beam model (the stand-in) without and with the change
    of inputs. Each frequency is multiplied by the ratio of the frequencies of the beam mode with
    the same shape, and each peak of a harmonic response by the ratio of the beam model's peaks.
    """
    count = min(modes.frequencies.shape[1] for modes in (reference, nominal, perturbed))
    partner_indices = partners(reference, nominal, count).partner_indices
    partner_indices = np.where(partner_indices >= 0, partner_indices, np.arange(count))
    changes = perturbed.frequencies[:, :count] / nominal.frequencies[:, :count]
    ratio = np.take_along_axis(changes, partner_indices, 1)
    with np.errstate(invalid="ignore"):
        peaks = reference.peaks * (perturbed.peaks / nominal.peaks)
    first = reference.first(count)
    return replace(first, frequencies=first.frequencies * ratio, peaks=peaks)
