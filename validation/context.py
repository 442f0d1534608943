"""Context of a task: robot file, preset, and a store of results that earlier tasks computed.

Input: a robot file and the options of a run. Output: `Context`, whose `get` computes a function
once for equal arguments.
"""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import Annotated, Any, Literal, ParamSpec, TypeAlias, TypeVar

from lumped.memo import comparison_fingerprint
from lumped.robot_file import RobotFile
from validation.record_fields import LISTING, RESULTS

Preset: TypeAlias = Literal["quick", "standard", "fine"]
About: TypeAlias = Literal["robot", "leg"]
PRESETS: tuple[Preset, ...] = ("quick", "standard", "fine")
# Name of the robot whose numbers the paper gives.
BUILT_IN = "ifw"
P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class Context:
    """Robot file, preset and options of a run, and a store of expensive results.

    `finer`: preset of the references' meshes. None if the meshes of the run's preset are fine
    enough. `context.get(solid_leg, leg, divisions)` is `solid_leg(leg, divisions)`, computed once
    per process for equal arguments. The function must be pure and defined at the top level of a
    module.
    """

    robot_file: RobotFile
    preset: Preset = "standard"
    options: Mapping[str, str] = field(default_factory=dict)
    finer: Preset | None = field(default=None, kw_only=True)
    _memo: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def meshes(self) -> Preset:
        """Preset whose meshes the references use."""
        return self.finer or self.preset

    def get(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Value of a function for these arguments, from the store if it has been computed."""
        key = memo_key(function, args, kwargs)
        if key not in self._memo:
            self._memo[key] = function(*args, **kwargs)
        value: T = self._memo[key]
        return value


@dataclass(frozen=True)
class ScheduledTask:
    """Task of a run: a comparison, a figure or an assessment.

    `section`: heading under which the report lists the result. Tasks of one `group` share expensive
    results and run in the same process, one after the other. `effort`: expected time in s, for the
    order of tasks and the remaining time.
    """

    id: Annotated[str, RESULTS, LISTING]
    title: Annotated[str, RESULTS, LISTING]
    _: KW_ONLY
    presets: Annotated[tuple[Preset, ...], LISTING] = PRESETS
    section: Annotated[str, LISTING] = ""
    group: str = ""
    effort: float = 1.0


def memo_key(
    function: Callable[..., object], args: tuple[object, ...], kwargs: Mapping[str, object]
) -> str:
    """Key of a stored result: name of the function and hash of its arguments.

    Raises ValueError for a function that is not defined at the top level of a module.
    """
    name = f"{function.__module__}.{function.__qualname__}"
    if "<" in name:
        raise ValueError(f"{name}: only module-level functions have a fixed name")
    return f"{name} {comparison_fingerprint((args, dict(kwargs)))}"
