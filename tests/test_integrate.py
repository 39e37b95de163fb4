"""Event-driven integration against SciPy, closed forms and time stepping."""

import os

import asperity as asp
import numpy as np
import pytest
from children import run_interrupted
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

TIGHT = {"rtol": 1e-12, "atol": 1e-13}


def belt():
    c = asp.Ellipse(30.0, 10.0).rotated(np.deg2rad(30.0))
    v = np.deg2rad(50.0)
    law = asp.FrictionLaw(c, asp.Ellipse(3.0, 1.0))
    return asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[np.cos(v), np.sin(v)]
    )


def ellipse_force(g):
    """−λ of C with semi-axes 30, 10 at 30° and D with semi-axes 3, 1: closed formulas."""
    z = np.array([9.0, 1.0]) * g / np.sqrt(9.0 * g[0] ** 2 + g[1] ** 2)
    turn = np.deg2rad(30.0)
    x, y = np.cos(turn) * z[0] + np.sin(turn) * z[1], np.cos(turn) * z[1] - np.sin(turn) * z[0]
    return z / np.hypot(x / 30.0, y / 10.0)


def test_slip_on_the_belt_agrees_with_scipy():
    """From a state in full slip until the slip is almost over, and the time when it vanishes."""
    v = np.array([np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))])
    q0, u0 = [22.0, 8.0], [-1.0, -3.0]

    def field(_, y):
        return [*y[2:], *(-y[:2] - ellipse_force(y[2:] - v))]

    def speed(_, y):
        return np.hypot(*(y[2:] - v)) - 1e-7

    speed.terminal, speed.direction = True, -1
    expected = solve_ivp(
        field, (0.0, 30.0), [*q0, *u0], method="Radau", events=speed, rtol=1e-10, atol=1e-12
    )
    motion = asp.integrate(belt(), t_end=30.0, q0=q0, u0=u0, tolerance=1e-12)
    event = motion.events[0]
    state = expected.y_events[0][0]
    slip = state[2:] - v
    rate = slip @ (np.array(field(0.0, state))[2:]) / np.hypot(*slip)
    assert event.time == pytest.approx(expected.t[-1] - 1e-7 / rate, abs=1e-7)
    at = asp.integrate(belt(), t_end=event.time, q0=q0, u0=u0, tolerance=1e-12)
    assert at.q[-1] == pytest.approx(state[:2], abs=3e-7)
    half = 0.5 * event.time
    middle = solve_ivp(field, (0.0, half), [*q0, *u0], method="DOP853", **TIGHT).y[:, -1]
    ours = asp.integrate(belt(), t_end=half, q0=q0, u0=u0, tolerance=1e-12)
    assert np.concatenate([ours.q[-1], ours.u[-1]]) == pytest.approx(middle, abs=1e-9)


def test_stick_ends_on_the_boundary_of_the_reservoir():
    law = belt().law
    v = np.array([np.cos(np.deg2rad(50.0)), np.sin(np.deg2rad(50.0))])
    motion = asp.integrate(belt(), t_end=30.0, u0=v)
    expected = brentq(lambda t: law.reservoir.gauge(v * t) - 1.0, 1.0, 100.0, xtol=1e-13)
    assert motion.events[0].kind is asp.EventKind.SLIP
    assert motion.events[0].time == pytest.approx(expected, abs=1e-11)


def over_a_floor(height, *, friction=0.5, stiffness=None, force=(0.0, -10.0)):
    """Return a point of 1 kg over a floor: coordinates across and up."""
    law = asp.FrictionLaw.isotropic(friction, dimension=1)
    floor = asp.Contact(law, direction=[1.0, 0.0], normal=[0.0, 1.0], gap=height)
    return asp.LinearSystem([1.0, 1.0], stiffness=stiffness, force=force, contacts=[floor])


def falling():
    return asp.integrate(over_a_floor(2.0), t_end=1.0, u0=[0.3, 1.0]), (1.0 + 41.0**0.5) / 10.0


