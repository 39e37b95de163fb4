"""Filter, turns, crosstalk, zero, transformation (119) against closed forms and the law."""

import asperity as asp
import numpy as np
import pytest
from asperity.errors import ParameterError, RecordError
from asperity.identify import (
    Calibration,
    Dependence,
    RawData,
    Recording,
    VirtualTribometer,
    average_turns,
    load_dependence,
    low_pass,
    process,
    speed_dependence,
)
from asperity.identify.forces.filters import butterworth
from asperity.identify.forces.turns import turn_numbers
from asperity.identify.forces.zero import batch_covariance
from scipy.signal import sosfreqz

LAW = asp.FrictionLaw(
    asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
CROSSTALK = np.array([[1.02, 0.04, -0.03], [0.05, 0.97, 0.02], [-0.01, 0.03, 1.05]])


def unit(phi):
    return np.stack([np.cos(phi), np.sin(phi)], axis=-1)


@pytest.mark.parametrize("frequency", [0.1, 0.37, 0.5, 0.9])
def test_the_filter_has_the_exact_response_of_two_passes_in_mid_record(frequency):
    rate, t = 10_000.0, np.arange(600_000) / 10_000.0
    middle = slice(240_000, 360_000)
    wave = np.sin(2.0 * np.pi * frequency * t + 0.3)
    gain = abs(sosfreqz(butterworth(rate, 0.5), [frequency], fs=rate)[1][0]) ** 2
    error = low_pass(wave, sample_rate=rate, cut_off=0.5)[middle] - gain * wave[middle]
    assert abs(error).max() < 1e-6


@pytest.mark.parametrize("order", [1, 2, 4, 8])
@pytest.mark.parametrize(("kind", "gain"), [("single", 0.5), ("double", np.sqrt(0.5))])
def test_the_cut_off_is_that_of_one_or_of_both_passes(order, kind, gain):
    sections = butterworth(1000.0, 40.0, order=order, cut_off_of=kind)
    assert abs(sosfreqz(sections, [40.0], fs=1000.0)[1][0]) ** 2 == pytest.approx(gain, rel=1e-9)


def test_the_filter_refuses_what_it_cannot_do():
    with pytest.raises(ParameterError, match="cut_off: must lie below half"):
        low_pass(np.zeros(100), sample_rate=10.0, cut_off=5.0)
    with pytest.raises(ParameterError, match="cut_off: must lie below half"):
        low_pass(np.zeros(100), sample_rate=10.0, cut_off=500.0, cut_off_of="double")
    with pytest.raises(ParameterError, match="cut_off_of"):
        low_pass(np.zeros(100), sample_rate=10.0, cut_off=1.0, cut_off_of="triple")
    with pytest.raises(ParameterError, match="values"):
        low_pass([1.0], sample_rate=10.0, cut_off=1.0)


def test_turns_are_counted_from_the_first_sample():
    t = np.arange(2500) / 1000.0
    for sign in (1.0, -1.0):
        run = Recording(t, angle=sign * 2.0 * np.pi * t + 5.0, readings=np.zeros((2500, 3)))
        number = turn_numbers(run, sign)
        assert np.bincount(number + 1).tolist() == [500, 1000, 1000]
        assert (np.diff(number[:2000]) >= 0).all()


def test_a_disk_that_turns_back_and_forth_makes_strokes():
    t = np.arange(1000) / 100.0
    run = Recording(t, angle=2.0 * np.sin(t), readings=np.ones((1000, 3)), source="swing")
    data = process(RawData([run]), cut_off=None)
    assert data.turns == 4
    assert (np.diff(data.turn[data.turn >= 0]) >= 0).all()
    slides = data.turn >= 0
    backwards = np.cos(t[slides]) < 0.0
    np.testing.assert_allclose((data.phi - run.angle)[slides], np.pi * backwards, atol=1e-12)
    # Where it turns back, it is about to stick.
    assert 0.15 < abs(np.cos(t[slides])).min() < 0.25
    # Of strokes longer than a turn, whole turns count.
    longer = process(RawData([run.replace(angle=8.0 * np.sin(t))]), cut_off=None)
    assert longer.turns == 6
    assert np.ptp(longer.phi[longer.turn == 2]) < 2.0 * np.pi


def test_turn_averages_have_means_offsets_drift_and_bands_that_cover():
    phi = np.linspace(0.0, 20.0 * np.pi, 10_000, endpoint=False)
    turn = np.floor(phi / (2.0 * np.pi) + 1e-9)
    average = average_turns(phi, values=0.1 * turn, turn=turn, bins=20)
    assert average.drift == pytest.approx(0.1)
    np.testing.assert_allclose(average.offset, 0.1 * (np.arange(10) - 4.5), atol=1e-12)
    covered = []
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(size=phi.size)
        band = average_turns(phi, values=noise, turn=turn, bins=20)
        covered.append(np.mean((band.low <= 0.0) & (band.high >= 0.0)))
    # 800 bins, nominal 95 %: three standard errors are 2.3 %.
    assert np.mean(covered) == pytest.approx(0.95, abs=0.023)


def test_empty_bins_are_refused():
    phi = 2.0 * np.pi * np.arange(100) / 50
    turn = np.arange(100) // 50
    with pytest.raises(ParameterError, match="bins: must be fewer"):
        average_turns(phi, values=phi, turn=turn, bins=360)
    with pytest.raises(ParameterError, match="turn: must number"):
        average_turns(phi, values=phi, turn=np.full(100, -1))


@pytest.mark.parametrize("fit_zero", [False, True])
def test_crosstalk_is_recovered_from_exact_loads(fit_zero):
    random = np.random.default_rng(1)
    loads = random.uniform(-10.0, 10.0, (12, 3))
    readings = loads @ CROSSTALK.T + fit_zero * np.array([0.3, -0.2, 0.1])
    calibration = Calibration(loads, readings, fit_zero=fit_zero)
    np.testing.assert_allclose(calibration.matrix @ CROSSTALK, np.eye(3), atol=1e-13)
    assert abs(calibration.residuals).max() < 1e-13
    assert 1.0 < calibration.condition < 1.3


def test_three_loads_along_the_axes_give_the_inverse_of_the_readings():
    loads = np.diag([5.0, 5.0, 9.0])
    readings = loads @ CROSSTALK.T
    calibration = Calibration(loads, readings)
    np.testing.assert_allclose(calibration.matrix, (np.linalg.inv(readings) @ loads).T, atol=1e-14)
    assert np.isnan(calibration.covariance).all()


def test_the_covariance_of_the_matrix_is_that_of_repeated_calibrations():
    random = np.random.default_rng(2)
    loads = np.repeat(np.diag([5.0, 5.0, 9.0]), 4, axis=0)
    error = np.array([0.01, 0.02, 0.03])
    matrices, estimated = [], []
    for _ in range(4000):
        readings = loads @ CROSSTALK.T + error * random.normal(size=loads.shape)
        matrices.append(Calibration(loads, readings, reading_error=error).matrix.ravel())
        estimated.append(np.diag(Calibration(loads, readings).covariance))
    expected = Calibration(loads, loads @ CROSSTALK.T, reading_error=error).covariance
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # Standard error of a covariance of 4000: 1.6 % (2.2 % of a variance).
    assert abs((np.cov(np.array(matrices).T) - expected) / scale).max() < 0.09
    np.testing.assert_allclose(np.mean(estimated, axis=0), np.diag(expected), rtol=0.05)


def test_calibrations_that_determine_no_matrix_are_refused():
    with pytest.raises(ParameterError, match="loads: must act along all three axes"):
        Calibration(np.eye(3)[:2], np.eye(3)[:2])
    with pytest.raises(ParameterError, match=r"loads: .* two levels"):
        Calibration(np.eye(3), np.eye(3), fit_zero=True)
    with pytest.raises(ParameterError, match="readings: must tell the axes apart"):
        Calibration(np.eye(3), np.diag([1.0, 1.0, 0.0]))
    with pytest.raises(ParameterError, match="reading_error"):
        Calibration(np.eye(3), np.eye(3), reading_error=-1.0)


@pytest.mark.parametrize("turn_rate", [1.0, -0.7])
@pytest.mark.parametrize("grid_angle", [0.0, 0.4])
def test_forces_over_the_sliding_direction_are_those_of_the_law(turn_rate, grid_angle):
    virtual = VirtualTribometer.perfect(
        LAW.rotated(grid_angle) if grid_angle else LAW,
        normal_force=9.3,
        turns=2.5,
        turn_rate=turn_rate,
        sample_rate=2000.0,
        start_angle=0.3,
        load_ripple=0.0,
        crosstalk=CROSSTALK,
    )
    # The axes of the law are turned by the angle that the encoder does not know of.
    data = process(virtual.record(), grid_angle=-grid_angle)
    exact = -LAW.force(unit(data.phi), normal_force=9.3)
    np.testing.assert_allclose(data.force, exact, atol=1e-10)
    np.testing.assert_allclose(data.normal_force, 9.3, atol=1e-9)
    assert data.turns == 2


def test_the_filter_only_smooths_the_normal_force():
    raw = VirtualTribometer(LAW, normal_force=9.3, turns=4, turn_rate=1.0, seed=2).record()
    smooth, rough = process(raw), process(raw, cut_off=None)
    assert (smooth.force == rough.force).all()
    assert np.std(smooth.normal_force - rough.normal_force) == pytest.approx(0.093, rel=0.05)
    # White noise through two passes at 20 Hz: the band |H|⁴ is 0.92 × 20 of 5000 Hz wide.
    assert np.ptp(smooth.normal_force) < 0.07 * 9.3


def test_a_cut_off_above_all_that_samples_show_is_refused_if_it_was_stated():
    """Of 30 samples per turn; without a statement the filter is left out."""
    machine = VirtualTribometer(LAW, normal_force=9.3, turns=4, turn_rate=1.0, sample_rate=30.0)
    raw = machine.record()
    assert process(raw).cut_off_frequency == (None,)
    assert process(raw, cut_off=14.0).cut_off_frequency == pytest.approx((14.0,), rel=1e-3)
    with pytest.raises(ParameterError, match="cut_off: must lie below half the samples per turn"):
        process(raw, cut_off=25.0)


def test_the_zero_is_interpolated_between_records_before_and_after():
    clock = np.arange(1000) / 100.0
    slope = np.array([0.01, -0.02, 0.03])

    def part(start, force):
        t = clock + start
        return Recording(
            t,
            angle=2.0 * np.pi * t,
            readings=force + np.array([1.0, 2.0, 3.0]) + t[:, None] * slope,
        )

    load = np.array([2.0, 0.5, 10.0])
    no_load = [part(-20.0, 0.0), part(30.0, 0.0)]
    data = process(RawData([part(0.0, load)], no_load=no_load))
    resistance = data.averaged(20).resistance
    np.testing.assert_allclose(resistance, np.tile(load[:2], (20, 1)), atol=1e-12)
    np.testing.assert_allclose(data.normal_force, 10.0, atol=1e-9)
    # Records on one side only: the mean of the nearest, known no better than the drift since.
    one = process(RawData([part(0.0, load)], no_load=no_load[:1]))
    np.testing.assert_allclose(one.zero, no_load[0].readings.mean(axis=0))
    off = 20.0 * slope
    np.testing.assert_allclose(np.sqrt(np.diag(one.zero_covariance)), abs(off), rtol=1e-6)


def test_each_run_has_the_zero_of_the_records_around_it():
    clock = np.arange(1000) / 100.0
    load = np.array([2.0, 0.5, 10.0])

    def bent(t):
        # Straight between the middles of the records, with a kink at the one between the runs.
        return np.outer(np.minimum(t, 25.0 - 0.005), [0.01, -0.02, 0.03])

    def part(start, force):
        t = clock + start
        return Recording(t, angle=2.0 * np.pi * t, readings=force + bent(t))

    def tare(start):
        # Where the kink is the mean counts, as if the zero stayed.
        run = part(start, 0.0)
        return run.replace(readings=np.tile(bent(run.time[[0, -1]].mean(keepdims=True)), (1000, 1)))

    raw = RawData([part(0.0, load), part(40.0, load)], no_load=[tare(60), tare(-20), tare(20)])
    data = process(raw)
    np.testing.assert_allclose(data.normal_force, 10.0, atol=1e-9)
    np.testing.assert_allclose(data.averaged(20).resistance, np.tile(load[:2], (20, 1)), atol=1e-12)
    np.testing.assert_allclose(data.zero, bent(np.array([5.0, 45.0]) - 0.005).mean(axis=0))
    force, _ = data.perturbed(zero=data.zero)
    np.testing.assert_allclose(force, data.force)


def test_a_zero_from_one_side_is_as_uncertain_as_its_drift():
    deviations = []
    for seed in range(60):
        options = {"turns": 1, "turn_rate": 0.1, "sample_rate": 100.0, "no_load_time": 5.0}
        raw = VirtualTribometer(LAW, normal_force=9.3, seed=seed, zero=0.0, **options, drift=0.2)
        raw = raw.record()
        between = process(raw).zero
        data = process(raw.replace(no_load=raw.no_load[seed % 2 : seed % 2 + 1]))
        deviations.append((data.zero - between) / np.sqrt(np.diag(data.zero_covariance)))
    # Where drift is all there is, the deviation is its own measure: one standard error.
    assert abs(np.array(deviations)).max() < 3.0
    assert np.mean(abs(np.array(deviations)) < 2.0) > 0.9


def test_records_on_several_clocks_are_refused():
    clock = np.arange(1000) / 100.0
    run = Recording(
        clock, angle=2.0 * np.pi * clock, readings=np.tile([1.0, 0.0, 9.0], (1000, 1)), source="a"
    )
    tare = run.replace(readings=np.zeros((1000, 3)), source="b")
    with pytest.raises(RecordError, match="one clock"):
        process(RawData([run], no_load=[tare]))


def test_the_variance_of_a_mean_of_correlated_noise():
    from scipy.signal import lfilter

    random = np.random.default_rng(3)
    noise = lfilter([1.0], [1.0, -0.95], random.normal(size=(400, 20_000)), axis=1)[:, 1000:]
    estimated = [batch_covariance(row[:, None])[0, 0] for row in noise]
    assert np.mean(estimated) == pytest.approx(np.var(noise.mean(axis=1)), rel=0.2)


def both_ways(make, law=LAW, **options):
    """Raw data of a run forwards and one backwards, on one sensor."""
    given = {"normal_force": 9.3, "turns": 3, "sample_rate": 2000.0, "seed": 4, **options}
    raw, back = (make(law, turn_rate=rate, **given).record() for rate in (1.0, -1.0))
    later = [run.replace(time=run.time + 100.0) for run in back.recordings]
    return raw.replace(recordings=[*raw.recordings, *later])


def test_means_of_runs_in_both_senses():
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.3, angle=0.2), asp.Ellipse(3.0, 2.0))
    data = process(both_ways(VirtualTribometer.perfect, law, load_ripple=0.0))
    means = data.averaged(720)
    exact = -law.force(unit(means.phi), normal_force=9.3)
    np.testing.assert_allclose(means.force, exact, atol=1e-4)
    assert data.turns == 6


