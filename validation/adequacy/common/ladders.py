"""What the ladders of all robots have in common: each rung takes one cause away.

Sources say by what; the responses are the robot's own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validation.adequacy.response import Response, Rung

_TIMOSHENKO = "use Timoshenko"


@dataclass(frozen=True)
class Refined:
    """Segments on their way to beams: `finer` ones, twice as many as the model's `elements`."""

    elements: int
    finer: Response


def dynamic_rungs(
    names: Sequence[str],
    found: Mapping[str, Response],
    refined: Refined,
    above: tuple[Rung, ...],
    rigid: str,
) -> dict[str, tuple[Rung, ...]]:
    """Ladders of frequencies by name of the model; `above` beams of textbook constants.

    `names` of the alternatives; `found` are the models' modes; `rigid` is what is in `simplified`.
    """

    def same(modes: Response) -> dict[str, Response]:
        return dict.fromkeys(names, modes)

    cause, twice = f"discretisation (n = {refined.elements})", 2 * refined.elements
    segments = (
        Rung(cause, f"{twice} segments, then beam elements", same(refined.finer), f"n = {twice}"),
        Rung(cause, "beam elements of the same constants", same(found["beam"])),
    )
    shear = "shear deformation and rotary inertia left out"
    drives = Rung(f"drives only: {rigid}", "beam elements", same(found["beam"]), "use beam")
    return {
        "simplified": (drives, *above),
        "segments": (*segments, *above),
        "beam": above,
        "segments-euler-bernoulli": (
            Rung(shear, "Timoshenko segments", same(found["segments"]), _TIMOSHENKO),
            *segments,
            *above,
        ),
        "beam-euler-bernoulli": (
            Rung(shear, "Timoshenko beams", same(found["beam"]), _TIMOSHENKO),
            *above,
        ),
    }


def dynamic_upper_rungs(
    names: Sequence[str], own: Response, warping: Mapping[str, Response]
) -> tuple[Rung, ...]:
    """From textbook constants to the sections' `own`, and to `warping` by alternative."""
    return (
        Rung(
            "textbook section constants",
            "fem.sections.section_constants, beam elements",
            dict.fromkeys(names, own),
            "take the section's constants from finite elements",
        ),
        Rung(
            "warping: held at the ends, and non-uniform torsion between them",
            "beams with Reissner's torsion, the section's own Γ",
            warping,
            "add the warping stiffness",
        ),
    )


def static_upper_rungs(
    own: Mapping[str, Response],
    warping: Mapping[str, Response],
    contraction: Mapping[str, Response],
) -> tuple[Rung, ...]:
    """From textbook constants to solids with rigid end faces, by alternative of the reference."""
    return (
        Rung(
            "textbook section constants",
            "fem.sections.section_constants, tip of the cantilever",
            own,
            "take the section's constants from finite elements",
        ),
        Rung(
            "warping held at the ends",
            "Reissner's torsion with held ends, the section's own Γ",
            warping,
            "add the warping stiffness",
        ),
        Rung(
            "contraction and warping by shear held at the ends",
            "fem.couplings.end_effects, exact along the leg",
            contraction,
            "add what rigid end faces take",
        ),
    )


def given_leg_rungs(
    by: str, straight: Mapping[str, Response], as_given: Mapping[str, Response]
) -> tuple[Rung, ...]:
    """From a leg of constant section to the 6×6 that it was made of, by "links with ", say."""
    return (
        Rung(
            "equivalent leg: another diagonal than the 6×6",
            f"{by}the straight leg's entries of the 6×6",
            straight,
        ),
        Rung(
            "equivalent leg: couplings of the 6×6 left out",
            f"{by}the 6×6 as given",
            as_given,
            "take the 6×6 with its couplings",
        ),
    )


def shear_rung(by: str, timoshenko: Mapping[str, Response]) -> Rung:
    """From Euler and Bernoulli to Timoshenko, in statics, likewise."""
    return Rung(
        "shear deformation left out",
        f"{by}Timoshenko's cantilever",
        timoshenko,
        _TIMOSHENKO,
    )


def static_rungs(
    drives: Rung,
    shear: Rung,
    section: tuple[Rung, ...],
    upper: tuple[Rung, ...],
    idealisation: tuple[Rung, ...] = (),
) -> dict[str, tuple[Rung, ...]]:
    """Ladders of statics by name of the model.

    `section` leads from legs of constant section, `idealisation` from parts as such legs, to the
    robot's own legs and parts, `upper` from there to solids.
    """
    constant = (*section, *idealisation, *upper)
    return {
        "simplified": (drives, *upper),
        "vjm": upper,
        "links": upper,
        "vjm-equivalent": constant,
        "segments": constant,
        "segments-stepped": (*idealisation[1:], *upper),
        "segments-condensed": upper,
        "beam": constant,
        "segments-euler-bernoulli": (shear, *constant),
        "beam-euler-bernoulli": (shear, *constant),
    }