def sliding():
    return asp.integrate(over_a_floor(0.0), t_end=1.0, u0=[3.0, 0.0]), 3.0 / 5.0


def lifted():
    """λ_N = 10 − 8 x is 0 where x = 2 (1 − cos t) is 1.25, without friction worth the name."""
    coupled = {"stiffness": [[1.0, -8.0], [-8.0, 0.0]], "force": (2.0, -10.0)}
    system = over_a_floor(0.0, friction=1e-50, **coupled)
    return asp.integrate(system, t_end=2.0), np.arccos(1.0 - 1.25 / 2.0)


def pushed():
    """A spring of 2 N/m that is pulled with 1 m/s; the contact holds 5 N."""
    system = asp.LinearSystem(
        [1.0, 1e6],
        stiffness=[[2.0, -2.0], [-2.0, 2.0]],
        contacts=[
            asp.Contact(
                asp.FrictionLaw.isotropic(0.5, dimension=1), direction=[1.0, 0.0], normal_force=10.0
            )
        ],
    )
    # The mass that pulls is slowed down by what it pulls.
    rate = np.sqrt(2.0 / 1e6)
    return asp.integrate(system, t_end=4.0, u0=[0.0, 1.0]), np.arcsin(2.5 * rate) / rate


EVENTS = [("impact", falling), ("stick", sliding), ("open", lifted), ("slip", pushed)]


@pytest.mark.parametrize(("kind", "case"), EVENTS, ids=[kind for kind, _ in EVENTS])
def test_events_are_located_to_rounding(kind, case):
    """Against closed forms, with the tolerance that is the default."""
    motion, expected = case()
    first = next(one for one in motion.events if one.kind == kind)
    assert first.time == pytest.approx(expected, rel=1e-13)


def test_a_section_ends_the_motion():
    system = asp.LinearSystem(1.0, stiffness=1.0)
    start = {"q0": [1.0], "u0": [0.0], "tolerance": 1e-12}
    section = asp.Section([1.0, 0.0], 0.0)
    motion = asp.integrate(system, t_end=20.0, section=section, **start)
    assert motion.at_section
    assert motion.status is asp.Outcome.SECTION
    assert motion.t[-1] == pytest.approx(1.5 * np.pi, abs=1e-11)
    assert motion.events[-1] == asp.runs.Event(motion.t[-1], "section")
    later = asp.integrate(system, t_end=20.0, section=section.replace(after=6.0), **start)
    assert later.t[-1] == pytest.approx(3.5 * np.pi, abs=1e-11)
    # A motion that starts on the section crosses it when it comes back.
    again = asp.integrate(
        system, t_end=20.0, q0=motion.q[-1], u0=motion.u[-1], section=section, tolerance=1e-12
    )
    assert again.t[-1] == pytest.approx(2.0 * np.pi, abs=1e-11)
    assert not asp.integrate(system, t_end=1.0, section=section, **start).at_section


class Pendulum(asp.System):
    """A bob on a rod that rubs in its joint; the second coordinate turns the contact."""

    dof = 2
    contacts = (asp.ContactLaw(asp.FrictionLaw.isotropic(0.3, dimension=1), normal_force=2.0),)

    def mass(self, q):
        return np.diag([1.0, 2.0 + np.cos(q[0])])

    def forces(self, t, q, u):
        bend = 0.5 * np.sin(q[0])
        return np.array([-9.81 * np.sin(q[0]) - bend * u[1] ** 2, 2 * bend * u[0] * u[1]])

    def direction(self, t, q, contact):
        return np.array([[np.cos(q[1])], [np.sin(q[1])]])


def test_systems_of_python_agree_with_time_stepping():
    system = Pendulum()
    start = {"t_end": 1.5, "q0": [0.5, 0.3], "u0": [0.0, 1.0]}
    motion = asp.integrate(system, **start)
    errors = []
    for dt in (1e-2, 1e-3):
        steps = asp.simulate(system, dt=dt, **start)
        errors.append(np.abs(steps.q[-1] - motion.q[-1]).max())
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 1e-2
    sharper = asp.integrate(system, tolerance=1e-12, **start)
    assert motion.q[-1] == pytest.approx(sharper.q[-1], abs=1e-8)


