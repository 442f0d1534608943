"""Errors, partners of modes by shape, and verdicts, for artificial responses."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from msgspec import structs
from support.fakes.toy_responses import meshes, model, reading, reference
from support.fakes.toy_subject import toy_subject
from support.oracles.verdict_rules import Rule
from support.random.random_subjects import MODES, subject

from lumped.acceptance.quantities import load_quantities
from lumped.acceptance.requirement import Requirement
from validation.adequacy.errors import first_largest
from validation.adequacy.judgement import REST, verdict_matrix
from validation.drawing.text import error_with_spread
from validation.references.reference import Remedy, Step
from validation.responses.mode_partners import frequency_changes, partners, shares_by_shape
from validation.responses.statics_and_modes import PathModes, Statics

AXES = np.eye(4)
A, B, C, D = AXES
# Of A and B.
MIXED = (A + B) / np.sqrt(2.0), (A - B) / np.sqrt(2.0)


def vibration(frequencies, *shapes, visible=1.0):
    """Modes at one pose; `visible` is their share of kinetic energy in the sampled points."""
    shares = np.broadcast_to(visible, (1, len(frequencies)))
    samples = np.column_stack(shapes)[None]
    return PathModes(np.array([frequencies]), samples, np.ones(len(shapes[0])), shares)


TRUTH = vibration([100.0, 150.0, 200.0, 300.0], *AXES)


def subject_of(truth, modes, *further_truths, unsure=0.0, **fields):
    """Subject of one model with `modes`; readings of the reference: `truth`, `further_truths`."""
    if further_truths:
        fields |= {"open": "how the ends are held", "decides": "say how the ends are held"}
    modes_by_reading = {
        f"ends {k}": path_modes for k, path_modes in enumerate((truth, *further_truths))
    }
    half_widths = meshes(frequencies=np.full((1, 4), unsure))
    return replace(
        toy_subject(4),
        models=[model("model", modes=modes)],
        dynamics=reference("truth", modes_by_reading, half_widths, **fields),
    )


def entry(modes, quantity, *further_truths, unsure=0.0):
    """Entry of a model with `modes`; reference: TRUTH and, as other readings, `further_truths`."""
    subject = subject_of(TRUTH, modes, *further_truths, unsure=unsure)
    return verdict_matrix(subject, Requirement(modes=3)).entry("model", quantity)


def test_inconsistent_mode_order_is_undecided():
    """Modes 2 and 3 are exchanged with one end condition and not with the other."""
    # The same robot with other ends: its second and third shape change places.
    swapped = vibration([100.0, 160.0, 190.0, 300.0], A, C, B, D)
    like_the_first = vibration([101.0, 151.0, 202.0, 303.0], *AXES)
    order = entry(like_the_first, "order", swapped, unsure=0.002)
    assert order.verdict == "undecided"
    # Its third stands where the other ends have 190 Hz, its second for 160: 202/190 misleads most.
    assert order.error == pytest.approx(202.0 / 190.0 - 1.0)
    assert order.uncertainty == pytest.approx(0.002 * 202.0 / 190.0)
    assert order.uncertainties == {"meshes": pytest.approx(order.uncertainty)}
    assert (order.value, order.expected) == pytest.approx((202.0, 190.0))
    assert order.reason == (
        "f2 is f3 of the model, f3 is f2 of the model with ends 1; "
        "with the other assumptions all modes are in the same order; "
        "say how the ends are held"
    )


def test_missing_mode_is_inadequate():
    """No mode of the reference's shape, or fewer modes than the reference."""
    missing = entry(vibration([100.0, 200.0], A, C), "f2")
    assert (missing.verdict, missing.error) == ("inadequate", None)
    assert "no mode of this shape" in missing.reason
    absent = vibration([100.0, np.nan], A, np.zeros(4))
    assert [entry(absent, name).verdict for name in ("f1", "f2")] == ["adequate", "inadequate"]