def test_perturbed_forces_are_those_of_another_calibration():
    raw = both_ways(VirtualTribometer)
    data = process(raw)
    shift = np.array([0.01, -0.02, 0.03])
    matrix, zero = data.matrix * 1.01 + 0.002, data.zero + shift
    loads = np.eye(3)
    other = raw.replace(
        calibration=Calibration(loads, loads @ np.linalg.inv(matrix).T, reading_error=0.0),
        no_load=[r.replace(readings=r.readings + shift) for r in raw.no_load],
    )
    force, normal = data.perturbed(matrix=matrix, zero=zero)
    again = process(other)
    np.testing.assert_allclose(force, again.force, atol=1e-12)
    np.testing.assert_allclose(normal, again.normal_force, atol=1e-12)


def test_a_constant_normal_load_replaces_the_channel():
    raw = VirtualTribometer.perfect(LAW, normal_force=9.3, turns=2, load_ripple=0.0).record()
    data = process(raw.replace(normal_load=9.0))
    assert (data.normal_force == 9.0).all()


def test_a_constant_normal_load_has_no_error_of_calibration_and_zero():
    raw = VirtualTribometer(LAW, normal_force=9.3, turns=2, sample_rate=2000.0, seed=4).record()
    data = process(raw.replace(normal_load=9.0))
    _, normal = data.perturbed(matrix=data.matrix * 1.01 + 0.002, zero=data.zero + 0.03)
    assert (normal == 9.0).all()
    measured = process(raw).calibration_covariance
    np.testing.assert_array_equal(data.calibration_covariance[:6, :6], measured[:6, :6])
    assert not data.calibration_covariance[6:].any()
    assert not data.calibration_covariance[:, 6:].any()
    assert data.is_load_given


