"""The virtual tribometer: what it is told to do to the forces is what it does."""

import pickle

import asperity as asp
import numpy as np
import pytest
from asperity.errors import ParameterError
from asperity.identify import VirtualTribometer, process

LAW = asp.FrictionLaw(
    asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)


def unit(phi):
    return np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def virtual(**options):
    return VirtualTribometer.perfect(
        LAW, **{"normal_force": 9.3, "turns": 2, "turn_rate": 1.0, **options}
    )


def test_readings_are_the_forces_of_the_law():
    (run,) = virtual(crosstalk=np.eye(3), load_ripple=0.05, start_angle=0.7).record().recordings
    lam = LAW.force(unit(run.angle), normal_force=run.readings[:, 2])
    c, s = np.cos(run.angle), np.sin(run.angle)
    # (119) solved for the forces in the frame of the rig.
    np.testing.assert_allclose(run.readings[:, 0], -c * lam[:, 0] - s * lam[:, 1], atol=1e-12)
    np.testing.assert_allclose(run.readings[:, 1], s * lam[:, 0] - c * lam[:, 1], atol=1e-12)
    assert np.ptp(run.readings[:, 2]) == pytest.approx(2 * 0.05 * 9.3, rel=1e-4)
    assert run.angle[0] == 0.7
    assert run.turns == pytest.approx(2.0, abs=1e-3)


def test_crosstalk_is_bounded_and_undone_by_its_calibration():
    matrices = [np.linalg.inv(virtual(seed=k).record().calibration.matrix) for k in range(50)]
    apart = abs(np.array(matrices) - np.eye(3))
    assert 0.045 < apart.max() <= 0.05
    data = process(virtual(seed=3, load_ripple=0.0).record())
    np.testing.assert_allclose(data.force, -LAW.force(unit(data.phi), normal_force=9.3), atol=1e-10)


def test_noise_has_its_level_and_its_colour():
    friction = 9.3 * np.linalg.norm(LAW.force(unit(np.arange(720) * np.pi / 360)), axis=1).mean()
    options = {"turns": 40, "crosstalk": np.eye(3), "seed": 8}
    exact = virtual(**options).record().recordings[0].readings
    white = virtual(**options, noise=0.01).record().recordings[0].readings - exact
    slow = virtual(**options, noise=0.01, noise_bandwidth=5.0).record().recordings[0].readings
    levels = 0.01 * np.array([friction, friction, 9.3])
    np.testing.assert_allclose(white.std(axis=0), levels, rtol=0.01)
    # 40 s of first-order noise of 5 Hz are 628 independent values: 3 % of the deviation.
    np.testing.assert_allclose((slow - exact).std(axis=0), levels, rtol=0.1)
    memory = [np.corrcoef(x[1:], x[:-1])[0, 1] for x in (slow - exact).T]
    np.testing.assert_allclose(memory, np.exp(-2.0 * np.pi * 5.0 / 10_000.0), atol=1e-3)
    assert max(abs(np.corrcoef(x[1:], x[:-1])[0, 1]) for x in white.T) < 0.01
    assert abs(np.corrcoef(white.T) - np.eye(3)).max() < 0.01


def test_readings_are_rounded():
    (run,) = virtual(bits=8).record().recordings
    step = 8.0 * 9.3 / 2**8
    np.testing.assert_allclose(run.readings / step, np.round(run.readings / step), atol=1e-9)


def test_zeros_and_drift_are_taken_away_by_the_records_without_load():
    options = {"zero": 0.1, "drift": 0.2, "no_load_time": 3.0, "load_ripple": 0.0, "seed": 9}
    raw = virtual(**options, crosstalk=np.eye(3)).record()
    before, after = raw.no_load
    assert before.time[-1] < raw.recordings[0].time[0] < raw.recordings[0].time[-1] < after.time[0]
    assert abs(before.readings[0]).max() > 0.01
    assert abs(after.readings[-1] - before.readings[0]).max() > 0.05
    data = process(raw)
    np.testing.assert_allclose(data.force, -LAW.force(unit(data.phi), normal_force=9.3), atol=1e-9)
    # A drift is no noise: without noise the zero is certain.
    assert np.diag(data.zero_covariance).max() < 1e-24