def test_close_modes_are_paired_by_shape():
    """Frequencies are 2 % apart. Modes are paired by shape, not by the order of frequencies."""
    close, swapped = (vibration([100.0, 102.0, 200.0], *pair, C) for pair in ((A, B), (B, A)))
    pairs = partners(close, swapped, 3)
    assert pairs.frequency[0] == pytest.approx([102.0, 100.0, 200.0])
    assert pairs.partner_indices[0].tolist() == [1, 0, 2]
    assert pairs.mac[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("unsure", "open_to"), [(0.0, [(110, 112), (110, 112)]), (0.03, None)])
def test_mixed_modes_are_one_subspace(unsure, open_to):
    """Two close modes are mixed by 45°: the MAC of the pair is 1, that of each mode one half.

    Each mode has a definite partner only if both frequencies are equal.
    """
    close, mixed = (
        vibration([start, start + 2.0, 200.0], *pair, C)
        for start, pair in ((100.0, (A, B)), (110.0, MIXED))
    )
    pairs = partners(close, mixed, 3, np.full((1, 3), unsure))
    assert pairs.mac[0] == pytest.approx(1.0)
    assert sorted(pairs.frequency[0]) == pytest.approx([110.0, 112.0, 200.0])
    if open_to is None:
        assert pairs.partner_indices[0].tolist() == [0, 1, 2]
        open_to = [(110.0, 110.0), (112.0, 112.0)]
    spans = np.column_stack([pairs.lowest[0], pairs.highest[0]])
    np.testing.assert_allclose(spans, [*open_to, (200.0, 200.0)])


@pytest.mark.parametrize(
    ("limit", "verdict"), [(0.05, "undecided"), (0.13, "adequate"), (0.01, "inadequate")]
)
def test_mixed_mode_error_covers_both_partners(limit, verdict):
    """The modes at 104 and 112 Hz mix the reference's at 100 and 104 Hz: f1 is 4 to 12 % off."""
    truth, model = (
        vibration([*pair, 200.0, 300.0], *shapes, C, D)
        for pair, shapes in (((100.0, 104.0), (A, B)), ((104.0, 112.0), MIXED))
    )
    subject = subject_of(truth, model)
    matrix = verdict_matrix(subject, Requirement(frequency=limit, modes=3))
    assert matrix.entry("model", "f1").verdict == verdict


def test_half_local_mode_is_undecided():
    """Each of two reference modes has half its energy in a model's shape and half locally."""
    truth = vibration([100.0, 150.0, 152.0, 300.0], A, B, -B, D, visible=[1.0, 0.5, 0.5, 1.0])
    subject = subject_of(truth, vibration([100.0, 149.0, 250.0, 300.0], A, B, C, D))
    matrix = verdict_matrix(subject, Requirement(modes=3))
    for quantity in ("f2", "f3"):
        entry = matrix.entry("model", quantity)
        assert entry.verdict == "undecided"
        assert "several modes of the reference have the shape of one" in entry.reason


def test_local_mode_has_no_partner():
    """A local mode has 5 % of its energy at the samples, where it looks like a model's mode."""
    truth = vibration([100.0, 150.0, 152.0, 300.0], A, B, B, D, visible=[1.0, 0.05, 1.0, 1.0])
    subject = subject_of(truth, vibration([100.0, 153.0, 250.0, 300.0], A, B, C, D))
    matrix = verdict_matrix(subject, Requirement(modes=3))
    local, true = (matrix.entry("model", quantity) for quantity in ("f2", "f3"))
    assert (local.verdict, local.error) == ("inadequate", None)
    assert "of cross-sections and bodies has 5 % of its kinetic energy" in local.reason
    assert "energy-weighted MAC of at most 0.05" in local.reason
    assert true.error == pytest.approx(153.0 / 152.0 - 1.0)
    # The model's third frequency is another mode than the robot's third.
    assert matrix.entry("model", "order").error == pytest.approx(250.0 / 152.0 - 1.0)


