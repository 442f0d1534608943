"""The matrix as data: verdicts of models, what is relied on, its record."""

from msgspec import to_builtins

from lumped.acceptance.requirement import STATIC_QUANTITIES
from validation.adequacy.matrix import (
    Adequacy,
    Assessment,
    Cause,
    Coordinate,
    Entry,
    Matrix,
    ModelNote,
)
from validation.results.outcome import Result, from_plain, plain
from validation.results.records import adequacy_records

QUANTITIES = (*STATIC_QUANTITIES, "f1", "f2", "order")


def entry(model: str, quantity: str, verdict: Adequacy) -> Entry:
    """An entry with numbers that do not matter."""
    causes = (Cause("warping", 0.9, "Γ"), Cause("rest", 0.1))
    return Entry(model, quantity, 0.1, 0.01, 0.05, verdict, (0.5,), "solid legs", causes)


MATRIX = Matrix(
    robot="toy",
    coordinates=(Coordinate("x", "m"),),
    poses=((0.5,),),
    models=(ModelNote("vjm", "", "static"), ModelNote("beam", ""), ModelNote("segments", "")),
    quantities=QUANTITIES,
    entries=(
        *(entry("vjm", name, "adequate") for name in STATIC_QUANTITIES),
        *(
            entry(model, name, "undecided" if name == "f2" else "inadequate")
            for model in ("beam", "segments")
            for name in QUANTITIES
        ),
    ),
)


def test_a_model_is_as_good_as_its_worst_quantity() -> None:
    assert [MATRIX.verdict(model) for model in ("vjm", "beam")] == ["adequate", "inadequate"]
    assert MATRIX.fails(("vjm", "beam"), strict=False) == ("beam",)


def test_what_is_relied_on_and_not_known_fails_where_strict() -> None:
    assert MATRIX.fails(("links",), strict=False) == ()
    assert MATRIX.fails(("links",), strict=True) == ("links",)


def test_the_record_has_the_keys_that_programs_read() -> None:
    record = to_builtins(adequacy_records(MATRIX)[0])
    keys = "model quantity error uncertainty limit verdict pose reference causes remedy"
    assert list(record)[:11] == [*keys.split(), "error_with_remedy"]
    assert record["causes"][0] == {"cause": "warping", "share": 0.9}


def test_a_matrix_survives_its_record() -> None:
    def compute(_: object) -> Matrix:
        raise NotImplementedError

    assessment = Assessment("adequacy", "title", compute)
    result = Result("adequacy", "made", 1.0, found=MATRIX)
    assert from_plain(assessment, plain(result)) == result
