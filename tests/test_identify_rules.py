"""The four fits have the same rules: losses, confidence, covariance, a law to save, comparison."""

import math

import asperity as asp
import numpy as np
import pytest
from asperity.errors import FitError, ParameterError
from asperity.identify import IdentifiedLaw, Launch, fit_law, fit_patch, fit_paths, fit_supports
from asperity.identify.estimator.loss import Loss
from asperity.identify.estimator.mistakes import Mistake, explaining
from asperity.track import MeasuredPath
from scipy.integrate import cumulative_trapezoid

LOSSES = ("linear", "soft_l1", "huber", "cauchy")
POINTS = np.array([[0.05, 0.0], [-0.03, 0.04], [-0.03, -0.04]])


def forces(**options):
    law = asp.FrictionLaw.collinear(asp.Disk(0.4))
    phi = np.linspace(0.0, 8.0 * np.pi, 2000, endpoint=False)
    slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    measured = -law.force(slip) + 0.004 * np.random.default_rng(1).normal(size=slip.shape)
    measured[::100] *= 1.5
    return fit_law((phi, measured), reservoir="circle", direction="circle", **options)


def patch(**options):
    random = np.random.default_rng(0)
    truth = asp.FrictionLaw.associated(asp.CoulombContensou(0.4))
    twist = random.normal(size=(200, 3))
    wrench = -truth.force(twist) + 0.004 * random.normal(size=(200, 3))
    wrench[::50] *= 1.5
    return fit_patch(wrench, twist, reservoir="contensou", **options)


def supports(**options):
    random = np.random.default_rng(0)
    move = random.normal(size=(100, 3)) * [0.01, 0.01, 0.2]
    velocity = move[:, None, :2] + move[:, None, 2:] * POINTS[:, ::-1] * [-1.0, 1.0]
    along = velocity / np.linalg.norm(velocity, axis=-1, keepdims=True)
    force = 0.4 * along * np.array([[6.0], [5.0], [5.0]])
    torque = POINTS[:, 0] * force[..., 1] - POINTS[:, 1] * force[..., 0]
    pushes = np.column_stack([np.zeros((100, 3)), move, force.sum(1), torque.sum(1)])
    pushes[:, 6:] *= 1.0 + 0.01 * random.normal(size=(100, 3))
    pushes[::50, 6:] *= 1.5
    return fit_supports(pushes, POINTS, weight=16.0, **options)


def paths(**options):
    point = asp.SlidingPoint(0.018, law=asp.FrictionLaw.isotropic(0.4))
    measured = []
    for k, speed in enumerate((1.0, 1.2, 1.3, 1.5)):
        run = asp.simulate(point, dt=2e-3, t_end=0.6, u0=[speed, 0.1 * k])
        noise = 2e-4 * np.random.default_rng(k).normal(size=run.q.shape)
        noise[::50] += 3e-3
        measured.append(MeasuredPath(run.t, run.q + noise, np.full(noise.shape, 2e-4)))
    return fit_paths(
        measured,
        system=point,
        reservoir="circle",
        direction="circle",
        launch=Launch(place=(0.0, 0.0), place_error=1e-3),
        **options,
    )


FITS = {
    "fit_law": (forces, "reservoir.radius"),
    "fit_patch": (patch, "mu"),
    "fit_supports": (supports, "mu"),
    "fit_paths": (paths, "reservoir.radius"),
}
every_fit = pytest.mark.parametrize("name", FITS)


@pytest.mark.parametrize("components", [1, 2])
@pytest.mark.parametrize("kind", LOSSES)
def test_weights_and_curvatures_are_derivatives_of_the_loss(kind, components):
    """ρ is the integral of its weight, and the curvature the mean slope of ρ′e."""
    loss = Loss(kind, 0.7, components=components)
    size = np.linspace(0.0, 8.0, 16_001)
    value, weight, bend = loss.at(size**2)
    assert (value[0], weight[0]) == (0.0, 1.0)
    np.testing.assert_allclose(cumulative_trapezoid(weight, size**2), value[1:], rtol=1e-5)
    along = np.gradient(weight * size, size)
    # Across the residual, the slope of the gradient is ρ′.
    mean = along if components == 1 else 0.5 * (along + weight)
    smooth = np.abs(size - loss.bend) > 0.01
    np.testing.assert_allclose(bend[smooth], mean[smooth], atol=2e-3)


@every_fit
def test_every_fit_takes_four_losses(name):
    fit, parameter = FITS[name]
    found = {loss: fit(loss=loss) for loss in LOSSES}
    off = {loss: abs(one.parameters[parameter].value / 0.4 - 1.0) for loss, one in found.items()}
    assert [one.loss.kind for one in found.values()] == list(LOSSES)
    assert max(off["soft_l1"], off["huber"], off["cauchy"]) < 0.01, off
    # Outliers have the less weight the further one goes from least squares.
    assert off["cauchy"] < off["linear"]
    assert found["cauchy"].parameters[parameter].covers(0.4)
    with pytest.raises(ParameterError, match="loss: must be"):
        fit(loss="absolute")


