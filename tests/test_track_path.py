"""Velocity and acceleration of measured paths."""

import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from asperity.track import MeasuredPath

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


def test_wider_windows_have_smaller_errors():
    rng = np.random.default_rng(2)
    noisy = decelerated(TIME)[0] + 2e-5 * rng.standard_normal((150, 2))
    narrow, wide = (
        MeasuredPath(TIME, noisy, np.full((150, 2), 2e-5), bandwidth=h) for h in (0.02, 0.04)
    )
    # Errors of a velocity fall with the bandwidth to the power 3/2.
    ratio = narrow.velocity_error[75] / wide.velocity_error[75]
    assert ratio == pytest.approx(2.0**1.5 * narrow.scatter / wide.scatter, rel=0.1)


def test_the_end_is_the_mean_at_rest():
    rng = np.random.default_rng(3)
    t = np.arange(300) / 500.0
    place = np.column_stack([0.25 - 2.0 * np.maximum(0.35 - t, 0.0) ** 2, np.zeros_like(t)])
    path = MeasuredPath(t, place + 1e-5 * rng.standard_normal(place.shape), np.full((300, 2), 1e-5))
    assert path.end == pytest.approx([0.25, 0.0], abs=5e-6)
    assert path.start[0] == pytest.approx(place[0], abs=5e-5)
    assert path.start[1] == pytest.approx([1.4, 0.0], abs=0.02)


def test_too_few_neighbours_give_no_velocity():
    place = decelerated(TIME)[0]
    place[1:30] = np.nan
    path = MeasuredPath(TIME, place, np.full_like(place, 1e-5), bandwidth=0.02)
    assert np.isnan(path.velocity[0]).all()
    assert not np.isnan(path.velocity[40]).any()


def test_a_table_with_units(tmp_path):
    place = decelerated(TIME)[0]
    path = MeasuredPath(TIME, place, np.full_like(place, 1e-5))
    path.to_csv(tmp_path / "path.csv")
    header = (tmp_path / "path.csv").read_text().splitlines()[0].split(",")
    table = np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1)
    assert header[:3] == ["t [s]", "x1 [m]", "x2 [m]"]
    assert table[:, 1:3] == pytest.approx(place, rel=1e-9)
    assert table.shape == (150, len(header))
    assert path.bandwidth == pytest.approx(0.1 * TIME[-1])


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"time": TIME[::-1]}, ParameterError, "time: must ascend"),
        ({"time": TIME[:-1]}, DimensionError, "position: .*149"),
        ({"position": np.full((150, 2), np.nan)}, ParameterError, "position: .*at least 7"),
        ({"position": np.full((150, 2), np.inf)}, ParameterError, "position: .*finite"),
        ({"position_error": np.zeros(150)}, DimensionError, "position_error"),
        ({"bandwidth": 0.0}, ParameterError, "bandwidth"),
    ],
)
def test_bad_arguments_are_named(changes, error, message):
    place = decelerated(TIME)[0]
    good = {"time": TIME, "position": place, "position_error": np.ones_like(place)}
    with pytest.raises(error, match=message):
        MeasuredPath(**{**good, **changes})
