"""Many robots in many postures by all leg models, as units of work for cores or a cluster."""
