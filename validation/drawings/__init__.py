"""The figures of a run: curves of all models in the same axes, and pictures of the robot."""

from validation.exhibits import Drawing


def drawings() -> tuple[Drawing, ...]:
    """All figures of a robot, in the order of the report."""
    # The figures share results with the cases, whose package lists cases and figures together.
    from validation.drawings import (  # noqa: PLC0415
        decision,
        dynamics,
        energy,
        leg_pictures,
        refinement,
        robot_pictures,
        sixty_modes,
        statics,
    )

    return (
        *statics.drawings(),
        *dynamics.drawings(),
        *energy.drawings(),
        *sixty_modes.drawings(),
        *robot_pictures.drawings(),
        *leg_pictures.drawings(),
        *refinement.drawings(),
        *decision.drawings(),
    )
