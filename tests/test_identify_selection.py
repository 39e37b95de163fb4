"""Models are told apart where the data can tell, and not where they cannot."""

from types import SimpleNamespace

import numpy as np
import pytest
from asperity import Ellipse, FitError, FrictionLaw, Superellipse
from asperity.identify import (
    FourierReservoir,
    SuperellipseDirection,
    VirtualTribometer,
    compare_models,
    fit_law,
    process,
)
from profiles import counts

LAWS = {
    "isotropic": (FrictionLaw.isotropic(0.14), ("circle", "circle")),
    "collinear": (FrictionLaw.collinear(Ellipse(0.5, 0.4)), ("ellipse", "circle")),
    "ellipses": (FrictionLaw(Ellipse(0.5, 0.4), Ellipse(3.0, 2.0)), ("ellipse", "ellipse")),
    "superellipses": (
        FrictionLaw(Superellipse(0.54, 0.46, 2.94), Superellipse(1.84, 1.19, 2.51)),
        ("superellipse", "superellipse"),
    ),
    "wedges": (FrictionLaw.asperity(1.2, beta=np.deg2rad(36.0)), ("fourier", "superellipse")),
}


def sampled(law, samples=6000, turns=10, noise=0.005, seed=0):
    phi = np.linspace(0.0, turns * 2.0 * np.pi, samples, endpoint=False)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    return phi, force + noise * np.random.default_rng(seed).normal(size=force.shape)


@pytest.mark.parametrize("name", list(LAWS)[:-1])
@counts(1, 3)
def test_the_true_models_are_chosen(name, count):
    law, (reservoir, direction) = LAWS[name]
    for seed in range(count):
        best = compare_models(sampled(law, seed=seed)).best
        assert (best.reservoir, best.direction) == (reservoir, direction)


@pytest.mark.parametrize("name", list(LAWS)[:-1])
def test_they_are_chosen_with_coloured_noise_through_the_tribometer(name):
    law, (reservoir, direction) = LAWS[name]
    raw = VirtualTribometer(
        law, normal_force=9.3, noise_bandwidth=5.0, sample_rate=2e3, turn_rate=0.5, seed=4
    ).record()
    comparison = compare_models(process(raw))
    assert (comparison.best.reservoir, comparison.best.direction) == (reservoir, direction)
    # 20 s of noise that forgets itself within 1/(10π) s hold some 1000 independent values.
    assert 300 < comparison.effective_samples < 6000


def test_no_model_follows_the_errors_of_the_calibration():
    law, (reservoir, direction) = LAWS["superellipses"]
    for rate in (0.16, -0.16):
        raw = VirtualTribometer(law, normal_force=9.3, turn_rate=rate, seed=3).record()
        data = process(raw)
        pairs = [("superellipse", "superellipse"), ("fourier", "superellipse")]
        best = compare_models(data, pairs=pairs).best
        assert (best.reservoir, best.direction) == (reservoir, direction)
        # Taken as exact, the distorted forces are a curve's rather than a superellipse's.
        blind = SimpleNamespace(
            phi=data.phi, force=data.force, normal_force=data.normal_force, turn=data.turn
        )
        assert compare_models(blind, pairs=pairs).best.reservoir == "fourier"


def test_wedges_need_a_curve_for_the_reservoir():
    comparison = compare_models(sampled(LAWS["wedges"][0]))
    assert comparison.best.reservoir == "fourier"
    assert comparison.best_predicting.reservoir == "fourier"


def test_candidates_tell_what_they_are():
    pairs = [("circle", "circle"), ("ellipse", "ellipse"), (FourierReservoir(4), "ellipse")]
    comparison = compare_models(sampled(LAWS["ellipses"][0]), pairs=pairs)
    first, second, third = comparison.candidates
    assert [c.parameters for c in comparison.candidates] == [1, 5, 7]
    assert third.reservoir == "FourierReservoir(order=4)" or "4" in third.reservoir
    assert first.rms > 2.0 * second.rms
    assert second.rms == pytest.approx(0.005, rel=0.05)
    assert second.bic == 0.0
    # Twice the two coordinates more cost about 2 ln n.
    assert third.bic == pytest.approx(2.0 * np.log(comparison.effective_samples), abs=10.0)
    assert comparison.best is second


@pytest.mark.parametrize("name", list(LAWS)[:-1])
def test_the_best_pair_is_fitted(name):
    law, models = LAWS[name]
    fit = fit_law(sampled(law), reservoir="best", direction="best")
    assert (fit.reservoir_model, fit.direction_model) == models
    chosen = fit_law(sampled(law), reservoir=models[0], direction=models[1])
    assert fit.parameters == chosen.parameters
    best = fit.comparison.best
    assert (best.reservoir, best.direction, best.bic) == (*models, 0.0)


def test_one_of_the_models_may_be_given():
    law, models = LAWS["ellipses"]
    for reservoir, direction in (
        (models[0], "best"),
        ("best", models[1]),
        ("best", SuperellipseDirection(2.0)),
    ):
        fit = fit_law(sampled(law), reservoir=reservoir, direction=direction)
        assert (fit.reservoir_model, fit.direction_model) == models


def test_uncorrelated_samples_count_fully():
    comparison = compare_models(sampled(LAWS["ellipses"][0]), pairs=[("ellipse", "ellipse")])
    assert 0.5 * 12_000 < comparison.effective_samples <= 12_000 + 1e-6


def test_one_turn_cannot_be_left_out():
    phi, force = sampled(LAWS["isotropic"][0], 720, 1)
    with pytest.raises(FitError, match="one turn"):
        compare_models((phi, force))
    with pytest.raises(FitError, match="pairs"):
        compare_models(sampled(LAWS["isotropic"][0]), pairs=[])


def test_exact_forces_can_be_compared():
    comparison = compare_models(sampled(LAWS["ellipses"][0], noise=0.0))
    assert comparison.best.rms < 1e-4
    assert "circle" not in (comparison.best.reservoir, comparison.best.direction)


def test_fits_compare_models_of_their_data():
    data = sampled(LAWS["collinear"][0])
    assert fit_law(data).comparison == compare_models(data)


def test_copies_of_samples_tell_no_more_of_models():
    """Noise that neighbours share is worth fewer samples: copies of all leave BIC as it is."""
    phi, force = sampled(LAWS["superellipses"][0], samples=4000, noise=0.0)
    noise = np.repeat(np.random.default_rng(0).normal(size=(400, 2)), 10, axis=0)
    force = force + 0.003 * noise
    series = phi, force, np.arange(4000) // 400
    pairs = [("ellipse", "ellipse"), ("superellipse", "superellipse")]
    once, twice = (
        compare_models(tuple(np.repeat(one, copies, axis=0) for one in series), pairs=pairs)
        for copies in (1, 3)
    )
    assert once.effective_samples < 2000
    assert twice.effective_samples == pytest.approx(once.effective_samples, rel=1e-6)
    for one, other in zip(once.candidates, twice.candidates, strict=True):
        assert other.bic == pytest.approx(one.bic, rel=1e-6, abs=1e-6)