def test_swapped_repeated_pair_keeps_order():
    """The order changes only if a mode of the pair is exchanged with another mode.

    Any two independent combinations of the modes of a repeated pair are modes.
    """
    turned = np.cos(1.0) * B + np.sin(1.0) * C, np.cos(1.0) * C - np.sin(1.0) * B
    truth = vibration([100.0, 150.0, 150.0, 300.0], A, B, C, D)
    for shapes in ((B, C), (C, B), turned):
        model = vibration([100.0, 120.0, 120.0, 300.0], A, *shapes, D)
        matrix = verdict_matrix(subject_of(truth, model), Requirement(modes=3))
        assert matrix.entry("model", "order").error == 0.0
        assert matrix.entry("model", "f2").error == pytest.approx(-0.2)
    model = vibration([90.0, 90.0, 100.0, 300.0], *turned, A, D)
    order = verdict_matrix(subject_of(truth, model), Requirement(modes=3)).entry("model", "order")
    assert (order.verdict, order.error) == ("inadequate", pytest.approx(90.0 / 150.0 - 1.0))


def test_close_mode_order_is_undecided():
    """Two modes exchanged in the model are 0.1 Hz apart in a reference that is uncertain by 1 %."""
    truth = vibration([100.0, 100.1, 200.0, 300.0], A, B, C, D)
    model = vibration([90.0, 112.0, 200.0, 300.0], B, A, C, D)
    matrix = verdict_matrix(subject_of(truth, model, unsure=0.01), Requirement(modes=3))
    assert matrix.entry("model", "order").verdict == "undecided"
    assert matrix.entry("model", "f1").error == pytest.approx(0.12)


@pytest.mark.parametrize(
    ("coarse", "changes"),
    [
        # By number it would be 2 % of each: the one that alone has changed comes from 4 % above,
        (vibration([100.0, 104.0, 106.08, 200.0], A, C, B, D), [0.0, 0.04, 0.0]),
        # or below.
        (vibration([97.92, 100.0, 104.0, 200.0], B, A, C, D), [0.0, 0.04, 0.0]),
        # Modes that mix have the sum of their changes; the third of the family is alone.
        (vibration([101.0, 103.02, 104.0, 200.0], *MIXED, C, D), [0.02, 0.02, 0.0]),
        # Of a mode that the coarse mesh does not have nothing is known.
        (vibration([100.0, 104.0], A, C), [0.0, np.nan, 0.0]),
    ],
)
def test_frequency_errors_are_between_equal_shapes(coarse, changes):
    """Four modes, three of them close: frequencies are compared between modes of equal shape."""
    fine = vibration([100.0, 102.0, 104.0, 200.0], *AXES)
    errors = frequency_changes(fine, coarse, 3)[0]
    assert errors == pytest.approx(changes, nan_ok=True)


def test_mesh_change_spans_both_sides_of_fine_mesh():
    """Coarse and middle mesh lie 1 % above and below the fine one: the change is 2 %, not 0."""
    fine, coarse, middle = (vibration([f, 200.0], A, B) for f in (100.0, 101.0, 99.0))
    assert frequency_changes(fine, coarse, 1, middle) == pytest.approx(np.array([[0.02]]))


@pytest.mark.parametrize("angle", [0.0, 45.0, 90.0])
def test_cut_pair_leaves_half_widths_of_other_modes(angle):
    """The last computed mode belongs to a pair of equal frequency, of which one is not computed.

    On each mesh round-off determines its direction in the plane of the pair. If the directions
    differ by 90°, the mode has no partner on the other mesh.
    """
    angle = np.radians(angle)
    fine = vibration([100.0, 150.0, 300.0], A, B, C)
    last = np.cos(angle) * C + np.sin(angle) * D
    coarse = vibration([101.0, 153.0, 309.0], A, B, last)
    changes = frequency_changes(fine, coarse, 3)
    assert np.isnan(changes[0, 2]) == (angle > np.radians(46.0))
    assert shares_by_shape(fine, fine, changes, 2) == pytest.approx(np.array([[0.01, 0.02]]))


def test_mode_mixed_with_unpaired_has_no_half_width():
    """B is missing on the coarse mesh, and A has a part of it: the sum of both is unknown."""
    cosine, sine = np.cos(np.radians(19.0)), np.sin(np.radians(19.0))
    fine = vibration([100.0, 101.0], A, B)
    other = 0.5 * (cosine * B - sine * A) + np.sqrt(0.75) * D
    coarse = vibration([100.5, 130.0], cosine * A + sine * B, other)
    assert np.isnan(frequency_changes(fine, coarse, 2)).all()


