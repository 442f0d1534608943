"""Value and reference of a comparison share no code but named basics.

`SIDES` has the functions of the two sides of each comparison. The tests find the code that these
use by reading the sources: they follow the names in a function's body through imports. A class
stands for all its methods, and a type in an annotation for the class whose methods are called.
"""

import ast
import inspect
import runpy
from fnmatch import fnmatch
from functools import cache, partial
from pathlib import Path

from fem import multibody
from fem.beams import beam_theory
from fem.beams.beam import beam_leg
from fem.bodies import doubling
from fem.bodies.rooted import RootedBody, rooted_body
from fem.bodies.solid import clamped_leg, solid_leg_matrices
from fem.calculix.mechanism import compliance_and_frequencies
from fem.couplings.end_effects import restrained_compliance
from fem.couplings.wave_cantilever import prism_frequency, wave_frequency
from fem.reduction.craig_bampton import craig_bampton, reduction
from fem.reduction.free_interface import free_interface
from fem.sections import nonuniform_torsion
from fem.sections.composite import composite_properties
from fem.sections.section_constants import beam_properties, section_constants
from fem.sections.waveguide import torsion_wave
from lumped.beam_properties import tip_compliance
from lumped.models import segments, serial_chains
from lumped.models.bodies import link
from lumped.robot_file import load_robot
from lumped.robot_file.variation import variations_of
from lumped.system.assembly import assembly
from lumped.system.solution import solved
from lumped.system.sweep import swept
from validation import paper
from validation.adequacy.judged_models import JUDGED
from validation.case import Case
from validation.cases import cases, ritz
from validation.comparisons.robot_beam_vs_solid import robot_modes
from validation.models.leg_models import leg_matrices
from validation.solids.solid_legs import held_solid
from validation.variations.cases import cases_over

