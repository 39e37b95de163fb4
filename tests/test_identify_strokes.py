"""Strokes in few directions: what they tell, with bands by strokes, and what they leave open."""

import numpy as np
import pytest
import virtual_strokes
from asperity import Ellipse, FitError, FrictionLaw
from asperity.identify import (
    FourierDirection,
    FourierReservoir,
    RawData,
    compare_models,
    fit_law,
    load_dependence,
    process,
)
from asperity.identify.evidence.coefficient.static import sliding
from profiles import counts
from table_1 import TABLE_1, TRUTH, sampled

ELLIPSES = FrictionLaw(Ellipse(5.0 / 9.3, 4.49 / 9.3), Ellipse(1.84, 1.19))
ELLIPSES_TRUTH = {
    "reservoir.a": 5.0 / 9.3,
    "reservoir.b": 4.49 / 9.3,
    "reservoir.angle": 0.0,
    "direction.ratio": 1.84 / 1.19,
    "direction.angle": 0.0,
}
SUPERELLIPSES = {"reservoir": "superellipse", "direction": "superellipse"}


def strokes(law, directions, *, repeats=5, seed=0, samples=10, offset=0.0, span=2.0 * np.pi):
    """Return samples of strokes whose forces are each off by 1 % in both components."""
    random = np.random.default_rng(seed)
    phi = np.tile(offset + np.arange(directions) * (span / directions), repeats)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    size = np.hypot(*force.T).mean()
    force = np.repeat(force + 0.01 * size * random.normal(size=force.shape), samples, axis=0)
    force += 0.002 * random.normal(size=force.shape)
    return np.repeat(phi, samples), force, np.repeat(np.arange(phi.size), samples)


def is_near(fit):
    """Return whether all parameters are within six standard errors, of 4 degrees of freedom."""
    found = [(fit.parameters[name], value) for name, value in TRUTH.items()]
    return all(abs(one.value - value) < 6.0 * one.standard_error for one, value in found)


def held(law, truth, seeds, directions, **options):
    found, alarms = np.zeros(len(truth), dtype=int), 0
    for seed in range(seeds):
        fit = fit_law(strokes(law, directions, seed=seed), **options)
        alarms += bool(fit.warnings)
        found += [fit.parameters[name].covers(value) for name, value in truth.items()]
    # Tests of drift and of fit give a false alarm in one fit of some hundreds.
    assert alarms <= 0.02 * seeds
    return found


@counts(8, 200)
@pytest.mark.parametrize("directions", [8, 12, 18, 24])
def test_bands_of_strokes_hold_the_truth(directions, count):
    """Few strokes decide on each parameter, so that bands have few degrees of freedom."""
    law, truth = (ELLIPSES, ELLIPSES_TRUTH) if directions == 8 else (TABLE_1, TRUTH)
    model = "ellipse" if directions == 8 else "superellipse"
    found = held(law, truth, count, directions, reservoir=model, direction=model)
    if count == 200:
        assert (found >= 180).all(), found
        assert (found <= 199).all(), found
    # Fewer than 5 of 8 have a probability of 4e-4 at 95 %.
    assert (found >= 0.6 * count).all(), found


def test_degrees_of_freedom_are_those_of_the_strokes_that_decide():
    fit = fit_law(strokes(TABLE_1, 12))
    degrees = fit.covariance.leverage.degrees(np.eye(7))
    assert (degrees > 5.0).all()
    assert (degrees < 55.0).all()
    # Turns that are alike have one less than their number.
    turning = fit_law(sampled(TABLE_1, 3000, 5, noise=0.01)).covariance
    np.testing.assert_allclose(turning.leverage.degrees(np.eye(7)), 4.0, rtol=1e-9)
    assert turning.degrees[0] == pytest.approx(4.0)


def test_the_scatter_is_that_of_all_strokes_alone():
    """For errors of one size, the variance of few strokes has the mean of the exact one."""
    ratio = np.zeros(5)
    for seed in range(60):
        fit = fit_law(
            strokes(ELLIPSES, 8, repeats=2, seed=seed), reservoir="ellipse", direction="ellipse"
        )
        matrix = fit.descent.sums.matrix.sum(axis=0)
        size = np.hypot(*ELLIPSES.force(np.array([[1.0, 0.0], [0.0, 1.0]])).T).mean()
        exact = np.linalg.inv(matrix) * 10 * (0.01 * size) ** 2
        ratio += np.diag(fit.covariance.scatter) / np.diag(exact) / 60
    np.testing.assert_allclose(ratio, 1.0, atol=0.35)