@pytest.mark.parametrize(("common", "number"), [(0.4, -1), (0.6, 0)])
def test_mac_below_half_is_not_a_partner(common, number):
    """Shapes with a MAC of 0.4 are no partners, with 0.6 they are."""
    model = vibration([100.0], np.sqrt(common) * A + np.sqrt(1.0 - common) * D)
    pairs = partners(vibration([100.0, 150.0, 200.0], A, B, C), model, 1)
    assert pairs.partner_indices.tolist() == [[number]]
    assert pairs.mac[0, 0] == pytest.approx(common)


def test_entry_has_largest_error_of_readings():
    """Two interpretations of the robot file give references of 100 and 104 Hz."""
    model = vibration([101.0, 150.0, 200.0, 300.0], *AXES)
    frequency_entry = entry(model, "f1", vibration([104.0, 150.0, 200.0, 300.0], *AXES))
    near, far = 101.0 / 100.0 - 1.0, 101.0 / 104.0 - 1.0
    assert (frequency_entry.value, frequency_entry.expected) == pytest.approx((101.0, 104.0))
    assert frequency_entry.error == pytest.approx(far, rel=1e-12)
    assert frequency_entry.readings == pytest.approx({"ends 0": near, "ends 1": far}, rel=1e-12)
    assert (frequency_entry.low, frequency_entry.high) == pytest.approx((far, near), rel=1e-12)
    assert frequency_entry.expected_range == pytest.approx((100.0, 104.0), rel=1e-12)


@pytest.mark.parametrize("interior", ["", "give the section of the leg"])
def test_interval_covers_crossing_modes(interior):
    """As the inside of a leg stiffens, mode A rises from 100 to 130 Hz and mode B from 110 to 115.

    In between either may be f1 (up to 115 Hz) or f2 (from 110 Hz). Only the stiffness inside a
    leg varies between two readings; other readings are not combined.
    """
    soft = vibration([100.0, 110.0, 200.0, 300.0], A, B, C, D)
    stiff = vibration([115.0, 130.0, 200.0, 300.0], B, A, C, D)
    model = vibration([112.0, 120.0, 200.0, 300.0], B, A, C, D)
    inside = {"interior": interior, "insides": ("soft", "stiff")}
    subject = subject_of(soft, model, stiff, unsure=0.01, **inside)
    matrix = verdict_matrix(subject, Requirement(modes=3))
    first, second = (matrix.entry("model", name) for name in ("f1", "f2"))
    assert first.readings == pytest.approx({"ends 0": 0.2, "ends 1": 112.0 / 115.0 - 1.0})
    assert second.readings == pytest.approx({"ends 0": 112.0 / 110.0 - 1.0, "ends 1": -1.0 / 13.0})
    # Each bound with 1 % of its ratio.
    assert (first.low, first.high) == pytest.approx((0.99 * 112.0 / 115.0 - 1.0, 0.212))
    highest = 112.0 / 110.0 * 1.01 - 1.0
    if interior:
        highest = 120.0 / 110.0 - 1.0 + 0.01 * 112.0 / 110.0
        inside = second.uncertainties["stiffness distribution of the legs"]
        assert inside == pytest.approx(0.5 * (120.0 / 110.0 - 120.0 / 130.0))
    assert (second.low, second.high) == pytest.approx((0.99 * 120.0 / 130.0 - 1.0, highest))


def static_entry(*factors, unsure=0.0, limit=0.05):
    """Entry of deflection x; each reading of the reference is `factors` times as stiff."""
    toy = toy_subject(3)
    truth = toy.responses.statics(toy.models[0], reading(""))
    names = ("rigid pins", "averaged ones")
    compliance_by_reading = {
        name: (1.0 / factor) * truth for name, factor in zip(names, factors, strict=False)
    }
    half_widths = meshes(displacements=np.full((2, 7), unsure))
    subject = replace(
        toy,
        models=[model("model", truth)],
        statics=reference("solids", compliance_by_reading, half_widths, open="how pins are held"),
    )
    return verdict_matrix(subject, Requirement(deflection=limit, modes=3)).entry("model", "x")


