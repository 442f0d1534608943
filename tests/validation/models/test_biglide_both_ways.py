"""The biglide by its own code and as a mechanism like any other: one set of numbers."""

from dataclasses import replace

import numpy as np
import pytest

from lumped.legs import ConstantLeg, GivenLeg, Material
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.sections import ISection, Tube
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.mechanism import answers
from validation.models.options import STATIC, ModelOptions

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
MODELS = (
    ("simplified", ModelOptions()),
    ("vjm", ModelOptions()),
    ("vjm", ModelOptions(legs="equivalent")),
    ("links", ModelOptions()),
    ("segments", ModelOptions()),
    ("segments", ModelOptions(release="printed", elements=6)),
    ("segments", ModelOptions(layout="literal", equivalent="compliance", elements=6)),
    ("beam", ModelOptions()),
    ("beam", ModelOptions(theory="euler-bernoulli")),
)
COUNT = 4
# Rounding of formulations that eliminate in another order, grown by slender legs' conditions.
ROUNDING = 1e-9


def of_sections(section):
    given = load_robot("biglide")
    legs = (ConstantLeg(length, section, STEEL) for length in (0.9, 0.8))
    first, second = legs
    return replace(given, described=replace(given.robot, leg1=first, leg2=second))


def six_by_six(**masses):
    given = load_robot("ifw")
    plain = [
        GivenLeg(leg.length, leg.mass, leg.compliance, **masses)
        for leg in (given.robot.leg1, given.robot.leg2)
    ]
    return replace(given, described=replace(given.robot, leg1=plain[0], leg2=plain[1]))


ROBOTS = {
    "ifw": lambda: load_robot("ifw"),
    "elastic": lambda: load_robot("examples/elastic-biglide/robot.toml"),
    "tubes": lambda: of_sections(Tube(0.12, 0.006)),
    "I-sections": lambda: of_sections(ISection(0.1, 0.1, 0.008, 0.006)),
    "6x6": six_by_six,
    "6x6 with masses": lambda: six_by_six(mass_centre=0.3, inertia=np.diag([0.4, 2.0, 2.2])),
}


@pytest.fixture(params=ROBOTS)
def robot_file(request):
    return ROBOTS[request.param]()


@pytest.mark.parametrize(("model", "options"), MODELS)
def test_both_ways_are_one(robot_file, model, options):
    robot, mechanism = robot_file.robot, robot_file.mechanism
    if model == "simplified" and robot.tool_offset.any():
        pytest.skip("the closed form answers at B, not at the loaded point")
    stations = robot.stations(5)
    count = 0 if model in STATIC else COUNT
    places = [posture(mechanism, np.array([x])) for x in stations]
    for x, found in zip(stations, answers(model, places, count, options), strict=True):
        expected = robot_compliance(model, robot, x, options)
        n = len(expected)
        largest = max(np.abs(expected).max(), 1e-12)
        assert np.abs(found.compliance[:n, :n] - expected).max() <= ROUNDING * largest
        if count:
            frequencies = robot_frequencies(model, robot, x, COUNT, options)
            frequencies = frequencies[np.isfinite(frequencies)]
            assert found.frequencies == pytest.approx(frequencies, rel=ROUNDING)