ROOT = Path(__file__).resolve().parents[2]
FILES = runpy.run_path(str(ROOT / "docs" / "pictures" / "architecture.py"))["modules"]()
# Modules, or single functions, that both sides may rest on, and why.
BASICS = {
    "lumped.arrays": "types, and matrices made dense",
    "lumped.beam_properties": "data of legs",
    "lumped.centre_line": "data of legs: the geometry of their lines",
    "lumped.dense.modes": "eigenvalues of small matrices",
    "lumped.errors": "messages",
    "lumped.equivalent_leg": "data of legs",
    "lumped.legs": "data of legs",
    "lumped.line_sections": "data of legs along lines, which solids and polynomials integrate anew",
    "lumped.memo": "results kept for equal arguments",
    "lumped.sections": "data of legs: textbook constants, which fem.sections computes anew",
    "lumped.tapers": "data of legs along lines, as lumped.line_sections",
    "lumped.text": "messages",
    "lumped.model_choices": "names of the choices of options",
    "lumped.screws": "moving and turning twists",
    "lumped.mechanism.body": "data of a mechanism",
    "lumped.mechanism.body_model": "data of a body's model",
    "lumped.mechanism.free_twists": "what kinds of joints let free; Ritz has a list of its own",
    "lumped.mechanism.joint": "data of a mechanism",
    "lumped.mechanism.kinematics.postures:shown_pose": "messages",
    "lumped.mechanism.length_unit": "messages",
    "lumped.mechanism.load": "data of a load",
    "lumped.mechanism.mechanism": "data of a mechanism",
    "meshes": "one mesh for both",
    "fem.bodies.solid:SolidLeg": "a leg's mesh",
    "fem.couplings.grips:rigid_motions": "rigid motions of nodes",
    "fem.solvers.certificate": "counting eigenvalues",
    "fem.solvers.factor:Inertia": "counted eigenvalues",
    "fem.sections.saint_venant": "tractions on free ends, of which a solid's strains are its own",
    "fem.sections.section_constants:poisson_shear_ratio": "νG/E for those tractions",
    "fem.sections.composite": "those tractions in sections of several materials",
    "fem.sections.moduli": "materials of a section's parts, as data",
    "fem.sections.reversal": "symmetry of a section's mesh",
    "fem.sections.waveguide:elasticity": "those tractions in sections of several materials",
    "fem.sections.waveguide:cell_matrices": "those tractions in sections of several materials",
    "fem.sections.waveguide:strains": "those tractions in sections of several materials",
}
# Comparisons that are of two ways through one room, and hence of no more than what sets them apart.
WITHIN = {
    "mechanism.parts.frequency": (
        "fem.reduction",
        "fem.solvers.backends",
        "fem.solvers.block_lanczos",
    )
}
# What solves a mechanism of bodies, and what beside it is each model's own.
ASSEMBLER = (assembly, solved)
MODEL_CODE = {
    "simplified": (),
    "vjm": (serial_chains.compliance,),
    "links": (link,),
    "segments": (segments.segment_leg, segments.static_leg),
    "beam": (beam_leg,),
}
DOUBLED = (doubling.condensed_leg, doubling.tip_compliance)
CANTILEVER = (section_constants, beam_properties, composite_properties, tip_compliance)
SEGMENTS = (*MODEL_CODE["segments"], *ASSEMBLER)
# By id without its parameters: what is put to the test, and what says what that must be. Sentences
# of the paper that name a number have one side alone, and are not here.
SIDES = {
    "*.compliance.solid-free": (DOUBLED, CANTILEVER),
    "*.compliance.solid": (DOUBLED, (*CANTILEVER, restrained_compliance)),
    "*.frequency.solid": (
        (clamped_leg,),
        (
            beam_theory.cantilever_frequencies,
            nonuniform_torsion.cantilever_frequencies,
            torsion_wave,
            wave_frequency,
            prism_frequency,
        ),
    ),
    "refinement.*": (DOUBLED, ()),
    "mechanism.parts.frequency": ((free_interface,), (reduction,)),
    "mechanism.calculix.*": (
        (solid_leg_matrices, craig_bampton, *ASSEMBLER),
        (compliance_and_frequencies,),
    ),
    "mechanism.exudyn": ((beam_leg, *ASSEMBLER), (multibody.frequencies,)),
    "paper.refined.twenty-elements": ((segments.segment_leg,), (beam_theory.bending_frequencies,)),
    "paper.refined.order-of-magnitude": (SEGMENTS, (beam_theory.bending_frequencies,)),
    **dict.fromkeys(
        ("paper.refined.planar-ratio", "paper.refined.profile-*", "paper.family.shorter-is-best"),
        (MODEL_CODE["vjm"], ASSEMBLER),
    ),
    "paper.decision.contradiction": (ASSEMBLER, (held_solid,)),
}


def sides(case: Case):
    head = case.id.partition("[")[0]
    model_code = MODEL_CODE[JUDGED[case.model].kind] if case.model in JUDGED else ()
    if head.startswith("mechanism.anchor"):
        ritz_solution = ritz.compliance if head.endswith("statics") else ritz.frequencies
        return (*model_code, *(() if case.model.startswith("vjm") else ASSEMBLER)), (
            ritz.simplified_response,
            ritz_solution,
        )
    if head.startswith("decision.deflection"):
        return model_code or ASSEMBLER, DOUBLED
    if head.startswith("decision.frequency"):
        return model_code or ASSEMBLER, (held_solid,)
    return next(
        (both_sides for pattern, both_sides in SIDES.items() if fnmatch(head, pattern)), None
    )


@cache
def names(module: str) -> dict[str, ast.stmt | str]:
    """Top-level names of a module: syntax tree of a definition, or origin of an import.

    The origin is "module:name" or the name of a module.
    """
    origins: dict[str, ast.stmt | str] = {}
    for node in ast.parse(FILES[module].read_text(encoding="utf-8")).body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                origins[name] = node
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                origins[name] = node
            case ast.ImportFrom(module=of, names=aliases):
                for alias in aliases:
                    inner = f"{of}.{alias.name}"
                    origins[alias.asname or alias.name] = (
                        inner if inner in FILES else f"{of}:{alias.name}"
                    )
    return origins


def definition_of(module: str, name: str) -> str:
    """Place where a name used in a module is defined, "module:name".

    If the name is a module, its name. "" if the name is not one of this program.
    """
    origin = names(module).get(name, "") if module in FILES else ""
    if not isinstance(origin, str):
        return f"{module}:{name}"
    return definition_of(*origin.split(":")) if ":" in origin else origin