def test_calibration_and_zero_are_as_uncertain_as_they_say():
    deviations = []
    for seed in range(200):
        options = {"turns": 1, "turn_rate": 1.0, "sample_rate": 100.0, "no_load_time": 4.0}
        machine = VirtualTribometer(
            LAW, normal_force=9.3, seed=seed, drift=0.0, zero=0.0, **options
        )
        data = process(machine.record())
        exact = VirtualTribometer.perfect(
            LAW, normal_force=9.3, seed=seed, **options | {"no_load_time": 0.0}
        )
        truth = exact.record().calibration.matrix
        t = (data.matrix - truth).ravel() / np.sqrt(np.diag(data.calibration_covariance))
        z = data.zero / np.sqrt(np.diag(data.zero_covariance))
        deviations.append(np.concatenate([t, z]))
    spread = np.std(deviations, axis=0)
    # 200 seeds: 5 % standard error; Student's t with 38 degrees of freedom adds 3 %.
    assert (spread > 0.85).all()
    assert (spread < 1.2).all()
    assert abs(np.mean(deviations, axis=0)).max() < 0.27


def test_same_seed_same_bits():
    machine = VirtualTribometer(LAW, normal_force=9.3, turns=1, seed=11)
    assert machine.record() == machine.record()
    assert machine.record() != machine.replace(seed=12).record()


def test_the_sensor_may_be_uncalibrated():
    raw = virtual(calibration_loads=0, crosstalk=np.eye(3)).record()
    assert raw.calibration is None
    assert process(raw).calibration_covariance is None
    assert process(raw).zero_covariance is None


@pytest.mark.parametrize(
    ("options", "argument"),
    [
        ({"law": asp.FrictionLaw.isotropic(0.2, dimension=3)}, "law"),
        ({"law": None}, "law"),
        ({"normal_force": 0.0}, "normal_force"),
        ({"turn_rate": 0.0}, "turn_rate"),
        ({"turns": -1.0}, "turns"),
        ({"noise": -0.1}, "noise"),
        ({"crosstalk": [1.0, 2.0]}, "crosstalk"),
        ({"load_ripple": 2.0}, "load_ripple"),
        ({"bits": 0}, "bits"),
        ({"seed": -1}, "seed"),
        ({"sample_rate": np.nan}, "sample_rate"),
    ],
)
def test_bad_parameters_name_themselves(options, argument):
    with pytest.raises(ParameterError) as caught:
        VirtualTribometer(**{"law": LAW, "normal_force": 9.3, **options})
    assert caught.value.argument == argument


def values():
    machine = virtual(sample_rate=200.0, no_load_time=1.0, noise=0.01)
    data = process(machine.record())
    means = data.averaged(36)
    return [
        machine,
        data.raw,
        *data.raw.recordings,
        data.raw.calibration,
        data,
        means,
        asp.identify.MeasuredSets(means.phi, means.force),
        asp.identify.MeasuredSets(means.phi, means.force).direction,
        data.turn_averages(36)["tangential"],
        asp.identify.Dependence([1.0, 2.0, 3.0], [0.3, 0.3, 0.31]),
        asp.identify.Configuration({"units": {"angle": "deg"}}),
        asp.identify.Processing(cut_off=None, order=2),
    ]


@pytest.mark.parametrize("value", values(), ids=lambda value: type(value).__name__)
def test_values_are_equal_picklable_and_immutable(value):
    again = pickle.loads(pickle.dumps(value))
    assert again == value
    assert hash(again) == hash(value)
    assert value.replace() == value
    assert "array" not in repr(value)
    with pytest.raises(AttributeError, match="immutable"):
        value.source = "other"
