"""Fits of laws to forces: against exact data, another solver, differences, and known noise."""

import pickle
from types import SimpleNamespace

import numpy as np
import pytest
from asperity import Ellipse, FitError, FrictionLaw, Rectangle, Superellipse
from asperity.errors import DimensionError, ParameterError
from asperity.identify import (
    Calibration,
    CircleDirection,
    CircleReservoir,
    FourierDirection,
    FourierReservoir,
    RawData,
    SuperellipseDirection,
    SuperellipseReservoir,
    VirtualTribometer,
    fit_law,
    process,
)
from asperity.identify.bins import grouped
from asperity.identify.covariance import _pulls
from asperity.identify.samples import by_sense
from asperity.identify.sums import Family
from scipy.optimize import least_squares
from scipy.stats import binom

TABLE_1 = FrictionLaw(Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), Superellipse(1.84, 1.19, 2.51))
TRUTH = {
    "reservoir.a": 4.99 / 9.3,
    "reservoir.b": 4.25 / 9.3,
    "reservoir.exponent": 2.94,
    "reservoir.angle": 0.0,
    "direction.ratio": 1.84 / 1.19,
    "direction.exponent": 2.51,
    "direction.angle": 0.0,
}


def sampled(law, samples=4000, turns=5, noise=0.0, seed=0):
    phi = np.linspace(0.0, turns * 2.0 * np.pi, samples, endpoint=False)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    return phi, force + noise * np.random.default_rng(seed).normal(size=force.shape)


def turned_law(c_angle=0.1, d_angle=-0.05):
    return FrictionLaw(
        TABLE_1.reservoir.rotated(c_angle), Superellipse(1.84, 1.19, 2.51, angle=d_angle)
    )


FAMILIES = {
    "circles": (CircleReservoir(), CircleDirection(), [-0.6]),
    "ellipses": (
        SuperellipseReservoir(2.0),
        SuperellipseDirection(2.0),
        [-0.6, -0.8, 0.1, 0.4, -0.05],
    ),
    "superellipses": (
        SuperellipseReservoir(),
        SuperellipseDirection(),
        [-0.6, -0.8, 1.08, 0.1, 0.43, 0.41, -0.05],
    ),
    "fourier": (
        FourierReservoir(3, odd=True),
        FourierDirection(4),
        [-0.6, 0.02, 0.03, -0.1, 0.1, 0.02, 0.01, -0.08, 0.03, 0.01, 0.02],
    ),
}


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("joint", [True, False])
def test_derivatives_agree_with_differences(name, joint):
    reservoir, direction, p = FAMILIES[name]
    family, p = Family(reservoir, direction, joint=joint), np.array(p)
    phi = np.random.default_rng(1).uniform(0.0, 7.0, 60)
    derivative = family.forces(phi, p)[1]
    for k, unit in enumerate(1e-6 * np.eye(family.size)):
        difference = family.forces(phi, p + unit)[0] - family.forces(phi, p - unit)[0]
        np.testing.assert_allclose(derivative[k], difference / 2e-6, atol=2e-8)


@pytest.mark.parametrize("name", ["circles", "ellipses", "superellipses"])
def test_models_have_the_forces_of_their_laws(name):
    reservoir, direction, p = FAMILIES[name]
    family, p = Family(reservoir, direction, joint=True), np.array(p)
    law = FrictionLaw(
        reservoir.reservoir(p[: family.split]), direction.direction(p[family.split :])
    )
    phi, force = sampled(law, 720, 1)
    np.testing.assert_allclose(family.forces(phi, p)[0], force, atol=1e-12)


def test_fourier_models_are_the_curves_they_hand_over():
    reservoir, direction, p = FAMILIES["fourier"]
    family, p = Family(reservoir, direction, joint=True), np.array(p)
    law = FrictionLaw(
        reservoir.reservoir(p[: family.split]), direction.direction(p[family.split :])
    )
    phi, force = sampled(law, 997, 1)
    np.testing.assert_allclose(family.forces(phi, p)[0], force, atol=1e-5)


