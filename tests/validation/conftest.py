import pytest

from validation.export import parts as exported_parts
from validation.models import parts


@pytest.fixture(scope="module")
def coarse_parts():
    """Meshes of some thousand unknowns in the place of those of a run."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (parts, exported_parts):
            patch.setattr(module, "UNKNOWNS", 6_000)
        yield patch
