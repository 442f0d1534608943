"""Build hook of hatchling: the wheel contains the module `flexproof` as a package.

A module of one file cannot have the marker that its annotations are complete (PEP 561). The sources
have a module, since the launcher has the name that the folder of a package would need.
"""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class FlexproofPackage(BuildHookInterface):  # type: ignore[type-arg]
    """Puts `flexproof.py` and a marker into a folder of the wheel."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add both files, unless the build is editable: that imports the sources themselves."""
        if version == "standard":
            build_data["force_include"] |= {
                "flexproof.py": "flexproof/__init__.py",
                "py.typed": "flexproof/py.typed",
            }
