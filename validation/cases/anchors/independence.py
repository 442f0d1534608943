"""The program's check that no headline number is without an independent comparison."""

from dataclasses import replace

from fem.calculix.run import CalculixMissing, calculix_program
from lumped.robot_file import RobotFile, load_robot
from validation.case import Absolute, Case, Measurement
from validation.case_group import CaseGroup
from validation.cases import anchors
from validation.cases.legs import beams
from validation.cases.mechanism import calculix
from validation.context import Context
from validation.independence.headlines import headline_numbers
from validation.independence.listing import SECTION, as_table, rows, without
from validation.independence.trace import independence

cases = CaseGroup(section=SECTION, subject="program")


def comparisons(robot_file: RobotFile) -> tuple[Case, ...]:
    """The comparisons that are about headline numbers of a built-in robot."""
    # Those of one model with another of this program take longer: `cases --independence` has them.
    modes = robot_file.requirement.modes
    if robot_file.is_mechanism:
        described = robot_file.mechanism
        found = (*calculix.cases(), *anchors.of_mechanism(described, modes))
    else:
        found = (
            *beams.cases(),
            *calculix.cases_of_biglide(places=["centre"]),
            *anchors.of_biglide(modes),
            *anchors.paper_cases(),
        )
    return tuple(case for case in found if case.headlines)


def _of_like_legs(robot_file: RobotFile) -> RobotFile:
    """A biglide with its first leg twice: what a leg's numbers rest on is heard once."""
    if robot_file.is_mechanism:
        return robot_file
    robot = robot_file.robot
    return replace(robot_file, described=replace(robot, leg2=robot.leg1))


@cases.case(
    "guard.independence[{kind}]",
    "Every headline number of a {kind} has a comparison whose sides share no code",
    # A biglide with everything that the paper says, and a mechanism of closed loops.
    over={"kind, name": (("biglide", "ifw"), ("mechanism", "five-bar"))},
    quantity="headline numbers without one",
    unit="1",
    reference_kind="closed-form",
    citation="functions heard while each side is computed; a side is what moves with it",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number",
    group="guard.independence.{kind}",
    row="{kind}",
    effort=10.0,
)
def _wanting(context: Context, name: str) -> Measurement:
    del context  # traced on robots of its own, in the smallest preset
    robot_file = _of_like_legs(load_robot(name))
    numbers = headline_numbers(robot_file)
    found = independence(comparisons(robot_file), robot_file, "quick")
    wanting = without(numbers, found)
    notes = [f"{one.number} ({one.shown}): none is independent" for one in wanting]
    try:
        calculix_program()
    except CalculixMissing as missing:
        notes.append(f"{missing}: what only CalculiX compares is not counted")
        wanting = tuple(one for one in wanting if not one.calculix)
    return Measurement(
        float(len(wanting)),
        0.0,
        exact=True,
        notes=tuple(notes),
        table=as_table(rows(numbers, found)),
    )
