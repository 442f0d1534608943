"""A design team's own test: the segments are good enough for the deflections of their robot.

`pytest docs/examples/design` runs it with the plugin that comes with flexproof.
"""

ROBOT = "five-bar"  # or a path from here: "mine.toml"


def test_segments_hold_for_deflections(flexproof):
    judged = flexproof(ROBOT)
    for quantity in ("x", "y", "z"):
        judged.assert_adequate("segments", quantity, within=0.05)