def test_exact_forces_give_the_exact_parameters():
    truth = {**TRUTH, "reservoir.angle": 0.1, "direction.angle": -0.05}
    options = {"normal_force": 9.3, "sample_rate": 1e4, "crosstalk": 0.05}
    for rate in (1.0, -1.0):
        raw = VirtualTribometer.perfect(turned_law(), turn_rate=rate, **options).record()
        fit = fit_law(process(raw, cut_off=None))
        for parameter, value in truth.items():
            assert abs(fit.parameters[parameter].value - value) < 1e-6 * max(1.0, abs(value))


def test_random_laws_are_found_again():
    random, missed = np.random.default_rng(5), 0
    for _ in range(60):
        a, b, p = np.exp(random.uniform(-0.8, 0.8, 3))
        s, t = random.uniform(1.4, 6.0, 2)
        x, y = random.uniform(-0.7, 0.7, 2)
        law = FrictionLaw(Superellipse(a, b, s, x), Superellipse(p, 1.0, t, y))
        data = sampled(law, 2000, 2)
        fit = fit_law(data, confidence=None)
        missed += abs(fit.forces(data[0]) - data[1]).max() > 1e-3 * np.hypot(a, b)
    # The set turned by 45° is a false minimum; of 200 such laws 1 ends in it.
    assert missed <= 1


def test_minimum_is_that_of_another_solver():
    phi, force = sampled(turned_law(), 1500, 5, noise=0.02)

    def residuals(x):
        a, b, s, c_angle, ratio, t, d_angle = x
        law = FrictionLaw(Superellipse(a, b, s, c_angle), Superellipse(ratio, 1.0, t, d_angle))
        return (force + law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))).ravel()

    fit = fit_law((phi, force))
    mine = np.array([fit.parameters[name].value for name in TRUTH])
    other = least_squares(residuals, 1.01 * mine, x_scale=np.abs(mine), xtol=1e-12, ftol=1e-12)
    errors = np.array([fit.parameters[name].standard_error for name in TRUTH])
    # The last step of the fit may be a tenth of a standard error, continued linearly.
    assert (abs(mine - other.x) < 0.02 * errors).all()
    assert (fit.residuals**2).sum() < 2.0 * other.cost * (1.0 + 1e-5)
    assert fit.rms == pytest.approx(np.sqrt((fit.residuals**2).mean()), rel=1e-5)


