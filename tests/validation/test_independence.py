"""Value and reference of a comparison share no code but named basics.

A comparison names the functions of its two sides (`Sides`). What these rest on is read from the
sources: names in a function's body, followed through imports; a class stands for all its methods,
and a type in an annotation for the class whose methods are called.
"""

import ast
import inspect
import runpy
from functools import cache, partial
from pathlib import Path

import pytest

from fem.beams.beam import beam_leg
from fem.bodies.rooted import RootedBody, rooted_body
from lumped.robot_file import load_robot
from lumped.robot_file.variation import variations_of
from lumped.system.solution import solved
from lumped.system.sweep import swept
from validation import paper
from validation.case import Case, Sides
from validation.cases import legs, mechanism
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE
from validation.cases.mechanism.solids import free_modes
from validation.models.legs import leg_matrices
from validation.studies import ritz
from validation.variations.cases import cases_over

ROOT = Path(__file__).resolve().parents[2]
FILES = runpy.run_path(str(ROOT / "docs" / "pictures" / "architecture.py"))["modules"]()
# Modules, or single functions, that both sides may rest on, and why.
BASICS = {
    "lumped.arrays": "types, and matrices made dense",
    "lumped.dense.modes": "eigenvalues of small matrices",
    "lumped.errors": "messages",
    "lumped.legs": "data of legs",
    "lumped.sections": "data of legs: textbook constants, which fem.sections computes anew",
    "lumped.text:shortened": "messages",
    "lumped.text:_LONGEST_LINE": "messages",
    "lumped.screws": "moving and turning twists",
    "lumped.mechanism.body": "data of a mechanism",
    "lumped.mechanism.body_model": "data of a body's model",
    "lumped.mechanism.free_twists": "what kinds of joints let free; Ritz has a list of its own",
    "lumped.mechanism.joint": "data of a mechanism",
    "lumped.mechanism.kinematics.postures:shown_pose": "messages",
    "lumped.mechanism.load": "data of a load",
    "lumped.mechanism.mechanism": "data of a mechanism",
    "meshes": "one mesh for both",
    "fem.bodies.solid:SolidLeg": "a leg's mesh",
    "fem.couplings.grips:rigid_motions": "rigid motions of nodes",
    "fem.solvers.certificate": "counting eigenvalues",
    "fem.sections.saint_venant": "tractions on free ends, of which a solid's strains are its own",
    "fem.sections.section_constants:poisson_shear_ratio": "νG/E for those tractions",
}
# Comparisons that are of two ways through one room, and hence of no more than what sets them apart.
WITHIN = {"mechanism.parts.frequency": ("fem.reduction", "fem.solvers.block_lanczos")}


@cache
def names(module: str) -> dict[str, ast.stmt | str]:
    """What a module's own names stand for: a definition, "module:name" or a module."""
    found: dict[str, ast.stmt | str] = {}
    for node in ast.parse(FILES[module].read_text(encoding="utf-8")).body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                found[name] = node
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                found[name] = node
            case ast.ImportFrom(module=of, names=aliases):
                for alias in aliases:
                    inner = f"{of}.{alias.name}"
                    found[alias.asname or alias.name] = (
                        inner if inner in FILES else f"{of}:{alias.name}"
                    )
    return found


def meant(module: str, name: str) -> str:
    """Where a name of a module is defined, as "module:name"; a module; or "" for all else."""
    found = names(module).get(name, "") if module in FILES else ""
    if not isinstance(found, str):
        return f"{module}:{name}"
    return meant(*found.split(":")) if ":" in found else found


@cache
def uses(definition: str) -> frozenset[str]:
    """Definitions that are named in one."""
    module, _, name = definition.partition(":")
    found = set()
    for node in ast.walk(names(module)[name]):
        if isinstance(node, ast.Name):
            found.add(meant(module, node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found.add(meant(meant(module, node.value.id), node.attr))
    return frozenset(one for one in found if ":" in one)


def named(functions) -> set[str]:
    return {f"{one.__module__}:{one.__name__}" for one in functions}


def rests_on(functions) -> set[str]:
    """Everything that the functions rest on, they themselves included."""
    return closure(named(functions))


def closure(definitions: set[str]) -> set[str]:
    found, todo = set(), definitions
    while todo:
        found |= todo
        todo = set().union(*map(uses, todo)) - found
    return found


def within(definition: str, place: str) -> bool:
    return definition == place or definition.startswith((f"{place}:", f"{place}."))


def shared(sides: Sides, also: tuple[str, ...] = ()) -> set[str]:
    """What both sides rest on beyond the basics; what a side names is never a basic."""
    basics = [*BASICS, *also]
    both = rests_on(sides.value) & rests_on(sides.reference)
    by_name = both & (named(sides.value) | named(sides.reference))
    return by_name | {one for one in both if not any(within(one, basic) for basic in basics)}


def of_robot(path: str) -> list[Case]:
    robot = load_robot(path)
    described = robot.mechanism
    varied = variations_of(robot, ["tool.mass=1:2:3"]) if robot.schema == 2 else ()
    return [*legs.cases(described), *mechanism.cases(described, 2), *cases_over(robot, varied)]


# Prisms and 6×6s with feet and a tool that give, and parts.
ROBOTS = ("ifw", "five-bar", *(str(path) for path in sorted((ROOT / "examples").glob("*/*.toml"))))
LISTED = [*paper.cases(), *(case for path in ROBOTS for case in of_robot(path))]
CASES = {(case.id.partition("[")[0], case.model): case for case in LISTED}


def roots(compute) -> set[str]:
    """The definitions that compute a case: of closures those that hold them, and what they hold."""
    own = compute.func if isinstance(compute, partial) else compute
    function = inspect.unwrap(compute if hasattr(compute, "__wrapped__") else own)
    held = [cell.cell_contents for cell in function.__closure__ or ()]
    found = {f"{function.__module__}:{function.__qualname__.partition('.')[0]}"}
    return found.union(*(roots(one) for one in held if inspect.isfunction(one)))


def test_value_and_reference_share_named_basics_alone():
    assert len(CASES) > 60
    assert not [key for key, case in CASES.items() if case.sides is None]
    common = {key: shared(case.sides, WITHIN.get(key[0], ())) for key, case in CASES.items()}
    assert {key: both for key, both in common.items() if both} == {}


def test_what_computes_a_comparison_rests_on_both_sides_that_it_names():
    for key, case in CASES.items():
        strange = named((*case.sides.value, *case.sides.reference)) - closure(roots(case.compute))
        assert not strange, key


@pytest.mark.parametrize(
    ("value", "reference"),
    [
        (beam_leg, beam_leg),
        (beam_leg, leg_matrices),  # by its name
        (beam_leg, free_modes),  # two rooms away
        (solved, swept),  # one assembler
        (RootedBody, rooted_body),  # a class, by what is annotated
    ],
)
def test_a_reference_by_the_value_s_code_is_seen(value, reference):
    assert shared(Sides((value,), (reference,)))


def test_every_model_has_a_comparison_that_shares_nothing_with_it():
    by_ritz = {
        case.sides.value
        for case in of_robot("ifw")
        if case.sides.reference and case.sides.reference[0] is ritz.on_drives
    }
    for model, own in MODEL_CODE.items():
        assert any(set(own) <= set(value) for value in by_ritz if value != ASSEMBLER), model
