"""Ball bearings and rail guides from their entries in a robot file, and limits of their preload."""

from collections.abc import Iterator

import numpy as np

from lumped.mechanism.catalogue.ball_contact import BallBearing, bearing_of_size
from lumped.mechanism.catalogue.ball_guide import BallGuide
from lumped.robot_file.rules.tables.joints import BearingEntry, GuideEntry
from lumped.robot_file.rules.tables.values import given
from lumped.text import shown


def ball_bearing(entry: BearingEntry) -> BallBearing:
    """One row of the ball bearing of an entry that has no faults."""
    if entry.size is not None:
        return bearing_of_size(entry.size)
    return BallBearing(
        balls=given(entry.balls),
        ball_diameter=given(entry.ball_diameter),
        pitch_diameter=given(entry.pitch_diameter),
        angle=float(np.radians(entry.contact_angle or 0.0)),
        inner=entry.inner_groove or 0.52,
        outer=entry.outer_groove or 0.53,
    )


def ball_guide(entry: GuideEntry) -> BallGuide:
    """Carriage of an entry that describes rows of balls and has no faults."""
    return BallGuide(
        balls=given(entry.balls),
        ball_diameter=given(entry.ball_diameter),
        spacing=given(entry.spacing),
        width=given(entry.width),
        height=given(entry.height),
        angle=float(np.radians(entry.contact_angle or 45.0)),
        groove=entry.groove or 0.52,
        lines=entry.lines or "O",
    )


def guide_preload_faults(guide: GuideEntry, key: str) -> Iterator[str]:
    """Fault of a preload (N) beyond the classes of catalogues, for a described guide."""
    largest = ball_guide(guide).largest_preload
    if isinstance(guide.preload, float) and guide.preload > largest:
        yield (
            f"{key}.preload = {shown(guide.preload)}: must be at most {largest:.3g} N, 13 % of the "
            "static load rating of these balls; no class of catalogues has more"
        )


def bearing_preload_faults(bearing: BearingEntry, key: str) -> Iterator[str]:
    """Fault of a preload under which the balls leave permanent marks in the grooves."""
    largest = ball_bearing(bearing).largest_preload
    if bearing.preload > largest:
        yield (
            f"{key}.preload = {shown(bearing.preload)}: must be at most {largest:.3g} N, at which "
            "the balls reach the contact pressure of the static load rating, 4200 MPa (ISO 76)"
        )