@cache
def uses(definition: str) -> frozenset[str]:
    """Definitions ("module:name") whose names occur in a definition."""
    module, _, name = definition.partition(":")
    used = set()
    for node in ast.walk(names(module)[name]):
        if isinstance(node, ast.Name):
            used.add(definition_of(module, node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            used.add(definition_of(definition_of(module, node.value.id), node.attr))
    return frozenset(definition for definition in used if ":" in definition)


def qualified_names(functions) -> set[str]:
    return {f"{function.__module__}:{function.__name__}" for function in functions}


def closure(definitions: set[str]) -> set[str]:
    """The definitions and all that they use, directly or through others."""
    reached_definitions, todo = set(), definitions
    while todo:
        reached_definitions |= todo
        todo = set().union(*map(uses, todo)) - reached_definitions
    return reached_definitions


def dotted(definition: str) -> str:
    return f"{definition}.".replace(":", ".")


def shared(value, reference, also=()) -> set[str]:
    """Definitions that both sides use, except basics (`BASICS` and `also`).

    A definition that one side names directly is never a basic.
    """
    basics = tuple(map(dotted, (*BASICS, *also)))
    common = closure(qualified_names(value)) & closure(qualified_names(reference))
    by_name = common & (qualified_names(value) | qualified_names(reference))
    return by_name | {
        definition for definition in common if not dotted(definition).startswith(basics)
    }


def of_robot(path: str) -> list[Case]:
    robot = load_robot(path)
    varied = variations_of(robot, ["tool.mass=1:2:3"]) if robot.schema == 2 else ()
    return [*cases(robot.mechanism, 2), *cases_over(robot, varied)]


# Prisms and 6×6s with feet and a tool that give, and parts.
ROBOTS = ("ifw", "five-bar", *(str(path) for path in sorted((ROOT / "examples").glob("*/*.toml"))))
LISTED = [*paper.cases(), *(case for path in ROBOTS for case in of_robot(path))]
CASES = {(case.id.partition("[")[0], case.model): case for case in LISTED}
COMPARED = {key: both for key, case in CASES.items() if (both := sides(case)) is not None}


def roots(compute) -> set[str]:
    """Definitions that compute a case. A closure counts with the functions it holds."""
    function_of_case = compute.func if isinstance(compute, partial) else compute
    function = inspect.unwrap(compute if hasattr(compute, "__wrapped__") else function_of_case)
    closure_contents = [cell.cell_contents for cell in function.__closure__ or ()]
    qualified = {f"{function.__module__}:{function.__qualname__.partition('.')[0]}"}
    return qualified.union(
        *(roots(content) for content in closure_contents if inspect.isfunction(content))
    )


def test_value_and_reference_are_independent():
    """All cases but those of the paper are in `SIDES`; common basics are in `WITHIN`."""
    assert len(COMPARED) > 40
    assert not [key for key in CASES.keys() - COMPARED if not key[0].startswith("paper.")]
    common = {
        key: shared(*both_sides, WITHIN.get(key[0], ())) for key, both_sides in COMPARED.items()
    }
    assert {key: definitions for key, definitions in common.items() if definitions} == {}


def test_comparison_depends_on_both_sides():
    """The case of a comparison uses all functions that are listed as its two sides."""
    for key, (value, reference) in COMPARED.items():
        strange = qualified_names((*value, *reference)) - closure(roots(CASES[key].compute))
        assert not strange, key


def test_reference_by_same_code_is_detected():
    """Common code is detected by name, through two modules, in an assembler, and in annotations."""
    common_code = {
        leg_matrices: beam_leg,
        robot_modes: beam_leg,
        swept: solved,
        rooted_body: RootedBody,
    }
    assert all(shared((first,), (second,)) for first, second in common_code.items())


def test_every_model_has_independent_check():
    """All code of each model is a side of a comparison with Ritz's method."""
    by_ritz = {
        value for value, reference in COMPARED.values() if ritz.simplified_response in reference
    }
    for model, code in MODEL_CODE.items():
        assert any(set(code) <= set(value) for value in by_ritz if value != ASSEMBLER), model