def test_equal_model_has_zero_error():
    """Reference uncertain by 4.4 %: the error is between 0 and 4.4 %."""
    compliance_entry = static_entry(1.0, unsure=0.044)
    assert (compliance_entry.error, compliance_entry.uncertainty) == (
        0.0,
        pytest.approx(0.044, rel=1e-12),
    )
    assert (compliance_entry.low, compliance_entry.high) == (0.0, pytest.approx(0.044, rel=1e-12))
    assert (compliance_entry.verdict, compliance_entry.readings) == ("adequate", {})
    assert plain(error_with_spread(compliance_entry)) == "below 4.4 %"


def test_error_text_includes_half_width():
    """1.2 for 1 ± 1 %: an error of 20 % ± 1.2 %."""
    # |u − u*|/|u*| is 0.2; 1 % of the reference moves it by 1 % of |u|/|u*|.
    compliance_entry = static_entry(1.2, unsure=0.01)
    assert (compliance_entry.error, compliance_entry.uncertainty) == pytest.approx(
        (0.2, 0.012), rel=1e-12
    )
    assert (compliance_entry.low, compliance_entry.high) == pytest.approx((0.188, 0.212), rel=1e-12)
    assert plain(error_with_spread(compliance_entry)) == "20 % ± 1.2 %"


def test_error_text_lists_differing_readings():
    """0 % with rigid and 33 % with averaged interfaces: both are shown.

    Close ones give one bound.
    """
    compliance_entry = static_entry(1.0, 1.33)
    assert (compliance_entry.verdict, compliance_entry.readings) == (
        "undecided",
        {"rigid pins": 0.0, "averaged ones": pytest.approx(0.33, rel=1e-12)},
    )
    assert (compliance_entry.error, compliance_entry.uncertainty) == (
        pytest.approx(0.33, rel=1e-12),
        0.0,
    )
    assert (compliance_entry.low, compliance_entry.high) == (0.0, compliance_entry.error)
    assert (
        plain(error_with_spread(compliance_entry)) == "0 % with rigid pins, 33 % with averaged ones"
    )
    # Closer together than each is known they say no more than the bound does.
    compliance_entry = static_entry(1.0, 1.01, unsure=0.03)
    assert plain(error_with_spread(compliance_entry)) == "below 4 %"


@pytest.mark.parametrize(
    ("sizes", "number"),
    [
        ([2.0, 2.0 + 1e-12], 0),
        ([2.0, 2.1], 1),
        ([1.0, np.inf], 1),
        ([-1.0, -0.5], 1),
        ([0.0, 0.0], 0),
    ],
)
def test_first_of_equal_largest_values_is_chosen(sizes, number):
    """Values that differ by rounding are equal; infinite ones are the largest."""
    assert first_largest(np.array(sizes)) == number


@pytest.mark.parametrize("rounding", [-1e-12, 0.0, 1e-12])
def test_tied_readings_give_first_one(rounding):
    """The errors differ only by rounding: 6 % above one reading of the file, 6 % below another."""
    compliance_entry = static_entry(1.06, 0.94 + rounding)
    assert compliance_entry.error == pytest.approx(0.06, rel=1e-9)
    assert compliance_entry.along == pytest.approx(0.06, rel=1e-9)


@pytest.mark.parametrize(("limit", "verdict"), [(0.05, "undecided"), (0.07, "adequate")])
def test_interval_between_readings_contains_zero(limit, verdict):
    """The model is 6 % above one reading and 6 % below the other: it may be exact."""
    compliance_entry = static_entry(0.94, 1.06, limit=limit)
    assert compliance_entry.readings == pytest.approx({"rigid pins": 0.06, "averaged ones": 0.06})
    assert (compliance_entry.low, compliance_entry.high, compliance_entry.verdict) == (
        0.0,
        pytest.approx(0.06),
        verdict,
    )
    # Beyond both readings the nearer of them is the least error.
    compliance_entry = static_entry(1.02, 1.06)
    assert (compliance_entry.low, compliance_entry.high) == pytest.approx((0.02, 0.06))