def test_a_calibration_of_unknown_error_has_no_covariance():
    raw = VirtualTribometer(LAW, normal_force=9.3, turns=2, sample_rate=500.0, seed=4).record()
    three = raw.calibration.readings[[5, 11, 17]]
    exact = raw.replace(calibration=Calibration(9.3 * np.eye(3), three))
    assert np.isnan(exact.calibration.covariance).all()
    assert process(exact).calibration_covariance is None


def test_a_file_without_a_complete_turn_is_named():
    t = np.arange(1000) / 500.0
    whole = Recording(
        t, angle=2.0 * np.pi * t, readings=np.tile([1.0, 0.0, 9.0], (1000, 1)), source="whole"
    )
    half = Recording(t, angle=0.5 * np.pi * t, readings=whole.readings, source="half")
    with pytest.raises(RecordError, match=r"half: angle: covers 0\.5 turns"):
        process(RawData([whole, half]))
    # Of a file that was cut, some pieces may be too short.
    piece = half.replace(source="whole, lines 3-1002")
    data = process(RawData([whole, piece]))
    assert (data.turns, data.used, len(data.phi)) == (2, 1000, 2000)


@pytest.mark.parametrize("exponent", [0.0, -0.1])
def test_amontons_law_is_told_from_a_power_of_the_load(exponent):
    runs = []
    for seed, load in enumerate([5.0, 8.0, 12.0, 20.0, 30.0]):
        law = asp.FrictionLaw.isotropic(0.3 * load**exponent)
        options = {"turns": 3, "sample_rate": 200.0, "seed": seed}
        runs.append(process(VirtualTribometer(law, normal_force=load, **options).record()))
    found = load_dependence(runs)
    assert found.low < exponent < found.high
    assert found.is_independent == (exponent == 0.0)
    assert found.exponent == pytest.approx(exponent, abs=0.01)


