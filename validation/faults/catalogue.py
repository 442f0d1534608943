"""All faults."""

from validation.faults.fault import Fault, declared
from validation.faults.fem import beams, elements, parts, reduction, solids
from validation.faults.judging import comparisons, pages, verdicts
from validation.faults.lumped import joints, legs, mechanisms, robots

# Named here for what they declare.
LUMPED = (legs, joints, robots, mechanisms)
FINITE_ELEMENTS = (beams, elements, solids, reduction, parts)
JUDGING = (comparisons, verdicts, pages)

FAULTS: tuple[Fault, ...] = declared()
