"""A simulated path beside a measured one."""

from dataclasses import dataclass

import asperity as asp
import numpy as np
import pytest

MU, SPEED = 0.5, 1.2
BLOCK = asp.SlidingPoint(0.018, law=asp.FrictionLaw.isotropic(MU))
REST = SPEED / (MU * 9.81)
RUN = asp.simulate(BLOCK, dt=1e-4, t_end=1.0, u0=[SPEED, 0.0], until_rest=True)


@dataclass
class Measured:
    time: np.ndarray
    position: np.ndarray
    position_error: np.ndarray | float | None = None


def straight(t):
    """Closed form of the path."""
    moving = np.minimum(t, REST)
    return np.stack([SPEED * moving - 0.5 * MU * 9.81 * moving**2, np.zeros_like(t)], axis=1)


def test_the_closed_form_agrees_at_any_times_and_after_rest():
    t = np.linspace(0.0, 0.6, 137)
    comparison = asp.compare_path(RUN, Measured(t, straight(t)))
    assert comparison.largest < 2e-8 + 1e-4**2 * 5
    assert len(comparison) == 137
    assert comparison.left_out == 0
    assert comparison.lengths == pytest.approx((SPEED * REST / 2,) * 2, abs=1e-6)


def test_samples_of_smooth_runs_are_interpolated_to_fourth_order():
    errors = []
    for dt in (0.2, 0.1):
        t = np.arange(0.0, 6.0 + dt / 2, dt)
        motion = circle(t)
        times = np.linspace(0.0, 5.9, 501)
        exact = np.stack([np.cos(times), np.sin(times)], axis=1)
        errors.append(asp.compare_path(motion, Measured(times, exact)).largest)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def circle(t):
    """A motion whose samples are those of a circle."""
    run = asp.simulate(BLOCK, dt=t[1], t_end=t[-1], u0=[0.01, 0.0])
    q = np.stack([np.cos(t), np.sin(t)], axis=1)
    u = np.stack([-np.sin(t), np.cos(t)], axis=1)
    return run.replace(q=q, u=u)


def test_known_differences_are_found():
    t = np.arange(0.0, 0.24, 0.002)
    shift = np.array([3e-4, -4e-4])
    comparison = asp.compare_path(RUN, Measured(t, straight(t) + shift, 5e-4))
    assert comparison.difference == pytest.approx(np.tile(-shift, (len(t), 1)), abs=1e-7)
    assert comparison.rms == pytest.approx(5e-4, rel=1e-3)
    assert comparison.end_difference == pytest.approx(-shift, abs=1e-7)
    assert comparison.deviation[5:-5] == pytest.approx(4e-4, abs=1e-9)
    assert comparison.normalised_rms == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert "0 left out" in comparison.summary()


def test_times_may_be_offset_and_frames_lost():
    t = np.arange(0.0, 0.24, 0.002)
    position = straight(t)
    position[7:9] = np.nan
    comparison = asp.compare_path(RUN, Measured(t + 10.0, position), time_offset=10.0)
    assert comparison.left_out == 2
    assert comparison.largest < 1e-7
    assert np.isnan(comparison.normalised_rms)
    early = asp.compare_path(RUN, Measured(t - 0.1, straight(t - 0.1)))
    assert early.left_out == 50


def test_event_driven_motions_and_disks_compare_as_points():
    motion = asp.integrate(BLOCK, t_end=1.0, u0=[SPEED, 0.0])
    disk = asp.SlidingDisk(asp.FrictionLaw.isotropic(MU), velocity=(SPEED, 0.0))
    for other in (motion, asp.simulate(disk, dt=1e-4, t_end=1.0, until_rest=True)):
        assert asp.compare_path(RUN, other).largest < 1e-7
        assert asp.compare_path(other, RUN).largest < 1e-7


@pytest.mark.parametrize(
    ("arguments", "argument"),
    [
        ((3, RUN), "run"),
        ((RUN, 3), "measured"),
        ((RUN, Measured(np.arange(3.0), np.zeros((2, 2)))), "measured.position"),
        ((RUN, Measured(np.array([np.nan]), np.zeros((1, 2)))), "measured.time"),
        ((RUN, Measured(np.array([0.2, 0.1]), np.zeros((2, 2)))), "measured.time"),
        ((RUN, Measured(np.array([0.1, 0.1]), np.zeros((2, 2)))), "measured.time"),
        ((RUN, Measured(np.array([-1.0]), np.zeros((1, 2)))), "measured"),
    ],
)
def test_what_cannot_be_compared_is_refused(arguments, argument):
    with pytest.raises(asp.ParameterError) as caught:
        asp.compare_path(*arguments)
    assert caught.value.argument == argument


def test_a_run_without_samples_is_refused():
    none = np.zeros((0, 0, 2))
    empty = asp.Motion(
        [], np.zeros((0, 2)), np.zeros((0, 2)), none, none, none[..., 0], none[..., 0], events=(),
        status="failed", steps=0, rejected_steps=0,
    )  # fmt: skip
    with pytest.raises(asp.ParameterError, match="run: must hold a sample"):
        asp.compare_path(empty, empty)
