"""Every headline number is obtained at least twice, by ways that share no code but numpy/scipy.

What the ways have in common beyond the robot file and numpy/scipy is said in `shared`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from validation.case import Headline as Quantity
from validation.case import Outcome
from validation.report.tables import largest_unexplained


@dataclass(frozen=True)
class Way:
    """One way to a number, and the module that goes it."""

    name: str
    module: str


@dataclass(frozen=True)
class Headline:
    """A headline number with its ways, which the cases of that headline compare."""

    quantity: Quantity
    ways: tuple[Way, ...]
    shared: str = "nothing"


@dataclass(frozen=True)
class Agreement:
    """A headline number with the comparisons of this run that hold its ways against each other."""

    headline: Headline
    outcomes: tuple[Outcome, ...]

    @property
    def largest(self) -> Outcome | None:
        """The comparison with the largest unexplained difference."""
        return largest_unexplained(self.outcomes)


_VJM = Way("virtual joints, eqs (3) to (9)", "lumped.models.vjm")
_SEGMENTS = Way("chain of rigid segments and springs", "lumped.models.segments")
_BEAM = Way("beam finite elements", "fem.beams.beam")
_SOLID = Way("3-D solid finite elements", "fem.bodies.solid")

HEADLINES = (
    Headline(
        "deflections of the robot",
        (_VJM, _SEGMENTS, _BEAM),
        "segments and beams share the assembly of the robot, the virtual joints share nothing",
    ),
    Headline(
        "natural frequencies of the robot",
        (_SEGMENTS, _BEAM, Way("superelements of 3-D solids", "fem.solvers.sparse_system")),
        "the assembly of the robot (lumped.system); the legs share nothing",
    ),
    Headline(
        "tip compliance of a leg",
        (
            Way("Timoshenko's cantilever in closed form", "lumped.legs"),
            _SEGMENTS,
            _BEAM,
            _SOLID,
            Way("another solver, where it is installed", "fem.calculix.leg"),
        ),
    ),
    Headline(
        "natural frequencies of a leg",
        (
            Way("roots of the transcendental equation", "fem.beams.beam_theory"),
            Way(
                "Ritz's method in Legendre polynomials", "validation.cases.program.benchmarks.huang"
            ),
            _SEGMENTS,
            _BEAM,
            _SOLID,
        ),
    ),
    Headline(
        "torsion constant of a section",
        (
            Way("Saint-Venant's series", "lumped.sections"),
            Way("Poisson's equation on the section's mesh", "fem.sections.section_constants"),
        ),
    ),
    Headline(
        "frequencies of a deep beam",
        (_BEAM, _SOLID),
    ),
)


def agreements(outcomes: Sequence[Outcome]) -> tuple[Agreement, ...]:
    """The headline numbers that this run compared."""
    found = tuple(
        Agreement(
            headline,
            tuple(
                outcome
                for outcome in outcomes
                if outcome.measurement and outcome.case.headline == headline.quantity
            ),
        )
        for headline in HEADLINES
    )
    return tuple(agreement for agreement in found if agreement.outcomes)
