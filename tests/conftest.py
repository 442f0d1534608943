"""What every test needs: no windows, and hypothesis examples that are the same on every run."""

import os

from hypothesis import HealthCheck, settings

os.environ["MPLBACKEND"] = "Agg"
os.environ["PYVISTA_OFF_SCREEN"] = "true"

settings.register_profile(
    "default",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile("ci", settings.get_profile("default"), print_blob=True)
settings.register_profile(
    "search", settings.get_profile("default"), derandomize=False, max_examples=2000
)
settings.load_profile("ci" if "CI" in os.environ else "default")