def test_half_circles_are_enough_for_symmetric_models():
    fit = fit_law(strokes(TABLE_1, 12, span=np.pi, offset=0.05))
    assert fit.coverage.is_symmetric
    assert len(fit.coverage.phi) == 24
    assert np.rad2deg(fit.coverage.widest_gap) == pytest.approx(15.0)
    assert is_near(fit)
    turning = sampled(TABLE_1, 5000, 5, noise=0.01)
    kept = turning[0] % (2.0 * np.pi) < 3.1
    turn = (turning[0] // (2.0 * np.pi)).astype(int)
    half = fit_law((turning[0][kept], turning[1][kept], turn[kept]))
    assert is_near(half)
    # What is not symmetric needs the other half.
    odd = {"reservoir": FourierReservoir(5, odd=True), "direction": FourierDirection(5, odd=True)}
    assert len(fit_law(strokes(TABLE_1, 24), **odd).coverage.phi) == 24
    with pytest.raises(FitError, match=r"forces in 12 sliding directions do not tell the 21 param"):
        fit_law(strokes(TABLE_1, 12, span=np.pi), **odd)


def test_gaps_widen_bands_and_are_reported():
    phi, force = sampled(TABLE_1, 5000, 5, noise=0.01)
    turn = (phi // (2.0 * np.pi)).astype(int)
    place = phi % np.pi
    kept = (place < 0.35) | (place > 0.9)
    whole, gap = fit_law((phi, force)), fit_law((phi[kept], force[kept], turn[kept]))
    assert not whole.coverage.gaps
    np.testing.assert_allclose(gap.coverage.gaps[0], (0.35, 0.9), atol=0.04)
    assert "at most 3" in str(gap.coverage)
    assert str(gap.coverage) in gap.summary()
    # What noise of one size makes of them; the scatter of five turns is itself uncertain by half.
    errors = [np.diag(np.linalg.inv(f.descent.sums.matrix.sum(axis=0))) for f in (whole, gap)]
    assert (errors[1] > errors[0]).all()
    assert is_near(gap)


def test_models_need_as_many_directions_as_parameters():
    few = strokes(TABLE_1, 6)
    with pytest.raises(
        FitError,
        match=r"forces in 6 sliding directions, opposite ones included, do not tell the 7 "
        r"parameters of 'superellipse' for C and 'superellipse' for D: choose models with fewer",
    ):
        fit_law(few)
    assert fit_law(few, reservoir="ellipse", direction="ellipse").parameters
    with pytest.raises(FitError, match="7 parameters"):
        compare_models(few, pairs=[("superellipse", "superellipse")])
    found = {(one.reservoir, one.direction) for one in compare_models(few).candidates}
    assert ("ellipse", "ellipse") in found
    assert ("superellipse", "superellipse") not in found
    assert fit_law(strokes(TABLE_1, 12), reservoir="best", direction="best").reservoir_model


@counts(10, 60)
def test_what_directions_on_the_axes_leave_open_is_named(count):
    """Eight directions along the axes of D and between tell its ratio or its exponent, not both."""
    for seed in range(count):
        fit = fit_law(strokes(TABLE_1, 8, seed=seed))
        for name in ("direction.ratio", "direction.exponent"):
            assert not fit.parameters[name].identifiable
        (warning,) = fit.warnings
        assert warning.startswith("direction.ratio and direction.exponent are not identifiable")
    turned = fit_law(strokes(TABLE_1, 8, offset=0.15))
    assert turned.parameters["direction.exponent"].covers(2.51)
    assert not turned.warnings


def test_a_single_stroke_along_each_of_a_few_directions_has_no_scatter():
    once = strokes(ELLIPSES, 3, repeats=1, span=np.pi, offset=0.1)
    for model in ({"reservoir": "ellipse", "direction": "ellipse"},):
        with pytest.raises(FitError, match="known from a single stroke"):
            fit_law(once, **model)
        assert fit_law(once, **model, confidence=None).turns == 3


def test_a_lack_of_fit_is_seen_between_repeated_strokes():
    wrong = fit_law(strokes(TABLE_1, 12), reservoir="ellipse", direction="ellipse")
    assert any("the model does not fit" in warning for warning in wrong.warnings)
    assert not fit_law(strokes(TABLE_1, 12)).defects["lack of fit"].matters
    assert not fit_law(strokes(TABLE_1, 12, repeats=1)).defects


@pytest.mark.parametrize("ratio", [1.0, 1.25])
def test_the_stick_at_the_start_of_strokes_is_no_part_of_the_law(ratio):
    """With a compliance of 1e-5 m/N, a quarter of a stroke is stick: C was 2 to 6 % too small."""
    circles = {"reservoir": "circle", "direction": "circle"}
    for seed in range(4):
        given = virtual_strokes.records(
            6, seed=seed, kinetic=0.3, ratio=ratio, compliance=1e-5, rate=2000.0
        )
        data = process(RawData([virtual_strokes.star(given)]))
        radius = fit_law(data, **circles).parameters["reservoir.radius"]
        # Four values of 95 % intervals: all within 1.5 of their width but one time in 10³.
        half = radius.high - radius.value
        assert abs(radius.value - 0.3) < 1.5 * half
        assert half < 1e-4
        assert 0.1 < 1.0 - sliding(data).sum() / data.used < 0.4


def test_the_stick_of_strokes_is_no_dependence_on_the_load():
    """At three times the load three times as much of a stroke is stick."""
    runs = [
        virtual_strokes.star(
            virtual_strokes.records(
                2, seed=3, load=load, kinetic=0.3, ratio=1.0, compliance=3e-6, rate=2000.0
            )
        )
        for load in (10.0, 30.0)
    ]
    assert abs(load_dependence(process(RawData(runs))).exponent) < 1e-4


def test_nothing_is_left_out_where_nothing_yields():
    given = virtual_strokes.records(
        6, kinetic=0.3, ratio=1.0, compliance=1e-12, scatter=0.0, rate=2000.0
    )
    data = process(RawData([virtual_strokes.star(given)]))
    # But the first sample of a stroke, in which the virtual force is still that before it.
    assert data.used - sliding(data).sum() <= 2 * data.turns
    found = fit_law(data, reservoir="circle", direction="circle").parameters["reservoir.radius"]
    assert found.value == pytest.approx(0.3, rel=1e-4)
