"""A model of a body of one's own: the Delta with arms twice as stiff as they are.

A `BodyModel` is stiffness and mass on the twists of the interfaces and whatever it has inside.
"""

from dataclasses import replace

from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import compliance as compliance_of
from lumped.system.solution import solved
from validation.models.robot_bodies import static_bodies

at = reference_posture(load_robot("delta").mechanism)
bodies = static_bodies("beam", at.mechanism)
stiffer = {
    name: replace(model, stiffness=2.0 * model.stiffness) if name.startswith("arm") else model
    for name, model in bodies.items()
}
before, after = (solved(assemble(at, models)) for models in (bodies, stiffer))
assert before.idle == 6  # its six rods spin
assert 0.9 < compliance_of(after)[2, 2] / compliance_of(before)[2, 2] < 1.0
