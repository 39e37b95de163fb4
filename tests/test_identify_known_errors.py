"""Errors of zeros and gains that no record tells: said, or stated and then in the bands."""

import numpy as np
import pytest
from asperity import ConfigurationError, DimensionError, ParameterError
from asperity.identify import RawData, VirtualTribometer, fit_law, process, read_raw, write_raw
from asperity.identify.evidence.forces.errors import _joint_degrees
from profiles import counts
from table_1 import TABLE_1, TRUTH

ZERO, GAIN = 0.009 * 9.3, 0.02


def measured(seed, *, zero=0.0, gain=0.0, turns=5, **known):
    """Return a record in N whose zeros and gains are off by as much as these deviations say."""
    machine = VirtualTribometer.perfect(
        TABLE_1,
        normal_force=9.3,
        turns=turns,
        turn_rate=0.5,
        sample_rate=250.7,
        noise=0.02,
        crosstalk=0.0,
        seed=seed,
    )
    (run,) = machine.record().recordings
    random = np.random.default_rng(seed + 777)
    force = run.readings * (1.0 + gain * random.normal(size=3)) + zero * random.normal(size=3)
    return RawData([run.replace(readings=force)], **known)


@counts(8, 200)
@pytest.mark.parametrize(("zero", "gain"), [(ZERO, 0.0), (0.0, GAIN), (ZERO, GAIN)])
def test_bands_with_stated_errors_hold_the_truth(zero, gain, count):
    held = np.zeros(len(TRUTH), dtype=int)
    for seed in range(count):
        raw = measured(seed, zero=zero, gain=gain, zero_error=zero, gain_error=gain)
        fit = fit_law(process(raw))
        assert not fit.missing
        held += [fit.parameters[name].covers(value) for name, value in TRUTH.items()]
    # Fewer than 5 of 8 have a probability of 4e-4 at 95 %.
    assert (held >= (180 if count == 200 else 5)).all(), held
    if count == 200:
        # The angle of D, which samples near its axes hold, has the interval of the others.
        assert (held[:-1] <= 199).all(), held


def test_a_run_says_what_is_not_known_and_what_would_help():
    fit = fit_law(process(measured(0, zero=ZERO, gain=GAIN)))
    gains, zeros, *_ = fit.warnings
    assert gains.startswith("no calibration: the error of the gains is not known")
    assert zeros.startswith("no records without load: the error of the zeros is not known, 1 % of")
    for name in TRUTH:
        assert f"{name} by " in gains
        assert f"{name} by " in zeros
    assert gains.endswith("state gain_error, the standard error of the gains")
    assert zeros.endswith("state zero_error, the standard error of the zeros in N")
    one = fit_law(process(measured(0, zero_error=ZERO)))
    assert [sentence[:14] for sentence in one.warnings] == ["no calibration"]


def test_one_turn_has_no_intervals_and_says_so():
    fit = fit_law(process(measured(0, turns=1.2, zero_error=0.0, gain_error=0.0)), confidence=None)
    assert "there are no confidence intervals: one complete turn has no scatter" in fit.warnings[0]
    assert str(fit.parameters["reservoir.a"]).endswith("(no interval)")
    assert "nan" not in fit.summary()


def test_stated_errors_widen_what_records_say():
    machine = VirtualTribometer(
        TABLE_1, normal_force=9.3, turns=4, turn_rate=0.5, sample_rate=250.0, calibration_loads=2
    )
    raw = machine.record()
    plain = fit_law(process(raw)).covariance
    stated = fit_law(process(raw.replace(zero_error=ZERO, gain_error=GAIN))).covariance
    bare = fit_law(
        process(raw.replace(zero_error=ZERO, gain_error=GAIN, no_load=(), calibration=None))
    ).covariance
    np.testing.assert_allclose(plain.scatter, stated.scatter)
    for part in ("calibration", "zero"):
        assert (np.diag(getattr(stated, part)) > np.diag(getattr(plain, part))).all()
    # Errors that are stated are known exactly; what is estimated beside has a small part.
    assert stated.degrees[2] > 1e3 * plain.degrees[2]
    assert bare.degrees[1:] == (np.inf, np.inf)


def test_a_stated_error_does_what_it_says():
    """The covariance is that of fits with each zero and each gain off."""
    base = fit_law(process(measured(3))).coordinates
    run = measured(3).recordings[0]
    zero, gain = np.array([0.02, 0.03, 0.05]), np.array([0.004, 0.003, 0.005])
    stated = fit_law(process(measured(3, zero_error=zero, gain_error=gain))).covariance

    def moved(change):
        return fit_law(process(RawData([run.replace(readings=change(run.readings))]))).coordinates

    def summed(steps):
        return sum(np.outer(step, step) for step in steps)

    zeros = summed(moved(lambda r, k=k: r + np.eye(3)[k] * zero[k]) - base for k in range(3))
    gains = summed(
        moved(lambda r, k=k: r * (1.0 + np.eye(3)[k] * gain[k])) - base for k in range(3)
    )
    # The angle of D moves from one sample near its axes to the next; gains do not turn C at all.
    for found, expected, count in ((stated.zero, zeros, 6), (stated.calibration, gains, 3)):
        errors = (np.sqrt(np.diag(one))[:count] for one in (found, expected))
        np.testing.assert_allclose(*errors, rtol=0.05)


