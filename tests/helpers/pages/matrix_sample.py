"""A made-up matrix of adequacy, like that of a robot whose legs are given by a 6×6."""

from lumped.acceptance.requirement import STATIC_QUANTITIES
from validation.adequacy.matrix import Cause, Coordinate, Entry, Matrix, ModelNote

POSES = ((0.145,), (0.4975,), (0.85,))
EQUIVALENT = Cause("equivalent leg: couplings of the 6×6 left out", 0.9, "virtual joints")
DRIVES = Cause("drives only: legs and feet rigid", 1.2, "virtual joints")
UNKNOWN = "say how the mass is distributed"


def entry(model, quantity, curve, **fields):
    """An entry whose verdict follows from the largest of the errors along `curve`.

    Of deflections the whole displacement is off by what it is along the load, which has a sign.
    """
    worst = max(curve, key=abs)
    static = quantity in STATIC_QUANTITIES and not fields.get("measured")
    own = {"errors": tuple(map(abs, curve)), "alongs": tuple(curve)} if static else {}
    along = worst if static else None
    verdict = "adequate" if abs(worst) <= 0.05 else "inadequate"
    return Entry(
        **{
            "model": model,
            "quantity": quantity,
            "error": abs(worst) if static else worst,
            "along": along,
            "uncertainty": 0.001,
            "limit": 0.05,
            "verdict": verdict,
            "pose": POSES[min(curve.index(worst), len(POSES) - 1)],
            "reference": "robot assembled from the legs' own 6×6",
            "errors": tuple(curve),
            "spreads": (0.001,) * len(curve),
            "value": 1e-8 * (1.0 + worst),
            "expected": 1e-8,
            "uncertainties": {"meshes": 0.001},
            "computed_by": (f"validation.models.robot_compliance({model!r})",),
        }
        | own
        | fields
    )


def undecided(model, quantity):
    return entry(
        model,
        quantity,
        (0.0,),
        error=None,
        uncertainty=None,
        verdict="undecided",
        reason=UNKNOWN,
        along=None,
        errors=(),
        alongs=(),
        spreads=(),
        value=None,
        expected=None,
    )


def sample_matrix(**fields):
    off = {"causes": (EQUIVALENT,), "remedy": "take the 6×6 with its couplings"}
    simple = {"causes": (DRIVES,), "remedy": "use vjm", "error_with_remedy": 0.002}
    entries = [
        entry("simplified", "x", (-0.85, -0.88, -1.0), **simple),
        entry("simplified", "y", (-0.86, -0.87, -0.857), **simple),
        entry("simplified", "z", (-1.0, -1.0, -1.0), reason="it knows no such motion"),
        *(entry("vjm", q, (0.0, 0.001, 0.0)) for q in "xyz"),
        *(
            entry(model, q, (-size, -size + 0.01, -size + 0.02), **off, error_with_remedy=0.001)
            for model in ("vjm-equivalent", "segments", "beam")
            for q, size in zip("xyz", (0.17, 0.15, 0.16), strict=True)
        ),
        *(
            undecided(model, f"f{n}")
            for model in ("simplified", "segments", "beam")
            for n in (1, 2)
        ),
    ]
    models = ("simplified", "vjm", "vjm-equivalent", "segments", "beam")
    return Matrix(
        **{
            "robot": "sample",
            "coordinates": (Coordinate("x", "m"),),
            "poses": POSES,
            "models": tuple(
                ModelNote(m, f"title of {m}", "static" if m.startswith("vjm") else "")
                for m in models
            ),
            "quantities": ("x", "y", "z", "phi_x", "f1", "f2", "order"),
            "entries": tuple(entries),
            "notes": ("f1 between 113 and 131 Hz",),
        }
        | fields
    )