def test_apart_and_joint_fits_agree():
    data = sampled(turned_law(), noise=0.005)
    joint, apart = fit_law(data), fit_law(data, joint=False)
    for name in TRUTH:
        together, alone = joint.parameters[name], apart.parameters[name]
        assert abs(together.value - alone.value) < 4.0 * together.standard_error + 1e-3


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
def test_robust_losses_survive_outliers(loss):
    phi, force = sampled(turned_law(), 20_000, noise=0.005)
    random = np.random.default_rng(2)
    at = random.choice(len(phi), len(phi) // 50, replace=False)
    force[at] *= random.uniform(1.2, 1.6, (len(at), 1))
    robust, squares = fit_law((phi, force), loss=loss), fit_law((phi, force))
    for name, value in {**TRUTH, "reservoir.angle": 0.1, "direction.angle": -0.05}.items():
        error = abs(robust.parameters[name].value - value)
        assert error < 5.0 * robust.parameters[name].standard_error
    assert robust.rms == pytest.approx(0.005, rel=0.05)
    assert abs(squares.parameters["reservoir.a"].value - TRUTH["reservoir.a"]) > 1e-3


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
@pytest.mark.parametrize("size", [5.0, 50.0])
def test_robust_losses_survive_outliers_that_spoil_means(loss, size):
    phi, force = sampled(turned_law(), 20_000, 10, noise=0.005)
    random = np.random.default_rng(1)
    at = random.random(len(phi)) < 0.01
    force[at] += size * random.normal(size=(int(at.sum()), 2))
    fit = fit_law((phi, force), loss=loss)
    for name, value in {**TRUTH, "reservoir.angle": 0.1, "direction.angle": -0.05}.items():
        estimate = fit.parameters[name]
        assert abs(estimate.value - value) < 5.0 * estimate.standard_error
    assert fit.parameters["reservoir.a"].standard_error < 1e-3
    assert fit.rms == pytest.approx(0.005, rel=0.05)
    assert fit.measured.closure == pytest.approx(1.0, abs=0.05)
    assert fit.comparison.best.reservoir == "superellipse"


def test_isotropic_friction_has_no_angle():
    for noise in (0.0, 0.0014):
        fit = fit_law(sampled(FrictionLaw.isotropic(0.14), 20_000, 10, noise=noise))
        for name in ("reservoir.angle", "direction.angle", "direction.scale"):
            assert not fit.parameters[name].identifiable
        assert fit.parameters["reservoir.exponent"].value == pytest.approx(2.0, abs=0.03)
        assert fit.parameters["direction.ratio"].covers(1.0) or noise == 0.0
    assert fit_law(sampled(TABLE_1, noise=0.005)).parameters["direction.angle"].identifiable
    known = fit_law(sampled(TABLE_1), confidence=None).parameters
    assert known["reservoir.angle"].identifiable
    assert np.isnan(known["reservoir.a"].low)


def test_angles_lie_within_an_eighth_of_a_turn():
    law = FrictionLaw(Ellipse(0.5, 0.3, angle=1.3), Ellipse(2.0, 1.0, angle=-2.0))
    fit = fit_law(sampled(law), "ellipse", "ellipse")
    assert fit.parameters["reservoir.angle"].value == pytest.approx(1.3 - np.pi / 2)
    assert fit.parameters["reservoir.a"].value == pytest.approx(0.3)
    assert fit.parameters["direction.angle"].value == pytest.approx(-2.0 + np.pi / 2)
    assert fit.parameters["direction.ratio"].value == pytest.approx(0.5)


def test_calibration_and_zero_move_the_fit_as_predicted():
    for rate in (1.0, -1.0):
        raw = VirtualTribometer(
            turned_law(),
            normal_force=9.3,
            turns=4,
            turn_rate=rate,
            sample_rate=2e3,
            noise=1e-4,
            seed=3,
        ).record()
        data = process(raw)
        fit = fit_law(data)
        parts = [(grouped(s, 1).bins(), sense) for s, sense in by_sense(fit._samples, data)]
        pulls = sum(
            _pulls(fit._family, bins, sense, fit.coordinates, data.matrix) for bins, sense in parts
        )
        matrix = fit._descent.sums.matrix.sum(axis=0)
        predicted = np.linalg.solve(matrix, pulls)[:-1]
        for entry in range(12):
            changed = {"matrix": data.matrix.copy(), "zero": data.zero.copy()}
            step = 1e-3
            if entry < 9:
                changed["matrix"].flat[entry] += step
            else:
                changed["zero"][entry - 9] += step
            force, normal = data.perturbed(**changed)
            other = fit_law(
                SimpleNamespace(phi=data.phi, force=force, normal_force=normal, turn=data.turn),
                confidence=None,
            )
            moved = (other.coordinates - fit.coordinates)[:-1] / step
            # Means over directions see the ripple of the normal force at first order only.
            assert abs(moved - predicted[:, entry]).max() < 0.02 * abs(predicted).max()


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
def test_errors_in_common_do_not_depend_on_the_loss(loss):
    machine = VirtualTribometer(
        TABLE_1, normal_force=9.3, turns=4, turn_rate=0.5, sample_rate=1e3, seed=3
    )
    data = process(machine.record())
    squares, robust = fit_law(data).covariance, fit_law(data, loss=loss).covariance
    for part in ("calibration", "zero"):
        expected, found = (np.sqrt(np.diag(getattr(c, part))) for c in (squares, robust))
        np.testing.assert_allclose(found, expected, rtol=0.02)


def test_a_given_normal_force_owes_nothing_to_its_channel():
    machine = VirtualTribometer(
        TABLE_1, normal_force=9.3, turns=4, turn_rate=0.5, sample_rate=250.0, load_ripple=0.0
    )
    raw = machine.record()
    given = RawData(
        raw.recordings, calibration=raw.calibration, no_load=raw.no_load, normal_load=9.3
    )
    data = process(given)
    covariance = np.zeros((9, 9))
    covariance[6:, 6:] = data.calibration_covariance[6:, 6:]
    last_row = SimpleNamespace(
        **{
            name: getattr(data, name) for name in ("phi", "force", "normal_force", "turn", "matrix")
        },
        **{name: getattr(data, name) for name in ("run", "raw")},
        calibration_covariance=covariance,
    )
    assert covariance.any()
    assert not fit_law(last_row).covariance.calibration.any()
    assert fit_law(data).covariance.calibration[2, 2] > 0.0


def campaign(seed, runs=4, scatter=0.02):
    """Runs between which friction differs."""
    random, recordings = np.random.default_rng(seed + 5000), []
    for run in range(runs):
        factor = 1.0 + scatter * random.normal()
        law = FrictionLaw(
            Superellipse(4.99 / 9.3 * factor, 4.25 / 9.3 * factor, 2.94), TABLE_1.direction
        )
        machine = VirtualTribometer.perfect(
            law,
            normal_force=9.3,
            turns=3,
            turn_rate=0.5,
            sample_rate=250.0,
            noise=0.02,
            crosstalk=0.0,
            seed=10 * seed + run,
        )
        recordings += machine.record().recordings
    return process(RawData(recordings))


def test_bands_hold_the_scatter_between_runs():
    seeds = 25
    held = sum(
        fit_law(campaign(seed)).parameters["reservoir.a"].covers(TRUTH["reservoir.a"])
        for seed in range(seeds)
    )
    # Fewer than 20 of 25 have a probability of 1.2e-3 at 95 %; by turns 17 hold.
    assert held >= 20
    assert fit_law(campaign(0)).covariance.degrees[0] == 3
    assert fit_law(campaign(0, runs=2)).covariance.degrees[0] == 5


def test_bands_hold_an_estimated_error_of_the_calibration():
    seeds, held = 40, np.zeros(7)
    for seed in range(seeds):
        raw = VirtualTribometer(
            TABLE_1,
            normal_force=9.3,
            turns=2,
            turn_rate=0.5,
            sample_rate=250.0,
            calibration_loads=2,
            seed=seed,
        ).record()
        loads, readings = raw.calibration.loads, raw.calibration.readings
        few = [0, 1, 3, 5]
        weighed = Calibration(loads[few], readings[few])
        fit = fit_law(process(RawData(raw.recordings, calibration=weighed, no_load=raw.no_load)))
        held += [fit.parameters[name].covers(value) for name, value in TRUTH.items()]
    assert fit.covariance.degrees == (1, 1, 19)
    # Fewer than 33 of 40 have a probability of 2e-3 at 95 %.
    assert (held >= 33).all(), held


def test_rectangles_leave_c_untold():
    law = FrictionLaw(Ellipse(0.5, 0.4), Rectangle(1.5, 1.0))
    fit = fit_law(sampled(law, 20_000, 10, noise=0.005))
    for name in ("a", "b", "exponent", "angle"):
        assert not fit.parameters[f"reservoir.{name}"].identifiable
    assert "C is not identifiable" in " ".join(fit.warnings)
    assert fit.parameters["reservoir.a"].covers(0.5)
    stuck = fit_law(sampled(FrictionLaw(Rectangle(0.5, 0.4), Ellipse(2.0, 1.0)), noise=1e-4))
    assert not stuck.parameters["reservoir.exponent"].identifiable
    assert stuck.parameters["reservoir.a"].identifiable
    assert stuck.warnings == ("reservoir.exponent is not identifiable: it ended at its bound 60",)
    assert not fit_law(sampled(turned_law(), 20_000, 10, noise=0.005)).warnings


def test_forces_that_no_such_sets_have_are_told():
    phi = np.linspace(0.0, 20.0 * np.pi, 20_000, endpoint=False)
    e = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    across = np.stack([-e[:, 1], e[:, 0]], axis=-1)
    noise = 0.005 * np.random.default_rng(0).normal(size=e.shape)
    skew = fit_law((phi, 0.5 * e + 0.1 * across + noise))
    assert skew.defects["closure"].size == pytest.approx(np.exp(0.4 * np.pi), rel=0.01)
    assert any("closure 3.5" in warning for warning in skew.warnings)
    assert any("does not fit" in warning for warning in skew.warnings)
    assert not skew.defects["asymmetry"].matters
    odd = fit_law((phi, 0.5 * e + [0.05, 0.02] + noise))
    assert any("not symmetric" in warning for warning in odd.warnings)
    assert "not symmetric" in repr(odd)
    assert odd.comparison.best.reservoir == "odd fourier"
    for law in (TABLE_1, FrictionLaw.isotropic(0.14)):
        for seed in range(4):
            few = fit_law(sampled(law, 3000, 3, noise=0.01, seed=seed))
            assert len(few.defects) == 3
            assert not any(defect.matters for defect in few.defects.values()), few.defects


def test_errors_of_the_zero_are_no_defects():
    for seed in range(12):
        machine = VirtualTribometer(
            FrictionLaw.isotropic(0.14),
            normal_force=9.3,
            turns=3,
            turn_rate=0.5,
            sample_rate=250.0,
            seed=seed,
        )
        assert not fit_law(process(machine.record())).warnings


def test_bands_of_noise_that_is_known():
    """The band of each parameter holds the truth about as often as it says."""
    seeds, held = 60, np.zeros(7)
    for seed in range(seeds):
        fit = fit_law(sampled(TABLE_1, 3000, 10, noise=0.01, seed=seed))
        held += [fit.parameters[name].covers(value) for name, value in TRUTH.items()]
    # Fewer than 51 of 60 have a probability of 2e-4 at 95 %.
    assert (held >= 51).all(), held


def test_bands_follow_from_the_parameters_alone():
    fit = fit_law(sampled(turned_law(), noise=0.01))
    theta, phi = np.linspace(0.0, 6.0, 50), np.linspace(0.0, 6.0, 50)
    radius, low, high = fit.radius_band(theta)
    np.testing.assert_allclose(radius, fit.reservoir.radius(theta), rtol=1e-12)
    assert ((low < radius) & (radius < high)).all()
    bands = fit.bands(phi)
    e = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    np.testing.assert_allclose(bands.force, -fit.law.force(e), atol=1e-12)
    np.testing.assert_allclose(bands.resistance[:, 0], (bands.force * e).sum(axis=1))
    # A band of the mean of many samples is much narrower than their noise.
    assert bands.half_width.max() < 0.005
    wider = fit_law(sampled(turned_law(), noise=0.01), confidence=0.99).bands(phi)
    assert (wider.half_width > bands.half_width).all()


def test_fits_can_be_pickled():
    fit = fit_law(sampled(TABLE_1, 500, 2, noise=0.01))
    again = pickle.loads(pickle.dumps(fit))
    assert again.law == fit.law
    assert again.parameters["reservoir.a"] == fit.parameters["reservoir.a"]


def test_what_cannot_be_fitted_is_refused():
    phi, force = sampled(TABLE_1, 720, 2)
    with pytest.raises(FitError, match="no samples between φ = 1"):
        fit_law((phi[phi < 3.0], force[phi < 3.0]))
    with pytest.raises(FitError, match="one complete turn has no scatter"):
        fit_law((phi[:360], force[:360]))
    assert fit_law((phi[:360], force[:360]), confidence=None).turns == 1
    with pytest.raises(FitError, match="samples lie in complete turns"):
        fit_law((phi[:10], force[:10]))
    with pytest.raises(FitError, match="does not oppose sliding"):
        fit_law((phi, -force))
    with pytest.raises(FitError, match="does not oppose sliding"):
        fit_law((phi, np.ones_like(force)))
    with pytest.raises(ParameterError, match=r"data\.force: must be finite"):
        fit_law((phi, np.where(phi[:, None] == 0.0, np.nan, force)))
    with pytest.raises(DimensionError, match=r"data\.force"):
        fit_law((phi, force[:, 0]))
    with pytest.raises(DimensionError, match=r"data\.turn"):
        fit_law((phi, force, np.zeros(len(phi))))
    with pytest.raises(FitError, match=r"what process\(\) returns"):
        fit_law("forces.csv")
    with pytest.raises(ParameterError, match=r"reservoir: must be 'circle'"):
        fit_law((phi, force), "square")
    with pytest.raises(ParameterError, match=r"direction: must be 'circle'"):
        fit_law((phi, force), "circle", "square")
    with pytest.raises(ParameterError, match="loss"):
        fit_law((phi, force), loss="absolute")
    with pytest.raises(ParameterError, match="confidence"):
        fit_law((phi, force), confidence=1.0)


def test_a_direction_set_that_is_not_convex_is_named():
    law = FrictionLaw(Superellipse(0.5, 0.4, 3.0), Superellipse(1.0, 1.0, 9.0))
    fit = fit_law(sampled(law), "fourier", FourierDirection(12))
    with pytest.raises(FitError, match="not convex at φ"):
        _ = fit.law


COORDINATES = [np.log, np.log, np.log, float, np.log, lambda s: np.log(s - 1.0), float]


def round_trip(seeds, bandwidth, turn_rate, sample_rate):
    """Return relative errors, worst of all seeds, and how many bands of 95 % and 50 % hold."""
    worst, held, half = np.zeros((3, 7))
    truth = np.array(list(TRUTH.values()))
    known = np.array([to(x) for to, x in zip(COORDINATES, truth, strict=True)])
    for seed in seeds:
        raw = VirtualTribometer(
            TABLE_1,
            normal_force=9.3,
            turns=10,
            turn_rate=turn_rate,
            noise_bandwidth=bandwidth,
            sample_rate=sample_rate,
            seed=seed,
        ).record()
        fit = fit_law(process(raw))
        estimates = [fit.parameters[name] for name in TRUTH]
        values = np.array([estimate.value for estimate in estimates])
        worst = np.maximum(worst, abs(values - truth) / np.where(truth == 0.0, 1.0, truth))
        held += [estimate.covers(value) for estimate, value in zip(estimates, truth, strict=True)]
        half += abs(fit.coordinates - known) < fit.covariance.half_widths(np.eye(7), 0.5)
    return dict(zip(TRUTH, worst, strict=True)), held, half


def check_round_trip(seeds, bandwidth, turn_rate, sample_rate):
    worst, held, half = round_trip(seeds, bandwidth, turn_rate, sample_rate)
    for name in ("reservoir.a", "reservoir.b", "direction.ratio"):
        assert worst[name] < 0.01, worst
    for name in ("reservoir.exponent", "direction.exponent"):
        assert worst[name] < 0.05, worst
    # Each of the 21 bars is missed with a probability of 1e-3 by bands that hold what they say.
    number = len(seeds)
    assert (held >= binom.ppf(1e-3, number, 0.95)).all(), held
    assert (half >= binom.ppf(1e-3, number, 0.5)).all(), half
    assert (half <= binom.isf(1e-3, number, 0.5)).all(), half


# At the paper's 50 mm/s on 50 mm, 10 turns last a minute.
ROUND_TRIPS = {"white": (None, 1.0), "coloured": (5.0, 0.16)}


@pytest.mark.parametrize("noise", ROUND_TRIPS)
def test_round_trip_through_the_tribometer(noise):
    check_round_trip(range(1000, 1050), *ROUND_TRIPS[noise], 250.0)


@pytest.mark.long
@pytest.mark.parametrize("noise", ROUND_TRIPS)
def test_round_trip_of_two_hundred_seeds(noise):
    check_round_trip(range(200), *ROUND_TRIPS[noise], 1e4)
