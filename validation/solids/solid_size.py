"""Number of unknowns of solid legs, and the limit of each preset.

Input: legs and divisions across their sections. Output: number of unknowns, from the blocks of the
section meshes, and the reason if a preset does not allow them. A preset sets the element size; the
number of unknowns depends on the slenderness of the legs.
"""

from collections.abc import Callable, Sequence
from math import ceil

from lumped.equivalent_leg import sectioned_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Leg, LineLeg, SectionedLeg, line_length
from lumped.text import counted
from meshes.loft import leg_sections, mesh_section, why_no_loft
from meshes.section.section_blocks import element_length, section_blocks, sides_of
from meshes.stepped import is_mixed, stepped_sections
from validation.context import PRESETS, Preset

# Largest number of unknowns of one solid that a run factorises: about 20 s and 2 GB, 50 s and 5 GB,
# 7 min and 29 GB (with less memory, the factorisation is refused). A hundred random ordinary robots
# have at most 34 000, 108 000 and 675 000.
LARGEST: dict[Preset, int] = {"quick": 100_000, "standard": 200_000, "fine": 800_000}


def solid_unknowns(leg: SectionedLeg, divisions: int) -> float:
    """Number of unknowns of a leg meshed with quadratic hexahedra, `divisions` across its section.

    Nodes that blocks of the section share are counted twice.
    """
    if isinstance(leg, LineLeg):
        sections = leg_sections(leg) if leg.steps else (mesh_section(leg),)
    else:
        sections = (leg.section,)
    section, length = max(sections, key=lambda part: part.area), line_length(leg)
    size = min(element_length(part, divisions) for part in sections)
    slices = max(2, ceil(length / size))
    if isinstance(leg, LineLeg) and is_mixed(leg.spans):
        return 3.0 * len(stepped_sections(leg.spans, divisions).mesh.nodes) * (2.0 * slices + 1.0)
    try:
        blocks = section_blocks(section, divisions)
        sides = (sides_of(blocks, corners) for corners in blocks.corners)
        nodes = float(sum((2 * across + 1) * (2 * along + 1) for across, along in sides))
    except InputError:
        # A section added by a user: squares that fill its area, four nodes each.
        nodes = 4.0 * section.area / size**2
    return 3.0 * nodes * (2.0 * slices + 1.0)


def why_shapeless(legs: Sequence[Leg]) -> str:
    """Reason why some of `legs` cannot be meshed with any preset. "" if all can be meshed.

    An example is a section that is given by its constants, without an outline.
    """
    # Equal legs have one name, that of the first.
    names = dict.fromkeys(
        f"{leg.name or 'a leg'} ({leg.section.shape})"
        for leg in legs
        if isinstance(leg, ConstantLeg) and not leg.section.has_outline
    )
    if not names:
        lofts = (why_no_loft(leg) for leg in legs if isinstance(leg, LineLeg))
        return next(filter(None, lofts), "")
    return (
        f"{', '.join(names)}: a section by its constants has no outline that could be meshed, so "
        "that there is no solid to compare with"
    )


def too_large(legs: Sequence[Leg], divisions: Sequence[int], preset: Preset) -> str:
    """Reason why a run with this preset does not solve `legs` with `divisions`. "" if it does."""
    if shapeless := why_shapeless(legs):
        return shapeless
    limit = LARGEST[preset]
    reasons = []
    for leg, number in zip(legs, divisions, strict=True):
        constant = sectioned_leg(leg)
        unknowns = solid_unknowns(constant, number)
        if unknowns > limit:
            name = constant.name or "a leg"
            reasons.append(
                f"{name} as a solid of {counted(number, 'division')} has about {unknowns:.2g}"
            )
    if not reasons:
        return ""
    return (
        f"{' and '.join(reasons)} unknowns; preset {preset} allows {limit}; flexproof "
        "solve --model solid estimates time and memory of one solution"
    )


def larger_preset(preset: Preset, accepts: Callable[[Preset], bool]) -> str:
    """Option for the first larger preset for which `accepts` is true, such as "--preset fine".

    "no preset" if there is none.
    """
    larger = PRESETS[PRESETS.index(preset) + 1 :]
    return next(
        (f"--preset {candidate}" for candidate in larger if accepts(candidate)), "no preset"
    )