@pytest.mark.parametrize(("value", "text"), [(98.0, "−2 % ± 0.98 %"), (100.5, "below 1.5 %")])
def test_frequency_error_keeps_its_sign(value, text):
    """98 for 100 Hz ± 1 %: −2 % ± 0.98 %. An interval that contains zero is shown by its bound."""
    frequency_entry = entry(vibration([value, 150.0, 200.0, 300.0], *AXES), "f1", unsure=0.01)
    assert (frequency_entry.low, frequency_entry.high) == pytest.approx(
        (
            frequency_entry.error - frequency_entry.uncertainty,
            frequency_entry.error + frequency_entry.uncertainty,
        ),
        rel=1e-12,
    )
    assert plain(error_with_spread(frequency_entry)) == text


def test_wide_interval_is_shown_by_bounds():
    """Intervals that are not symmetric about the error: "19 to 35 %"."""
    compliance_entry = static_entry(1.2, unsure=0.01)
    assert plain(error_with_spread(structs.replace(compliance_entry, high=0.35))) == "19 to 35 %"
    signed = entry(vibration([90.0, 150.0, 200.0, 300.0], *AXES), "f1", unsure=0.01)
    wider = structs.replace(signed, low=-0.2)
    assert plain(error_with_spread(wider)) == "−20 to −9.1 %"


@pytest.mark.parametrize("ends", [{"low": -np.inf}, {"low": -np.inf, "high": np.inf}])
def test_error_is_unbounded_if_no_mode_matches(ends):
    """No mode of the model matches any reference mode that could have this number."""
    bounded = entry(vibration([90.0, 150.0, 200.0, 300.0], *AXES), "f1", unsure=0.01)
    unbounded = structs.replace(bounded, **ends)
    assert plain(error_with_spread(unbounded)) == "−10 % without bound"


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def test_limit_in_metres_holds_in_each_pose():
    """Errors are 4 µm (4 % of 0.1 mm) and 20 µm (2 % of 1 mm); 20 µm are a fifth of 0.1 mm."""
    compliances = np.array([1e-8 * np.eye(6)] * 2)
    due, displaced = (
        Statics(compliances, np.array(along)[:, None, None] * np.eye(6)[:1])
        for along in ((1e-4, 1e-3), (1.04e-4, 1.02e-3))
    )
    subject = replace(
        toy_subject(3),
        models=[model("model", displaced)],
        statics=reference("exact", {"": due}),
        loads=load_quantities(["press"]),
    )
    requirement = Requirement(modes=3, loads=("press",), displacement=1e-4)
    load_entry = verdict_matrix(subject, requirement).entry("model", "load:press")
    assert (load_entry.verdict, load_entry.pose) == ("adequate", (0.7,))
    assert (load_entry.error, load_entry.limit) == pytest.approx((0.02, 0.1), rel=1e-9)
    # In both poses beyond 3 µm, the second by more.
    load_entry = verdict_matrix(subject, replace(requirement, displacement=3e-6)).entry(
        "model", "load:press"
    )
    assert (load_entry.verdict, load_entry.pose, load_entry.limit) == (
        "inadequate",
        (0.7,),
        pytest.approx(3e-3),
    )