def test_choices_are_marked():
    """The third slip on the belt begins, or might have begun, in several directions."""
    motion = asp.integrate(belt(), t_end=38.0, q0=[20.2, 2.7])
    assert [event.ambiguous for event in motion.events].count(True) == motion.ambiguous_events == 1
    steps = asp.simulate(belt(), dt=1e-3, t_end=38.0, q0=[20.2, 2.7])
    assert steps.ambiguous_steps > 0


def test_samples_do_not_change_the_motion():
    motion = asp.integrate(belt(), t_end=60.0, q0=[20.2, 2.7], tolerance=1e-12)
    grid = asp.integrate(belt(), t_end=60.0, q0=[20.2, 2.7], tolerance=1e-12, sample_every=0.5)
    assert grid.t == pytest.approx(np.arange(121) * 0.5)
    assert grid.events == motion.events
    assert (grid.q[-1] == motion.q[-1]).all()
    law = belt().law
    slipping = grid.phase[:, 0] == asp.Phase.SLIP
    expected = [law.force(slip, normal_force=1.0) for slip in grid.slip[slipping, 0]]
    assert grid.force[slipping, 0] == pytest.approx(np.array(expected), rel=1e-9)


def test_samples_of_bodies_in_space_are_states_of_the_motion():
    body = asp.Body(
        1.0, inertia=[0.01, 0.02, 0.025], angular_velocity=(1, 2, 3), velocity=(0.3, 0.2, 1)
    )
    system = asp.RigidBodies([body])
    motion = asp.integrate(system, t_end=1.0)
    grid = asp.integrate(system, t_end=1.0, sample_every=0.1)
    assert (grid.q[-1] == motion.q[-1]).all()
    assert (grid.u[-1] == motion.u[-1]).all()


def bad(**changes):
    return {"system": belt(), "t_end": 1.0, **changes}


@pytest.mark.parametrize(
    ("argument", "arguments"),
    [
        ("system", bad(system=3)),
        ("t_end", bad(t_end=0.0)),
        ("q0", bad(q0=[1.0])),
        ("u0", bad(u0=[1.0, np.nan])),
        ("tolerance", bad(tolerance=1.0)),
        ("sample_every", bad(sample_every=-1.0)),
        ("section", bad(section=3.0)),
        ("section", bad(section=asp.Section([1.0, 0.0], 0.0))),
        ("max_events", bad(max_events=0)),
        ("progress", bad(progress=3)),
        (
            "contacts",
            bad(
                system=asp.SlidingPoint(
                    1.0, law=asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.3))
                )
            ),
        ),
    ],
)
def test_bad_input_is_named(argument, arguments):
    with pytest.raises(asp.ParameterError) as info:
        asp.integrate(arguments.pop("system"), **arguments)
    assert info.value.argument == argument


def shaken():
    """A block that a force shakes, with a kink at 1.3 s."""
    pull = asp.Signal(
        [0.0, 1.3, 4.0], [[0.0, 0.0], [6.5, 1.0], [-7.0, 0.0]], interpolation="linear"
    )
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    foot = asp.PointPlane(0, point=[0.0, 0.0], plane=asp.Line(), law=law)
    block = asp.PlanarBody(1.0, inertia=1.0, force=pull)
    return asp.RigidBodies([block], pairs=[foot], gravity=[0.0, -10.0])


