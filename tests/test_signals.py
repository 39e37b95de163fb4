"""Signals: splines and straight lines between samples, periodic or not, and sines."""

import numpy as np
import pytest
from asperity import (
    Body,
    DimensionError,
    ParameterError,
    PlanarBody,
    RigidBodies,
    Signal,
    Sine,
    Spring,
    integrate,
    simulate,
)
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

RNG = np.random.default_rng(7)


def samples(n, periodic, shape):
    t, y = np.cumsum(RNG.uniform(0.1, 2.0, n)), RNG.normal(size=(n, *shape))
    if periodic:
        y[-1] = y[0]
    return t, y


def derivatives(signal, t):
    return np.stack([signal(t), signal.derivative(t), signal.derivative(t, order=2)])


def test_a_cubic_signal_through_a_cubic_is_this_cubic():
    cubic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.25])
    t, x = np.array([0.0, 0.3, 1.0, 1.1, 2.5]), np.linspace(0.0, 2.4, 25)
    signal = Signal(t, cubic(t), interpolation="cubic")
    known = [cubic(x), cubic.deriv()(x), cubic.deriv(2)(x)]
    np.testing.assert_allclose(derivatives(signal, x), known, atol=1e-12)
    whole = cubic.integ()(2.4) - cubic.integ()(0.2)
    np.testing.assert_allclose(signal.integral(0.2, 2.4), whole, atol=1e-13)


@pytest.mark.parametrize("coefficients", [[1.0] * 6, [np.nan] * 8])
def test_coefficients_of_signals_are_checked(coefficients):
    core = Signal([0.0, 1.0], [0.0, 1.0], interpolation="linear")._core
    with pytest.raises((ParameterError, DimensionError), match="coefficients"):
        type(core).cubic(np.array([0.0, 1.0, 2.0]), np.array(coefficients), np.zeros(1), False)


@pytest.mark.parametrize("shape", [(), (3,)])
@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("n", [2, 3, 4, 5, 40])
def test_cubic_signals_are_the_splines_of_scipy(n, periodic, shape):
    t, y = samples(n, periodic, shape)
    signal = Signal(t, y, interpolation="cubic", periodic=periodic)
    known = CubicSpline(t, y, bc_type="periodic" if periodic else "not-a-knot")
    x = RNG.uniform(-30.0, 30.0, 200) if periodic else RNG.uniform(t[0], t[-1], 200)
    for found, wanted in zip(derivatives(signal, x), [known(x, i) for i in range(3)], strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-10 * max(1.0, np.abs(wanted).max()))
    a, b = np.sort(x[:2])
    np.testing.assert_allclose(signal.integral(a, b), known.integrate(a, b), atol=1e-11)
    assert np.shape(signal(0.3)) == shape
    assert np.shape(signal(x.reshape(2, -1))) == (2, 100, *shape)


def test_jumps_and_kinks_are_breaks_and_straight_samples_are_not():
    step = Signal([0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 5.0, 5.0], interpolation="linear")
    np.testing.assert_array_equal(step([1.0 - 1e-12, 1.0, 1.5]), [0.0, 5.0, 5.0])
    assert step.breaks(0.0, 9.0).tolist() == [1.0]
    assert step.integral(0.0, 2.0) == 5.0
    straight = Signal(np.linspace(0.0, 1.0, 11), np.linspace(0.0, 0.3, 11), interpolation="linear")
    assert straight.breaks(-1.0, 2.0).tolist() == [0.0, 1.0]
    smooth = Signal(np.arange(5.0), [0.0, 2.0, -1.0, 3.0, 0.0], interpolation="cubic")
    assert smooth.breaks(-1.0, 9.0).tolist() == [0.0, 4.0]
    round_ = Signal(
        np.arange(5.0), [0.0, 2.0, -1.0, 3.0, 0.0], interpolation="cubic", periodic=True
    )
    assert round_.breaks(-1.0, 9.0).size == 0
    assert round_.period == 4.0
    saw = Signal([0.0, 0.7], [0.0, 1.0], interpolation="linear", periodic=True)
    np.testing.assert_allclose(saw.breaks(0.0, 7.05), 0.7 * np.arange(1, 11))


@pytest.mark.parametrize("phase", [0.0, [0.3, -1.0]])
def test_a_sine_is_exact(phase):
    signal = Sine([2.0, -1.0], frequency=3.0, phase=phase, offset=0.5)
    t = RNG.uniform(-4.0, 9.0, 50)
    angle = 6.0 * np.pi * t[:, None] + np.broadcast_to(phase, 2)
    a, omega = np.array([2.0, -1.0]), 6.0 * np.pi
    wanted = [0.5 + a * np.sin(angle), a * omega * np.cos(angle), -a * omega**2 * np.sin(angle)]
    np.testing.assert_allclose(derivatives(signal, t), wanted, rtol=1e-12, atol=1e-10)
    integral = [quad(lambda t, k=k: signal(t)[k], 0.1, 2.2, limit=200)[0] for k in (0, 1)]
    np.testing.assert_allclose(signal.integral(0.1, 2.2), integral, atol=1e-10)
    assert signal.breaks(0.0, 9.0).size == 0
    assert signal.period == 1.0 / 3.0