@pytest.mark.parametrize(
    ("errors", "once", "twice", "expected"),
    [
        # 60 % and 5 % off, then 0 and 5 %, then 0 and 0.1 %: both steps are needed.
        ((1.6e-4, 1.05e-3), (1e-4, 1.05e-3), (1e-4, 1.001e-3), ("first, second", 0.001)),
        # 10 % in both poses, then 10 and 0.5 %: one step is enough.
        ((1.1e-4, 1.1e-3), (1.1e-4, 1.005e-3), (1e-4, 1e-3), ("first", 0.1)),
    ],
)
def test_remedy_meets_limit_per_pose(errors, once, twice, expected):
    """A limit of 20 µm is 20 % of 0.1 mm in the first pose, and 2 % of 1 mm in the second.

    All poses were formerly compared with the limit of the deciding pose: the remedy for the
    first model left it inadequate, and the second model got two remedies.
    """
    compliances = np.array([1e-8 * np.eye(6)] * 2)
    truth, *model_statics = (
        Statics(compliances, np.array(along)[:, None, None] * np.eye(6)[:1])
        for along in ((1e-4, 1e-3), errors, once, twice)
    )
    models = [model(name, statics) for name, statics in zip("abc", model_statics, strict=True)]
    steps = tuple(
        Step(f"cause {name}", "source", after, Remedy(name, f"--{name}"))
        for name, after in zip(("first", "second"), models[1:], strict=True)
    )
    subject = replace(
        toy_subject(3),
        models=models,
        statics=reference("exact", {"": truth}),
        static_steps={"a": steps},
        loads=load_quantities(["press"]),
    )
    requirement = Requirement(modes=3, loads=("press",), displacement=2e-5)
    matrix = verdict_matrix(subject, requirement)
    entry = matrix.entry("a", "load:press")
    assert entry.verdict == "inadequate"
    assert (entry.remedy, entry.error_with_remedy) == (
        expected[0],
        pytest.approx(expected[1], rel=1e-9),
    )
    remedied = "c" if "second" in entry.remedy else "b"
    assert matrix.entry(remedied, "load:press").verdict == "adequate"


LIMITS = (0.02, 0.2)
SEEDS = range(3)


@cache
def entries(seed):
    """Pairs: entry of a random subject, and independent `Rule` for its model and quantity."""
    random_subject, pairs = subject(seed), []
    models = {candidate.name: candidate for candidate in random_subject.models}
    for limit in LIMITS:
        matrix = verdict_matrix(
            random_subject, Requirement(deflection=limit, frequency=limit, modes=MODES)
        )
        pairs += [
            (e, Rule(random_subject, models[e.model], e.quantity.name, MODES))
            for e in matrix.entries
        ]
    return pairs


def same(value, expected):
    """True if texts are equal and numbers equal up to rounding; None equals only None."""
    if isinstance(expected, str):
        return value == expected
    if isinstance(expected, dict):
        return value == pytest.approx(expected, abs=1e-12)
    arrays = np.array(value, float), np.array(expected, float)
    return np.allclose(*arrays, rtol=1e-9, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_entries_equal_independent_rules(seed):
    """Numbers and verdicts of random entries, by rules that are written again for this test."""
    for entry, rule in entries(seed):
        expected = rule.entry(entry.limit)
        shares = expected.pop("causes", None)
        for name, value in expected.items():
            label = f"{name} of {entry.model} {entry.quantity} {entry.limit}"
            assert same(getattr(entry, name), value), label
        if entry.signed:
            assert entry.along is None
        if shares is not None:
            explained(entry, shares)


def explained(entry, shares):
    """Assert that the entry's causes are `shares` of at least half a percent, largest first."""
    shown_shares = {name.replace("rest", REST): s for name, s in shares.items() if abs(s) >= 0.005}
    assert {cause.cause: cause.share for cause in entry.causes} == pytest.approx(shown_shares)
    sizes = [abs(cause.share) for cause in entry.causes]
    assert sizes == sorted(sizes, reverse=True)
    for cause in entry.causes:
        source = "error minus" if cause.cause == REST else f"from {cause.cause}"
        assert cause.source.startswith(source)


def test_random_matrices_have_every_verdict():
    """They also contain missing and exchanged modes, and remedies with and without effect."""
    all_entries = [entry for seed in SEEDS for entry, _ in entries(seed)]
    assert {entry.verdict for entry in all_entries} == {"adequate", "inadequate", "undecided"}
    assert any(entry.error is None for entry in all_entries)
    assert any(entry.quantity.name == "order" and entry.error for entry in all_entries)
    inadequate = [entry for entry in all_entries if entry.verdict == "inadequate"]
    assert {bool(entry.remedy) for entry in inadequate} == {True, False}
    assert any((entry.error_with_remedy or 0.0) > entry.limit for entry in inadequate)
    assert len({len(entry.causes) for entry in inadequate}) > 2