def test_speed_dependence_of_a_power_law():
    runs = []
    for rate in [0.2, 0.5, 1.0, 2.0]:
        speed = 2.0 * np.pi * rate * 0.05
        options = {"turn_rate": rate, "turns": 3, "sample_rate": 1000.0, "radius": 0.05}
        law = asp.FrictionLaw.isotropic(0.3 * speed**0.15)
        data = process(VirtualTribometer.perfect(law, normal_force=10.0, **options).record())
        np.testing.assert_allclose(data.speed, speed, rtol=1e-9)
        runs.append(data)
    assert speed_dependence(runs).exponent == pytest.approx(0.15, abs=1e-6)


def test_dependence_needs_runs_that_differ():
    with pytest.raises(ParameterError, match="two runs"):
        Dependence([1.0], [0.1])
    # Of two runs nothing tells the scatter.
    two = Dependence([1.0, 2.0], [0.1, 0.2])
    assert two.exponent == pytest.approx(1.0)
    assert (two.low, two.high) == (-np.inf, np.inf)
    with pytest.raises(ParameterError, match="must differ"):
        Dependence([1.0, 1.01, 1.02], [0.1, 0.1, 0.1])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"angle": 0.5 * np.pi * np.linspace(0.0, 1.0, 500)}, r"covers 0\.25 turns"),
        ({"angle": np.zeros(500)}, "the disk does not turn"),
        ({"readings": np.tile([1.0, 0.0, -5.0], (500, 1))}, "no pressure at row"),
    ],
)
def test_records_that_hold_no_measurement_are_refused(change, message):
    t = np.arange(500) / 100.0
    given = {"time": t, "angle": 2.0 * np.pi * t, "readings": np.tile([1.0, 0.0, 5.0], (500, 1))}
    with pytest.raises(RecordError, match=message):
        process(RawData([Recording(**{**given, **change}, source="x")]))