def test_the_error_of_a_given_normal_force_is_the_third_gain():
    given = measured(0, normal_load=9.3, zero_error=0.0, gain_error=[0.0, 0.0, 0.01])
    covariance = fit_law(process(given)).covariance
    error = np.sqrt(np.diag(covariance.calibration))
    # Coordinates are logarithms: 1 % of the load is 1 % of both semi-axes, and nothing else.
    np.testing.assert_allclose(error[:2], 0.01, rtol=0.01)
    assert error[2:].max() < 1e-3
    assert covariance.degrees[1] == np.inf


def test_stated_errors_are_kept_in_files(tmp_path):
    raw = measured(0, zero_error=[0.01, 0.02, 0.03], gain_error=0.02)
    *runs, config = write_raw(raw, tmp_path)
    again = read_raw([tmp_path / name for name in runs], tmp_path / config)
    np.testing.assert_array_equal(again.zero_error, [0.01, 0.02, 0.03])
    np.testing.assert_array_equal(again.gain_error, [0.02] * 3)
    fit = fit_law(process(raw))
    fit.save(tmp_path / "fit.npz")
    loaded = type(fit).load(tmp_path / "fit.npz")
    np.testing.assert_array_equal(loaded.covariance.total, fit.covariance.total)


def test_wrong_statements_are_refused(tmp_path):
    with pytest.raises(ParameterError, match="zero_error: must not be negative"):
        measured(0, zero_error=-0.1)
    with pytest.raises(DimensionError, match="gain_error: must be one number or three"):
        measured(0, gain_error=[0.1, 0.2])
    names = write_raw(measured(0), tmp_path)
    config = tmp_path / "tribometer.toml"
    config.write_text("[tribometer]\ngain_error = -0.02\n")
    with pytest.raises(ConfigurationError, match="gain_error"):
        read_raw(tmp_path / names[0], config)


def mistaken(change, *, turn_back=False):
    run = measured(1).recordings[0]
    angle = -run.angle if turn_back else run.angle
    changed = run.replace(readings=change(run.readings), angle=angle)
    return fit_law(process(RawData([changed], zero_error=0.0, gain_error=0.0)))


def test_a_misfit_that_a_wrong_sign_explains_is_named():
    (warning,) = mistaken(lambda r: r * [1.0, -1.0, 1.0]).warnings
    assert "the model does not fit" in warning
    assert "with the sign of the radial channel turned, they would deviate by 1." in warning
    assert not mistaken(lambda r: r).warnings


@pytest.mark.parametrize(
    ("change", "turn_back", "words"),
    [
        (lambda r: r * [-1.0, 1.0, 1.0], False, "the sign of the tangential channel or of the rot"),
        (lambda r: r, True, "the sign of the tangential channel or of the rotation turned"),
        (lambda r: r * [-1.0, -1.0, 1.0], False, "signs of the tangential and the radial channel"),
        (lambda r: r[:, [1, 0, 2]], False, "the tangential and the radial channel swapped it"),
    ],
)
def test_forces_that_do_not_oppose_sliding_are_explained(change, turn_back, words):
    with pytest.raises(Exception, match=f"does not oppose sliding at .*; with .*{words}"):
        mistaken(change, turn_back=turn_back)


def test_a_model_that_is_too_simple_is_not_blamed_on_channels():
    fit = fit_law(
        process(measured(1, zero_error=0.0, gain_error=0.0)),
        reservoir="ellipse",
        direction="ellipse",
    )
    assert fit.mistake is None
    assert any("the model does not fit" in warning for warning in fit.warnings)


def test_degrees_of_freedom_of_a_variance_that_is_known_in_part():
    """Welch's and Satterthwaite's: those of a chi-square of the same mean and scatter."""
    estimated = np.random.default_rng(0).chisquare(6, 400_000) / 6.0
    for known in (0.5, 1.0, 3.0):
        total = known + estimated
        found = _joint_degrees(6.0, (known + 1.0) * np.eye(2), known * np.eye(2))
        assert found == pytest.approx(2.0 * total.mean() ** 2 / total.var(), rel=0.02)
    assert _joint_degrees(6.0, np.eye(2), np.eye(2)) == np.inf