@pytest.mark.parametrize(
    ("make", "error", "argument"),
    [
        (lambda: Signal([], [], interpolation="linear"), DimensionError, "times"),
        (lambda: Signal([0.0], [1.0], interpolation="linear"), ParameterError, "times"),
        (lambda: Signal([0.0, 0.0], [1.0, 2.0], interpolation="linear"), ParameterError, "times"),
        (lambda: Signal([1.0, 0.0], [1.0, 2.0], interpolation="cubic"), ParameterError, "times"),
        (
            lambda: Signal([0, 1, 1, 1, 2], np.ones(5), interpolation="linear"),
            ParameterError,
            "times",
        ),
        (lambda: Signal([0.0, 1.0], [1.0], interpolation="linear"), DimensionError, "values"),
        (
            lambda: Signal([0.0, 1.0], np.ones((2, 0)), interpolation="linear"),
            ParameterError,
            "values",
        ),
        (
            lambda: Signal([0.0, 1.0], np.ones((2, 1, 1)), interpolation="linear"),
            DimensionError,
            "values",
        ),
        (
            lambda: Signal([0.0, np.nan], [1.0, 2.0], interpolation="linear"),
            ParameterError,
            "times",
        ),
        (lambda: Signal([0.0, 1.0], [1e300, -1e300], interpolation="cubic"), None, ""),
        (
            lambda: Signal([0.0, 1e-10], [1e300, -1e300], interpolation="cubic"),
            ParameterError,
            "values",
        ),
        (
            lambda: Signal([0.0, 1.0], [1.0, 2.0], interpolation="spline"),
            ParameterError,
            "interpolation",
        ),
        (lambda: Sine(1.0, frequency=0.0), ParameterError, "frequency"),
        (lambda: Sine([1.0, 2.0], frequency=1.0, phase=[1.0, 2.0, 3.0]), DimensionError, "phase"),
        (lambda: Sine([[1.0]], frequency=1.0), DimensionError, "amplitude"),
        (lambda: Sine(1.0, frequency=1.0).derivative(0.0, order=3), ParameterError, "order"),
    ],
)
def test_arguments_are_checked(make, error, argument):
    if error is None:
        make()
        return
    with pytest.raises(error) as raised:
        make()
    assert raised.value.argument == argument


# Loads of bodies and lengths of springs.


def planar(**loads):
    return RigidBodies([PlanarBody(2.0, inertia=0.5, **loads)], gravity=[0.0, 0.0])


def test_loads_that_depend_on_time_drive_bodies():
    force = Signal(
        [0.0, 0.3, 0.3, 1.0],
        [[0.0, 1.0], [2.0, 1.0], [-1.0, 3.0], [1.0, 0.0]],
        interpolation="linear",
    )
    torque = Signal(np.linspace(0.0, 2.0, 9), RNG.normal(size=9), interpolation="cubic")
    system, t_end = planar(force=force, torque=torque), 1.7
    known = np.append(force.integral(0.0, t_end) / 2.0, torque.integral(0.0, t_end) / 0.5)
    motion = integrate(system, t_end=t_end)
    np.testing.assert_allclose(motion.u[-1], known, atol=1e-12)
    way = [
        quad(lambda t, k=k: (t_end - t) * force(t)[k], 0.0, t_end, points=[0.3, 1.0])[0]
        for k in (0, 1)
    ]
    np.testing.assert_allclose(motion.q[-1, :2], np.array(way) / 2.0, atol=1e-10)
    errors = [
        np.abs(simulate(system, dt=dt, t_end=t_end).u[-1] - known).max()
        for dt in (1e-2, 1e-3, 1e-4)
    ]
    assert all(error < 2.0 * dt for error, dt in zip(errors, (1e-2, 1e-3, 1e-4), strict=True))


@pytest.mark.parametrize(
    "signal",
    [
        Sine(0.5, frequency=1.3, phase=0.4, offset=0.6),
        Signal([0.0, 1.0], [0.2, 0.7], interpolation="linear"),
    ],
)
def test_functions_do_what_their_signals_do(signal):
    def run(load, length):
        body = PlanarBody(2.0, inertia=0.5, position=(1.0, 0.0), force=load)
        spring = Spring(0, point=(0.0, 0.0), stiffness=20.0, length=length)
        system = RigidBodies([body], springs=[spring], gravity=[0.0, 0.0])
        return [integrate(system, t_end=1.0).u[-1], simulate(system, dt=1e-2, t_end=1.0).u[-1]]

    given = Sine([1.0, 0.5], frequency=0.7)
    for a, b in zip(run(given, signal), run(lambda t: given(t), lambda t: signal(t)), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)


@pytest.mark.parametrize(
    ("function", "error"),
    [
        (lambda t: [t], DimensionError),
        (lambda t: [np.nan, 0.0], ParameterError),
        (lambda t: [1j, 0.0], ParameterError),
        (lambda t: [1.0 / (t - t), 0.0], ZeroDivisionError),
    ],
)
def test_what_is_wrong_with_a_function_is_said(function, error):
    for run in (lambda s: simulate(s, dt=0.01, t_end=1.0), lambda s: integrate(s, t_end=1.0)):
        with pytest.raises(error) as raised:
            run(planar(force=function))
        if error is not ZeroDivisionError:
            assert raised.value.argument == "force"


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: planar(force=Sine([1.0, 0.0, 0.0], frequency=1.0)), "force"),
        (lambda: planar(torque=Sine([1.0], frequency=1.0)), "torque"),
        (lambda: Body.ball(1.0, radius=0.1, torque=Sine(1.0, frequency=1.0)), "torque"),
        (
            lambda: Spring(0, point=(0.0, 0.0), stiffness=1.0, length=Sine([1.0], frequency=1.0)),
            "length",
        ),
    ],
)
def test_signals_of_another_shape_are_refused(make, argument):
    with pytest.raises(DimensionError) as raised:
        make()
    assert raised.value.argument == argument