@pytest.mark.parametrize("cut", [0.2, 0.9, 1.3, 2.0, 2.6])
def test_a_run_goes_on_at_its_clock(cut):
    whole = asp.integrate(shaken(), t_end=4.0, sample_every=0.25)
    first = asp.integrate(shaken(), t_end=cut)
    assert first.end == asp.State(first.q[-1], first.u[-1], t0=cut)
    for start in (first, first.end, first.slice(0.1, cut)):
        second = asp.integrate(shaken(), t_end=4.0, start=start, sample_every=0.25)
        np.testing.assert_allclose(second.t[:-1], cut + 0.25 * np.arange(len(second.t) - 1))
        assert second.t[-1] == 4.0
        assert second.options.start.t == cut
        assert second.repeat() == second
        np.testing.assert_allclose(second.q[-1], whole.q[-1], atol=1e-9)
        np.testing.assert_allclose(second.u[-1], whole.u[-1], atol=1e-9)
        later = [(e.kind, e.contact, e.time) for e in whole.events if e.time > cut + 1e-9]
        found = [(e.kind, e.contact, e.time) for e in second.events if e.time > cut + 1e-9]
        assert [e[:2] for e in found] == [e[:2] for e in later]
        np.testing.assert_allclose([e[2] for e in found], [e[2] for e in later], atol=1e-9)


def test_runs_start_from_each_other_however_they_were_made():
    stepped = asp.simulate(belt(), dt=1e-3, t_end=1.0)
    exact = asp.integrate(belt(), t_end=1.0)
    for start in (stepped, stepped.end, exact, exact.end):
        further = asp.integrate(belt(), t_end=2.0, start=start)
        assert further.t[0] == pytest.approx(1.0)
        again = asp.simulate(belt(), dt=1e-3, t_end=2.0, start=start)
        assert again.steps == 1000
        np.testing.assert_allclose(again.q[-1], further.q[-1], atol=1e-2)
    for function, options in ((asp.simulate, {"dt": 0.1}), (asp.integrate, {})):
        with pytest.raises(asp.ParameterError, match="start: excludes q0 and u0"):
            function(belt(), t_end=2.0, start=exact, u0=[0.0, 0.0], **options)
        with pytest.raises(asp.ParameterError, match="start: must be a run or a State"):
            function(belt(), t_end=2.0, start=[0.0, 0.0], **options)
        with pytest.raises(asp.ParameterError, match=r"t_end: must lie after .* 1 s"):
            function(belt(), t_end=1.0, start=exact, **options)
        with pytest.raises(asp.ParameterError, match="start: does not know"):
            function(belt(), t_end=2.0, start=stepped.slice(0.0, 0.5), **options)
        with pytest.raises(asp.DimensionError, match="q0"):
            function(belt(), t_end=2.0, start=asp.State([0.0], [0.0, 0.0]), **options)
    with pytest.raises(asp.ParameterError, match="start: must not be at a negative time"):
        asp.integrate(belt(), t_end=2.0, start=exact.end.replace(t0=-1.0))


def test_failures_hold_the_part_before():
    with pytest.raises(asp.ConvergenceError, match="max_events") as info:
        asp.integrate(belt(), t_end=60.0, q0=[20.2, 2.7], max_events=2)
    assert len(info.value.trajectory.events) == 2

    class Broken(Pendulum):
        def forces(self, t, q, u):
            if t > 0.1:
                raise RuntimeError("no forces")
            return super().forces(t, q, u)

    with pytest.raises(RuntimeError, match="no forces") as error:
        asp.integrate(Broken(), t_end=1.0, u0=[1.0, 0.0])
    assert error.value.trajectory.t[-1] <= 0.1


INTERRUPTED = """
import asperity as asp
seen = []
def report(t, t_end):
    seen.append((t, t_end))
    if len(seen) == 3:
        print("ready", flush=True)
system = asp.LinearSystem(1.0, stiffness=1e6)
try:
    asp.integrate(system, t_end=1e6, q0=[1.0], sample_every=1e3, progress=report)
except asp.errors.SimulationInterrupted as stopped:
    print("interrupted", flush=True)
    assert stopped.trajectory.t[-1] > 0.0
    assert all(t < t_end == 1e6 for t, t_end in seen)
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_a_long_run_is_interrupted_and_reports():
    found = run_interrupted(INTERRUPTED)
    assert found.lines == ["interrupted"]
    assert found.code == 42
