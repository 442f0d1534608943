"""All faults."""

from validation.faults import (
    beam_faults,
    comparison_faults,
    element_faults,
    joint_faults,
    judgement_faults,
    leg_faults,
    lumped_faults,
    page_faults,
    reduction_faults,
    solid_faults,
)
from validation.faults.fault import Fault

FAULTS: tuple[Fault, ...] = (
    *leg_faults.FAULTS,
    *joint_faults.FAULTS,
    *lumped_faults.FAULTS,
    *beam_faults.FAULTS,
    *element_faults.FAULTS,
    *solid_faults.FAULTS,
    *reduction_faults.FAULTS,
    *comparison_faults.FAULTS,
    *judgement_faults.FAULTS,
    *page_faults.FAULTS,
)
