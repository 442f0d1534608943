"""Lumped models of a parallel robot: virtual joints, rigid segments, and the data they share."""
