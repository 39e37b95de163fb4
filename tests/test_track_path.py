"""Velocity and acceleration of measured paths."""

import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from asperity.track import MeasuredPath
from asperity.track.cubics import _cubic

TIME = np.arange(150) / 500.0


def decelerated(t):
    place = np.column_stack([1.3 * t - 2.0 * t**2, 0.8 * t - 1.5 * t**2 + 0.6 * t**3])
    velocity = np.column_stack([1.3 - 4.0 * t, 0.8 - 3.0 * t + 1.8 * t**2])
    acceleration = np.column_stack([np.full_like(t, -4.0), -3.0 + 3.6 * t])
    return place, velocity, acceleration


def test_cubics_are_exact_to_the_ends_and_across_gaps():
    place, velocity, acceleration = decelerated(TIME)
    place[40:44] = np.nan
    path = MeasuredPath(TIME, place, np.full_like(place, 1e-6), bandwidth=0.03)
    assert path.velocity[path.seen] == pytest.approx(velocity[path.seen], abs=1e-9)
    assert path.acceleration[path.seen] == pytest.approx(acceleration[path.seen], abs=1e-6)
    assert np.isnan(path.velocity[40:44]).all()
    assert path.seen.sum() == 146
    assert path.scatter == pytest.approx([0.0, 0.0], abs=1e-12)


def test_standard_errors_hold_what_they_say():
    rng = np.random.default_rng(1)
    place, velocity, acceleration = decelerated(TIME)
    scores = {"velocity": [], "acceleration": []}
    scatter = []
    for _ in range(200):
        noisy = place + 2e-5 * rng.standard_normal(place.shape)
        path = MeasuredPath(TIME, noisy, np.full_like(place, 2e-5), bandwidth=0.03)
        scatter.append(path.scatter)
        for name, truth in (("velocity", velocity), ("acceleration", acceleration)):
            score = (getattr(path, name) - truth) / getattr(path, f"{name}_error")
            scores[name].append(score[[0, 40, 75, 149]])
    assert np.mean(scatter) == pytest.approx(2e-5, rel=0.05)
    for values in scores.values():
        assert np.std(values, axis=0) == pytest.approx(np.ones((4, 2)), abs=0.2)


def slid(before, after, rate=500.0):
    """Return times, places and velocities of a slide of 0.3 s between two rests."""
    t = np.arange(round((before + 0.3 + after) * rate)) / rate
    s = np.clip(t - before, 0.0, 0.3)
    speed = np.where((t >= before) & (t < before + 0.3), 1.5 - 5.0 * s, 0.0)
    return t, np.column_stack([1.5 * s - 2.5 * s**2, 0.3 * (1.5 * s - 2.5 * s**2)]), speed


@pytest.mark.parametrize(("before", "after"), [(0.0, 0.02), (0.0, 2.0), (0.5, 2.0)])
def test_rests_before_and_after_change_neither_bandwidth_nor_velocity(before, after):
    rng = np.random.default_rng(5)
    t, place, speed = slid(before, after)
    noisy = place + 2e-5 * rng.standard_normal(place.shape)
    path = MeasuredPath(t, noisy, np.full_like(place, 2e-5))
    assert path.bandwidth == pytest.approx(0.03, rel=0.05)
    assert path.section == pytest.approx((before, before + 0.3), abs=0.012)
    moving = (t > path.section[0]) & (t < path.section[1])
    score = (path.velocity[moving, 0] - speed[moving]) / path.velocity_error[moving, 0]
    assert np.abs(score).max() < 5.0
    velocity0 = path.start[1]
    assert path.time[path.onset] == pytest.approx(before, abs=0.004)
    assert velocity0[0] == pytest.approx(1.5, abs=5.0 * path.velocity_error[path.onset, 0] + 0.01)
    assert path.end == pytest.approx([0.225, 0.0675], abs=3e-5)


def test_windows_that_do_not_fit_are_told():
    rng = np.random.default_rng(6)
    t, place, _ = slid(0.0, 0.0)
    place = place + np.where(t > 0.1, 0.5 * (t - 0.1), 0.0)[:, None]
    path = MeasuredPath(
        t, place + 2e-5 * rng.standard_normal(place.shape), np.full_like(place, 2e-5)
    )
    assert path.misfit[np.abs(t - 0.1) < 0.01].all()
    assert path.misfit[np.abs(t - 0.1) > 0.04].mean() < 0.05


def test_a_body_that_leaves_the_view_has_no_end_point():
    t = np.arange(60) / 500.0
    place = np.column_stack([1.5 * t, 0.0 * t])
    path = MeasuredPath(t, place, np.full_like(place, 1e-5))
    assert not path.comes_to_rest
    with pytest.raises(ParameterError, match="does not come to rest in view"):
        assert path.end is None


def test_windows_are_exact_however_long():
    """The closed form of the degrees of freedom against the matrix itself."""
    rng = np.random.default_rng(8)
    offset = np.sort(rng.uniform(-1.0, 1.0, 40))
    places = rng.standard_normal((40, 2))
    variance = _cubic(offset, places)[2]
    weight = 1.0 - offset**2
    powers = offset[:, None] ** np.arange(4)
    left = np.eye(40) - powers @ np.linalg.pinv(powers * weight[:, None]) @ np.diag(weight)
    trace = np.trace(np.diag(weight**2) @ left @ left.T)
    assert variance == pytest.approx(weight**2 @ (left @ places) ** 2 / trace)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"time": TIME[::-1]}, ParameterError, "time: must ascend"),
        ({"time": TIME[:-1]}, DimensionError, "position: .*149"),
        ({"position": np.full((150, 2), np.nan)}, ParameterError, "position: .*at least 7"),
        ({"position": np.full((150, 2), np.inf)}, ParameterError, "position: .*finite"),
        ({"position_error": np.zeros(150)}, DimensionError, "position_error"),
        ({"bandwidth": 0.0}, ParameterError, "bandwidth"),
        ({"section": (0.2, 0.1)}, ParameterError, "section: must ascend"),
    ],
)
def test_bad_arguments_are_named(changes, error, message):
    place = decelerated(TIME)[0]
    good = {"time": TIME, "position": place, "position_error": np.ones_like(place)}
    with pytest.raises(error, match=message):
        MeasuredPath(**{**good, **changes})