@every_fit
def test_every_fit_goes_without_intervals(name, tmp_path):
    fit, parameter = FITS[name]
    found, usual = fit(confidence=None), fit()
    one = found.parameters[parameter]
    assert one.value == usual.parameters[parameter].value
    assert one.identifiable
    assert math.isnan(one.low)
    assert math.isnan(one.standard_error)
    assert found.covariance is None
    assert "(no interval)" in found.summary()
    found.save_law(tmp_path / "law.toml")
    assert IdentifiedLaw.load(tmp_path / "law.toml").turns is None
    with pytest.raises(ParameterError, match="confidence: must lie between 0 and 1"):
        fit(confidence=1.0)


@every_fit
def test_every_fit_saves_its_law_with_a_covariance(name, tmp_path):
    fit, parameter = FITS[name]
    found = fit()
    path = found.save_law(tmp_path / "law.toml")
    loaded = IdentifiedLaw.load(path)
    assert loaded == found.identified_law.replace(provenance=loaded.provenance)
    assert loaded.law == found.law == asp.FrictionLaw.load(path)
    at = loaded.names.index(parameter)
    usual = found.parameters[parameter]
    assert loaded.values[at] == pytest.approx(usual.value, rel=1e-12)
    assert loaded.standard_errors[at] == pytest.approx(usual.standard_error, rel=1e-9)
    np.testing.assert_allclose(loaded.covariance, found.covariance.total)
    drawn = loaded.sample_values(400, seed=1)[:, at]
    within = (usual.low <= drawn) & (drawn <= usual.high)
    assert within.mean() == pytest.approx(0.95, abs=0.03)
    assert loaded.sample(1, seed=1)[0].dimension == found.law.dimension
    # Saved as a result, it gives the same law.
    found.save(tmp_path / "fit.npz")
    assert type(found).load(tmp_path / "fit.npz").identified_law == found.identified_law


@pytest.mark.parametrize(
    "options",
    [
        {"reservoir": "ellipsoid"},
        {"reservoir": "ellipsoid", "direction": "ellipsoid"},
        {"reservoir": "supports", "points": 2, "friction": "ellipse"},
        {"reservoir": "contensou", "direction": "ellipsoid"},
    ],
)
def test_laws_of_all_patches_can_be_drawn_from_a_file(options, tmp_path):
    random = np.random.default_rng(3)
    twist = random.normal(size=(200, 3))
    truth = asp.FrictionLaw.associated(asp.CoulombContensou(0.3))
    wrench = -truth.force(twist) + 0.01 * random.normal(size=(200, 3))
    fit = fit_patch(wrench, twist, **options)
    loaded = IdentifiedLaw.load(fit.save_law(tmp_path / "law.toml"))
    assert loaded.law == fit.law
    assert loaded.names == tuple(one.name for one in fit.model.coordinates)
    spread = np.array([one.force(twist) for one in loaded.sample(20, seed=0)]).std(axis=0)
    assert 0.0 < np.median(spread) < 0.05
    text = (tmp_path / "law.toml").read_text()
    (tmp_path / "wrong.toml").write_text(text.replace("[parameters.model]", "[parameters.modell]"))
    with pytest.raises(asp.ConfigurationError, match="model"):
        IdentifiedLaw.load(tmp_path / "wrong.toml")
    with pytest.raises(ParameterError, match="direction_model: must be None"):
        fit.identified_law.replace(direction_model="circle")


def test_comparisons_have_one_rule():
    """The best predicting model is the smallest within a standard error of the best."""
    for found in (forces().comparison, patch().comparison):
        good = [one for one in found.candidates if one.behind <= one.behind_error]
        assert found.best_predicting == min(good, key=lambda one: one.parameters)
        assert min(one.behind for one in found.candidates) == 0.0
        assert found.best.bic == 0.0
        whole = [one.left_out for one in found.candidates]
        np.testing.assert_allclose(np.square(whole), found.errors.sum(axis=1))
        first, second = (one.name for one in found.candidates[:2])
        saved = found.improvement(second, over=first)
        assert saved.value == pytest.approx(1.0 - (whole[1] / whole[0]) ** 2)
        assert found.to_pandas().shape == (len(whole), 6)
    # What a fit has not seen it misses by more than what it has.
    for one in patch().comparison.candidates:
        assert one.left_out > 1.001 * one.rms


@pytest.mark.parametrize("name", ["fit_law", "fit_supports", "fit_paths"])
def test_bands_take_the_law_of_every_fit_in_the_plane(name, tmp_path):
    from asperity import predict

    scenario, law = predict.write_example("sliding point", tmp_path / "in")
    FITS[name][0]().save_law(law)
    done = predict.simulate_scenario(scenario, bands=True)
    assert len(done.bands.draws) == 400
    assert (done.bands.low < done.bands.high).any()


def test_mistakes_that_explain_as_much_are_all_named():
    cases = [Mistake("sign", 0.104), Mistake("unit", 0.1), Mistake("swap", 0.2)]
    found = explaining(cases, most=0.15, as_good=1.1)
    assert [one.words for one in found] == ["sign", "unit"]
    assert explaining(cases, most=0.09, as_good=1.1) == []
    assert explaining([], most=0.09, as_good=1.1) == []


def test_one_turn_has_no_intervals():
    phi = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    force = 0.4 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    with pytest.raises(FitError, match="confidence=None"):
        fit_law((phi, force), reservoir="circle", direction="circle")