def test_recordings_report_rows():
    t = np.arange(100) / 10.0
    readings = np.ones((100, 3))
    broken = readings.copy()
    broken[[4, 9], 1] = np.nan
    with pytest.raises(RecordError, match="f: readings: NaN or infinity in rows 5, 10"):
        Recording(t, angle=t, readings=broken, source="f")
    late = np.where(np.arange(100) > 41, t + 1.0, t)
    with pytest.raises(RecordError, match="time: does not go on without gap after row 42"):
        Recording(late, angle=t, readings=readings)
    with pytest.raises(RecordError, match="time: does not rise after row 10"):
        Recording(np.where(np.arange(100) == 10, t[9], t), angle=t, readings=readings)
    with pytest.raises(asp.DimensionError, match="angle"):
        Recording(t, angle=t[:-1], readings=readings)


def test_sparse_records_get_fewer_bins():
    virtual = VirtualTribometer(LAW, normal_force=9.3, turns=3, turn_rate=1.0, sample_rate=150.0)
    data = process(virtual.record())
    assert 32 <= len(data.sets.phi) < 450
    averages = data.turn_averages()
    assert 32 <= averages["tangential"].turns.shape[1] < 150
    with pytest.raises(ParameterError, match="bins: must be fewer"):
        data.averaged(720)
    dense = process(virtual.replace(sample_rate=4000.0).record())
    assert (len(dense.averaged().phi), dense.full_bins(360, each_turn=True)) == (720, 360)
