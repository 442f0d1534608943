"""Charts, scenes of surfaces, text and the style of plots. Nothing here depends on robots."""
