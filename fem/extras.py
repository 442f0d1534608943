"""Optional packages of flexproof (extras), and checks that they are installed."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec

from lumped.errors import InputError


@dataclass(frozen=True)
class Extra:
    """An extra: the `modules` that it installs, and the purpose for which it is needed."""

    modules: tuple[str, ...]
    needed_for: str

    @property
    def installed(self) -> bool:
        """True if all modules of the extra can be imported."""
        return all(find_spec(module) for module in self.modules)


# Extras by their names in pyproject.toml.
EXTRAS: Mapping[str, Extra] = {
    "cluster": Extra(("dask", "distributed"), "--cluster"),
    "docs": Extra(
        ("sphinx", "myst_parser", "sphinx_gallery", "pyuff", "pytest"), "the command docs"
    ),
    "exudyn": Extra(("exudyn",), "comparisons with EXUDYN, scripts of export --to exudyn"),
    "gpu": Extra(("cupy", "nvmath"), "--solver cudss"),
    "hammer": Extra(("pyuff", "sdypy"), "--measured with a universal file (.uff, .unv)"),
    "nastran": Extra(("pyyeti", "pandas"), "export --to nastran"),
}


def missing_message(name: str) -> str:
    """Message with the missing modules of an extra and the command to install it.

    "" if the extra is installed.
    """
    extra = EXTRAS[name]
    missing = " and ".join(module for module in extra.modules if not find_spec(module))
    if not missing:
        return ""
    return (
        f"needs {missing}, not installed; ./flexproof extras {name} adds the extra (in an "
        f"environment of your own, in the folder of the sources: pip install '.[{name}]')"
    )


def require_extra(name: str, wanted_by: str) -> None:
    """Raise InputError if an extra is not installed. `wanted_by` is the option that needs it."""
    if message := missing_message(name):
        raise InputError(f"{wanted_by}: {message}")
