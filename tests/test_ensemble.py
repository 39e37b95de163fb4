"""Many runs in one call are the runs, one by one."""

import logging
import os
import pickle
import re

import asperity as asp
import numpy as np
import pytest
from asperity.ensemble.variants import Variants
from children import run_interrupted
from random_laws import convex_plane, star_plane

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.4, angle=0.2), asp.Ellipse(0.6, 0.5))
BELT = asp.MassOnBelt(1.3, stiffness=1.7, law=LAW, normal_force=2.0, belt_velocity=[0.3, 0.1])
POINT = asp.SlidingPoint(0.7, law=LAW)
SERIES = ("t", "q", "u", "slip", "force", "normal_force", "phase")
STEPS = {"dt": 0.01, "t_end": 1.5}
STATES = np.random.default_rng(3).normal(size=(5, 2))
ANGLES = np.linspace(0.0, 3.0, 4)


# Steady sliding is unstable, and the motion goes to a cycle of stick and slip.
UNSTABLE = asp.MassOnBelt(
    1.0,
    stiffness=1.0,
    law=asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0)),
    normal_force=1.0,
    belt_velocity=[np.cos(np.radians(50.0)), np.sin(np.radians(50.0))],
)


def assert_is(ensemble, index, run):
    """The run of an index ends as a run does, to the bit."""
    for name in SERIES:
        np.testing.assert_array_equal(getattr(ensemble, name)[index], getattr(run, name)[-1])
    assert ensemble.status[index] == run.status
    assert ensemble.steps[index] == run.steps


def assert_same(first, second):
    for name in (*SERIES, "steps", "ambiguous", "status"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_axes_of_values_and_states_are_broadcast():
    many = asp.simulate_many(
        BELT,
        **STEPS,
        q0=STATES[:, None, :],
        u0=[0.1, 0.2],
        replace={"law.reservoir.angle": ANGLES, "normal_force": np.array([[1.0], [2.0]])[:, None]},
        axes=["load", "state", "angle"],
    )
    assert many.shape == (2, 5, 4)
    assert many.q.shape == (2, 5, 4, 2)
    for index in np.ndindex(many.shape):
        law = LAW.replace(reservoir=LAW.reservoir.replace(angle=ANGLES[index[2]]))
        system = BELT.replace(law=law, normal_force=1.0 + index[0])
        run = asp.simulate(system, **STEPS, q0=STATES[index[1]], u0=[0.1, 0.2])
        assert_is(many, index, run)
    assert many.repeat((1, 4, 3)) == run
    assert many.system((1, 4, 3)) == system


def random_linear(rng):
    """A linear system of every build that the core makes variants of, and what is replaced."""
    law = asp.FrictionLaw(star_plane(rng), convex_plane(rng, deep=False))
    scale = 10.0 ** rng.uniform(-0.5, 0.5, size=3)
    kind = rng.integers(3)
    if kind == 0:
        names = {"mass": scale, "gravity": scale[::-1]}
        return asp.SlidingPoint(2.0, law=law), {
            name: names[name] for name in list(names)[: rng.integers(3)]
        }
    if kind == 1:
        belt = asp.MassOnBelt(
            1.0, stiffness=[2.0, 3.0], law=law, normal_force=2.0, belt_velocity=[1.0, 0.5]
        )
        return belt, {
            "mass": scale,
            "normal_force": scale[::-1],
            "belt_velocity[1]": scale,
            "stiffness[0, 1]": 0.1 * scale,
        }
    free = asp.Contact(law, direction=np.eye(2), normal_force=1.5, velocity=[0.1, 0.0])
    return asp.LinearSystem(1.0, stiffness=2.0, damping=0.1, contacts=[free]), {
        "mass[0, 0]": scale,
        "damping[1, 1]": scale,
        "force": np.stack([scale, -scale], axis=-1),
        "contacts[*].normal_force": scale,
        "contacts[0].velocity": np.stack([scale, scale], axis=-1),
    }


def numbers_of(law):
    """The dotted names of numbers of a law's sets."""
    return [
        f"law.{part}.{name}"
        for part in ("reservoir", "direction")
        for name, value in law._parameters[part]._parameters.items()
        if isinstance(value, float)
    ]


def test_what_the_core_makes_equals_what_python_makes():
    rng = np.random.default_rng(8)
    of_the_core = 0
    for _ in range(160):
        system, replace = random_linear(rng)
        law = system.contacts[0].law
        front = "" if hasattr(system, "law") else "contacts[0]."
        for name in numbers_of(law)[: rng.integers(3)]:
            part, argument = name.split(".")[1:]
            value = law._parameters[part]._parameters[argument]
            replace[front + name] = value * np.array([1.0, 0.95, 0.9])
        variants = Variants(system, replace)
        of_the_core += variants.of_the_core() is not None
        many = asp.simulate_many(system, dt=0.01, t_end=0.3, u0=[0.4, -0.3], replace=replace)
        for index in np.ndindex(many.shape):
            failed = [failure.error for failure in many.failures if failure.index == index]
            variant = index[0] if index else 0
            if failed:
                with pytest.raises(asp.ParameterError, match=re.escape(str(failed[0]))):
                    variants.system(variant)
            else:
                run = asp.simulate(variants.system(variant), dt=0.01, t_end=0.3, u0=[0.4, -0.3])
                assert_is(many, index, run)
    assert of_the_core > 25


@pytest.mark.parametrize("threads", [2, 3, 7])
def test_results_do_not_depend_on_threads_and_neighbours(threads):
    rng = np.random.default_rng(threads)
    states = rng.normal(size=(300, 2))
    replace = {"law.direction.b": rng.uniform(0.3, 1.0, size=300)}
    for many in (
        lambda **given: asp.simulate_many(BELT, **STEPS, until_rest=True, **given),
        lambda **given: asp.integrate_many(BELT, t_end=1.5, **given),
    ):
        alone = many(u0=states, replace=replace, threads=1)
        assert_same(alone, many(u0=states, replace=replace, threads=threads))
        order = rng.permutation(300)[:100]
        values = {"law.direction.b": replace["law.direction.b"][order]}
        part = many(u0=states[order], replace=values, threads=threads)
        np.testing.assert_array_equal(part.q, alone.q[order])
        np.testing.assert_array_equal(part.force, alone.force[order])


def test_sequences_of_systems_are_their_runs():
    systems = [BELT, POINT, asp.LinearSystem(np.eye(2), contacts=POINT.contacts)]
    many = asp.simulate_many(systems, **STEPS, u0=[1.0, 0.5])
    for index, system in enumerate(systems):
        assert_is(many, index, asp.simulate(system, **STEPS, u0=[1.0, 0.5]))
    other = asp.simulate_many([BELT, asp.LinearSystem(np.eye(2))], **STEPS)
    assert other.status.tolist() == ["finished", "failed"]
    assert "as many coordinates, velocities and contacts" in str(other.failures[0])


def bodies(height, law=LAW):
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, height), velocity=(1.0, 0.0, 0.0))
    plane = asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=law)
    return asp.RigidBodies([ball], pairs=[plane])


def test_rigid_bodies_start_in_their_own_states():
    masses = [0.5, 2.0, 8.0]
    system = bodies(0.15)
    names = {"bodies[0].mass": masses, "pairs[*].law.reservoir.a": [0.3, 0.6, 0.9]}
    many = asp.simulate_many(system, dt=1e-3, t_end=0.2, replace=names)
    for index, mass in enumerate(masses):
        law = LAW.replace(
            reservoir=LAW.reservoir.replace(a=names["pairs[*].law.reservoir.a"][index])
        )
        alone = bodies(0.15, law)
        alone = alone.replace(bodies=[alone.bodies[0].replace(mass=mass)])
        assert_is(many, index, asp.simulate(alone, dt=1e-3, t_end=0.2))
    states = np.tile(system.q0, (3, 1))
    states[:, 2] = [0.1, 0.05, 0.2]
    many = asp.simulate_many(system, dt=1e-3, t_end=0.05, q0=states)
    assert many.status.tolist() == ["finished", "failed", "finished"]
    assert "overlap" in str(many.failures[0])
    assert_is(many, 2, asp.simulate(system, dt=1e-3, t_end=0.05, q0=states[2]))
    heights = asp.simulate_many([bodies(0.1), bodies(0.3)], dt=1e-3, t_end=0.01)
    assert heights.q[:, 2].round(2).tolist() == [0.1, 0.3]


def test_samples_on_the_way_are_those_of_a_run():
    many = asp.simulate_many(BELT, dt=0.01, t_end=1.0, u0=STATES, keep=7)
    assert many.samples["q"].shape == (5, 16, 2)
    for index in range(5):
        run = asp.simulate(BELT, dt=0.01, t_end=1.0, u0=STATES[index], sample_every=0.07)
        for name in SERIES:
            np.testing.assert_array_equal(many.samples[name][index], getattr(run, name))
    ended = asp.simulate_many(
        POINT, dt=0.01, t_end=1.0, u0=[[0.1, 0.0], [9.0, 0.0]], keep=10, until_rest=True
    )
    run = ended.repeat(0)
    assert run.status is asp.Outcome.AT_REST
    assert np.isnan(ended.samples["t"][0]).sum() > 5
    assert (ended.samples["phase"][0][np.isnan(ended.samples["t"][0])] == asp.Phase.NONE).all()
    motions = asp.integrate_many(BELT, t_end=1.0, u0=STATES, keep=0.3)
    for index in range(5):
        run = asp.integrate(BELT, t_end=1.0, u0=STATES[index], sample_every=0.3)
        np.testing.assert_array_equal(motions.samples["q"][index], run.q)


def test_quantities_are_those_of_the_whole_run():
    section = asp.Section([1.0, 0.0, 0.0, 0.0], 20.0, after=2.0)
    many = asp.simulate_many(
        UNSTABLE,
        dt=0.02,
        t_end=200.0,
        u0=STATES,
        keep=["extent", "stick_share", section],
        after=9.0,
    )
    for index in range(5):
        run = many.repeat(index)
        late = run.t >= 9.0
        np.testing.assert_array_equal(many.extent[index], np.ptp(run.q[late], axis=0))
        sticks = run.phase[run.t > 9.0 + 1e-9, 0] == asp.Phase.STICK
        assert many.stick_share[index, 0] == pytest.approx(sticks.mean(), abs=1e-12)
        height = run.q[:, 0] - 20.0
        upwards = np.flatnonzero((height[:-1] <= 0.0) & (height[1:] > 0.0))
        part = height[upwards] / (height[upwards] - height[upwards + 1])
        times = run.t[upwards] + 0.02 * part
        times = times[times > 9.0]
        assert many.crossings[index] == len(times) > 2
        assert many.crossing_time[index] == pytest.approx(times[-1])
        assert many.period[index] == pytest.approx(times[-1] - times[-2], rel=1e-9)
        assert many.crossing_q[index, 0] == pytest.approx(20.0)


def test_quantities_of_both_methods_agree_with_the_limit_cycle():
    cycle = asp.limit_cycle(UNSTABLE)
    middle = 0.5 * (cycle.minimum + cycle.maximum)
    section = asp.Section([1.0, 0.0, 0.0, 0.0], middle[0])
    # Two periods are looked at, after the motion has settled.
    t_end, after = 14.0 * cycle.period, 12.0 * cycle.period
    given = {"u0": STATES[:2], "keep": ["extent", "stick_share", section], "after": after}
    exact = asp.integrate_many(UNSTABLE, t_end=t_end, **given)
    steps = asp.simulate_many(UNSTABLE, dt=2e-3, t_end=t_end, **given)
    swing, share = cycle.maximum - cycle.minimum, cycle.share(asp.Phase.STICK)
    np.testing.assert_allclose(exact.period, cycle.period, rtol=1e-6)
    np.testing.assert_allclose(exact.extent, [swing] * 2, rtol=1e-4)
    np.testing.assert_allclose(exact.stick_share, share, rtol=1e-3)
    np.testing.assert_allclose(steps.period, cycle.period, rtol=1e-3)
    np.testing.assert_allclose(steps.extent, [swing] * 2, rtol=2e-3)
    np.testing.assert_allclose(steps.stick_share, share, rtol=1e-2)
    assert (exact.crossings == 2).all()
    assert (steps.crossings == 2).all()


def test_ambiguous_steps_are_the_contact_problems_with_several_solutions():
    """A step of a unit mass and weight is a contact problem; its load is the velocity before."""
    law = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=np.pi / 4), asp.Ellipse(3.0, 1.0))
    angles = np.deg2rad(np.linspace(1.0, 59.0, 30))
    rays = law.reservoir.radius(angles)[:, None] * np.stack([np.cos(angles), np.sin(angles)], -1)
    loads = rays[:, None] * np.linspace(0.905, 1.175, 28)[:, None]
    block = asp.SlidingPoint(1.0, law=law, gravity=1.0)
    many = asp.simulate_many(block, dt=1.0, t_end=1.0, u0=loads)
    counts = np.zeros(many.shape, dtype=int)
    for index in np.ndindex(counts.shape):
        problem = asp.ContactProblem(
            np.eye(2), free_velocity=loads[index], laws=law, normal_force=1.0
        )
        counts[index] = len(problem.solutions(0))
    np.testing.assert_array_equal(many.ambiguous, counts > 1)
    assert set(counts.ravel().tolist()) == {1, 3}
    # Slip solutions meet on a caustic of the law alone.
    phi = np.linspace(0.0, np.pi, 20001)
    gamma, speed = np.stack([np.cos(phi), np.sin(phi)], axis=-1), -law.trace_criterion(phi)
    caustic = (speed[:, None] * gamma - law.force(gamma))[speed > 0.0]
    gauge, angle = law.reservoir.gauge(caustic), np.arctan2(caustic[:, 1], caustic[:, 0])
    for number, ray in enumerate(angles):
        k = np.flatnonzero(np.diff(np.sign(angle - ray)))
        part = (ray - angle[k]) / (angle[k + 1] - angle[k])
        crossed = gauge[k] + part * (gauge[k + 1] - gauge[k])
        # Where the rays meet the caustic once, the band of such loads ends on the boundary of C.
        borders = np.sort([1.0, *crossed] if len(crossed) == 1 else crossed)
        size = law.reservoir.gauge(loads[number])
        within = np.searchsorted(borders, size) % 2 == 1
        np.testing.assert_array_equal(many.ambiguous[number] > 0, within)


@pytest.mark.parametrize("many", [asp.simulate_many, asp.integrate_many])
def test_the_time_of_rest(many):
    options = {"dt": 1e-4} if many is asp.simulate_many else {}
    block = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(0.5), gravity=10.0)
    found = many(
        block,
        **options,
        t_end=0.5,
        u0=[[2.0, 0.0], [0.0, -1.0], [3.0, 0.0], [0.0, 0.0]],
        keep="rest_time",
    )
    np.testing.assert_allclose(found.rest_time, [0.4, 0.2, np.nan, 0.0], atol=2e-4)
    settled = many(block, **options, t_end=0.5, u0=[1.0, 0.0], keep="rest_time", after=0.3)
    assert settled.rest_time == 0.3


def test_a_run_that_fails_ends_alone():
    values = np.ones(20000)
    values[[77, 12345]] = [-1.0, 0.0]
    many = asp.simulate_many(BELT, dt=0.1, t_end=0.2, replace={"law.reservoir.a": values})
    assert many.failed[0].tolist() == [77, 12345]
    assert (many.status == asp.Outcome.FINISHED).sum() == 19998
    assert np.isnan(many.q[77]).all()
    assert not np.isnan(np.delete(many.q, [77, 12345], axis=0)).any()
    with pytest.raises(asp.ParameterError) as alone:
        BELT.replace(law=LAW.replace(reservoir=LAW.reservoir.replace(a=-1.0)))
    assert str(many.failures[0].error) == str(alone.value)
    with pytest.raises(asp.ParameterError, match="a: must be positive"):
        asp.simulate_many(
            BELT, dt=0.1, t_end=0.2, replace={"law.reservoir.a": values}, on_failure="raise"
        )


def test_a_run_whose_problem_is_not_solved_says_what_simulate_says():
    hopeless = asp.ProxJacobi(r=1e8, max_iterations=3)
    many = asp.simulate_many(BELT, **STEPS, u0=STATES, solver=hopeless)
    for index in range(5):
        with pytest.raises(asp.ConvergenceError) as alone:
            asp.simulate(BELT, **STEPS, u0=STATES[index], solver=hopeless)
        error = many.failures[index].error
        assert (error.step, error.residual, error.message) == (
            alone.value.step,
            alone.value.residual,
            alone.value.message,
        )
        np.testing.assert_array_equal(many.q[index], alone.value.trajectory.q[-1])
    with pytest.raises(asp.ConvergenceError) as raised:
        asp.simulate_many(BELT, **STEPS, u0=STATES, solver=hopeless, on_failure="raise")
    assert raised.value.__notes__ == ["asperity: of run (0,) of simulate_many"]


class Pendulum(asp.System):
    """A system whose forces Python computes."""

    dof = 1
    contacts = ()

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        if q[0] > 2.0:
            raise ValueError("too far")
        return -np.sin(q)


def test_systems_of_python_are_run_one_after_the_other(caplog):
    states = np.linspace(0.1, 2.5, 5)[:, None]
    with caplog.at_level(logging.INFO, logger="asperity"):
        many = asp.simulate_many(Pendulum(), **STEPS, q0=states, threads=4)
    assert "one after the other" in caplog.text
    for index in range(4):
        assert_is(many, index, asp.simulate(Pendulum(), **STEPS, q0=states[index]))
    assert isinstance(many.failures[0].error, ValueError)
    assert many.failed[0].tolist() == [4]


def test_names_that_there_are_not_are_answered_with_the_nearest():
    for name, near in (
        ("law.resevoir.angle", "'law.reservoir.angle'"),
        ("law.reservoir.angel", "'law.reservoir.angle'"),
        ("masses", "'mass'"),
        ("belt_velocity[2]", "'belt_velocity'"),
    ):
        with pytest.raises(asp.ParameterError, match=r"replace: has no part .* nearest") as error:
            asp.simulate_many(BELT, **STEPS, replace={name: [1.0, 2.0]})
        assert near in str(error.value)
    with pytest.raises(asp.ParameterError, match=r"'bodies\[\*\]\.mass'"):
        asp.simulate_many(bodies(0.2), **STEPS, replace={"bodies[3].mass": [1.0]})
    for name in ("", "law..a", "law.", "law[", 3):
        with pytest.raises(asp.ParameterError, match="replace"):
            asp.simulate_many(BELT, **STEPS, replace={name: [1.0]})


def test_what_does_not_fit_together_is_refused():
    refused = [
        ({"replace": {"law": [LAW], "law.reservoir.a": [0.3]}}, "a part of it"),
        ({"replace": {"law.reservoir.a": [0.3], "law": [LAW]}}, "a part of it"),
        ({"replace": {"mass": [1.0, 2.0], "normal_force": [1.0, 2.0, 3.0]}}, "broadcast"),
        ({"replace": {"belt_velocity": [1.0, 2.0, 3.0]}}, r"must have shape \(..., 2\)"),
        ({"replace": {"mass": ["heavy"]}}, "real numbers"),
        ({"q0": np.zeros((2, 3))}, "q0"),
        ({"q0": np.zeros((4, 2)), "u0": np.zeros((3, 2))}, "^u0: must broadcast .* q0 "),
        ({"u0": np.zeros((3, 2)), "replace": {"mass": [1.0, 2.0]}}, "^u0: .* replace "),
        ({"q0": np.zeros((3, 2)), "replace": {"mass": [1.0, 2.0]}}, "^q0: must broadcast"),
        ({"u0": np.zeros((0, 2))}, "^u0: must give a run at least"),
        ({"q0": [[np.nan, 0.0]]}, "finite"),
        ({"keep": "all"}, "keep"),
        ({"keep": 0}, "keep"),
        ({"keep": True}, "keep"),
        ({"keep": 1.5}, "integer"),
        ({"keep": asp.Section([1.0, 0.0], 0.0)}, "4 entries"),
        ({"after": -1.0}, "after"),
        ({"axes": ["a", "b"], "u0": STATES}, "axes"),
        ({"axes": "coordinate", "u0": STATES}, "axes"),
        ({"on_failure": "ignore"}, "on_failure"),
        ({"threads": 0}, "threads"),
        ({"dt": -1.0}, "dt"),
        ({"tolerance": 0.0}, "tolerance"),
    ]
    for given, words in refused:
        with pytest.raises(asp.ParameterError, match=words):
            asp.simulate_many(BELT, **{**STEPS, **given})
    with pytest.raises(asp.ParameterError, match="one system"):
        asp.simulate_many([BELT], **STEPS, replace={"mass": [1.0]})
    with pytest.raises(asp.ParameterError, match=r"^u0: must broadcast .* systems "):
        asp.simulate_many([BELT, BELT], **STEPS, u0=np.zeros((3, 2)))
    with pytest.raises(asp.ParameterError, match="systems"):
        asp.simulate_many([], **STEPS)
    with pytest.raises(asp.ParameterError, match="systems"):
        asp.simulate_many([BELT, 3.0], **STEPS)
    section = asp.Section([1.0, 0.0, 0.0, 0.0], 0.0)
    with pytest.raises(asp.ParameterError, match="not both"):
        asp.integrate_many(BELT, t_end=1.0, section=section, keep=section)


def test_cycles_are_those_of_the_search():
    speeds = UNSTABLE.belt_velocity * np.array([[1.0], [1.2]])
    many = asp.limit_cycle_many(UNSTABLE, replace={"belt_velocity": speeds})
    for index in range(2):
        cycle = asp.limit_cycle(UNSTABLE.replace(belt_velocity=speeds[index]))
        assert many.period[index] == cycle.period
        np.testing.assert_array_equal(many.minimum[index], cycle.minimum)
        assert many.stick_share[index, 0] == cycle.share(asp.Phase.STICK)
        assert many.multiplier[index] == np.abs(cycle.multipliers).max()
    assert many.cycle(1).period == many.period[1]
    calm = UNSTABLE.replace(law=asp.FrictionLaw.isotropic(0.5))
    none = asp.limit_cycle_many([calm, UNSTABLE])
    assert none.status.tolist() == ["none", "found"]
    assert isinstance(none.failures[0].error, asp.NoCycleError)
    assert np.isnan(none.period[0])
    with pytest.raises(asp.NoCycleError):
        asp.limit_cycle_many([calm], on_failure="raise")


def test_ensembles_have_tables_and_survive_pickling():
    many = asp.simulate_many(
        BELT,
        **STEPS,
        u0=STATES[:, None],
        replace={"law.reservoir.angle": ANGLES},
        axes=["state", "angle"],
        keep=50,
    )
    table = many.to_xarray()
    assert table.q.dims == ("state", "angle", "coordinate")
    assert table["law.reservoir.angle"].dims == ("angle",)
    np.testing.assert_array_equal(table["law.reservoir.angle"], ANGLES)
    assert table.sampled_q.shape == (5, 4, 4, 2)
    rows = many.to_pandas()
    assert len(rows) == 20
    np.testing.assert_array_equal(rows["law.reservoir.angle"], np.tile(ANGLES, 5))
    again = pickle.loads(pickle.dumps(many))
    assert again == many
    assert again.repeat((0, 1)) == many.repeat((0, 1))
    with pytest.raises(asp.ParameterError, match="lie within"):
        many.repeat((5, 0))
    with pytest.raises(asp.DimensionError, match="an entry per axis"):
        many.repeat(3)


INTERRUPT = """
import asperity as asp
import numpy as np
law = asp.FrictionLaw(asp.Ellipse(0.6, 0.3), asp.Ellipse(0.3, 0.6))
belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[0.1, 0.0])
states = np.random.default_rng(0).normal(size=(100000, 2))
ready = []
def report(done, whole):
    if done and not ready:
        ready.append(done)
        print("ready", flush=True)
try:
    {call}
except asp.EnsembleInterrupted as stopped:
    print("interrupted", flush=True)
    many = stopped.ensemble
    done = many.status == "finished"
    assert 0 < done.sum() < len(many)
    assert (many.status[~done] == "interrupted").all()
    first = int(np.flatnonzero(done)[0])
    {check}
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
@pytest.mark.parametrize(
    ("call", "check"),
    [
        (
            "asp.simulate_many(belt, dt=0.01, t_end=100.0, u0=states, progress=report)",
            "assert (many.repeat(first).q[-1] == many.q[first]).all()",
        ),
        (
            "asp.integrate_many(belt, t_end=10.0, u0=states, progress=report)",
            "assert many.t[first] == 10.0",
        ),
        (
            "asp.simulate_many([belt] * 2000, dt=0.01, t_end=1000.0, progress=report)",
            "assert many.t[first] == 1000.0",
        ),
    ],
    ids=["simulate", "integrate", "sequence"],
)
def test_ctrl_c_leaves_what_is_done(call, check):
    found = run_interrupted(INTERRUPT.format(call=call, check=check))
    assert found.lines == ["interrupted"]
    assert found.code == 42
    assert found.seconds < 1.0


INTERRUPT_CYCLES = """
import asperity as asp
import numpy as np
belt = asp.MassOnBelt(
    1.0,
    stiffness=1.0,
    law=asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0)),
    normal_force=1.0,
    belt_velocity=[np.cos(0.9), np.sin(0.9)],
)
speeds = belt.belt_velocity * np.linspace(0.9, 1.1, 3000)[:, None]
ready = []
def report(done, whole):
    if done and not ready:
        ready.append(done)
        print("ready", flush=True)
try:
    asp.limit_cycle_many(belt, replace={"belt_velocity": speeds}, progress=report)
except asp.EnsembleInterrupted as stopped:
    print("interrupted", flush=True)
    many = stopped.ensemble
    assert 0 < (many.status == "found").sum() < 3000
    assert set(many.status.tolist()) == {"found", "interrupted"}
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_ctrl_c_leaves_cycles_that_are_found():
    found = run_interrupted(INTERRUPT_CYCLES)
    assert found.lines == ["interrupted"]
    assert found.code == 42
    assert found.seconds < 1.0


POWERS = asp.FrictionLaw(asp.Superellipse(0.6, 0.4, 2.9), asp.Superellipse(0.5, 0.8, 1.6))


@pytest.mark.parametrize("law", [LAW, POWERS], ids=["ellipses", "superellipses"])
def test_runs_in_lanes_are_the_runs_up_to_rounding(law):
    belt = BELT.replace(law=law)
    directions = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=-1)
    given = {**STEPS, "q0": STATES, "replace": {"belt_velocity": directions[:, None]}}
    alone = asp.simulate_many(belt, **given)
    lanes = asp.simulate_many(belt, **given, lanes=True)
    assert not np.array_equal(alone.q, lanes.q)
    for name in ("q", "u", "slip", "force"):
        np.testing.assert_allclose(getattr(lanes, name), getattr(alone, name), atol=1e-10)
    for name in ("steps", "ambiguous", "status", "phase"):
        np.testing.assert_array_equal(getattr(lanes, name), getattr(alone, name))
    assert_same(lanes, asp.simulate_many(belt, **given, lanes=True, threads=2))


def test_systems_that_rest_from_the_beginning_end_at_once():
    # Stick leaves velocities of some 1e-20 m/s, which are at rest beside those that it has stopped.
    rng = np.random.default_rng(5)
    systems = []
    for _ in range(30):
        root = np.eye(2) + 0.3 * rng.normal(size=(2, 2))
        contact = asp.Contact(
            LAW, direction=np.eye(2) + 0.3 * rng.normal(size=(2, 2)), normal_force=10.0
        )
        systems.append(
            asp.LinearSystem(
                root @ root.T, stiffness=3.0 * np.eye(2), force=[0.1, 0.2], contacts=[contact]
            )
        )
    for lanes in (False, True):
        many = asp.simulate_many(
            systems, dt=1e-3, t_end=1.0, q0=[0.02, 0.03], until_rest=True, lanes=lanes
        )
        assert set(many.status.tolist()) == {"at_rest"}
        assert (many.steps == 2).all()


def test_laws_that_lanes_do_not_take_run_without_them():
    polygon = asp.Polygon([[0.6, 0.0], [0.0, 0.4], [-0.5, -0.3]])
    point = POINT.replace(law=LAW.replace(reservoir=polygon))
    here, there = (asp.simulate_many(point, **STEPS, u0=STATES, lanes=on) for on in (False, True))
    assert_same(here, there)


BOUNCING = asp.LinearSystem(
    np.eye(3),
    force=[0.0, 0.0, -9.81],
    contacts=[
        asp.Contact(LAW, direction=np.eye(3)[:, :2], normal=[0.0, 0.0, 1.0], normal_restitution=0.6)
    ],
)


@pytest.mark.parametrize(
    "normal", [[0, 0, 0, 0, 0, 1.0], [0, 0, 0, -1.0, 0, 0], [0, 0, 1.0, 0, 0, 0]]
)
def test_sections_that_impacts_jump_over_are_counted(normal):
    # Up again after every impact; slower with every impact; at the height of half a metre.
    level = {5: 0.0, 3: -0.5, 2: 0.2}[int(np.flatnonzero(normal)[0])]
    section = asp.Section(normal, level)
    many = asp.integrate_many(
        BOUNCING, t_end=3.0, q0=[0.0, 0.0, 1.0], u0=[1.0, 0.0, 0.0], keep=section
    )
    assert not many.failures
    run = asp.integrate(BOUNCING, t_end=3.0, q0=[0.0, 0.0, 1.0], u0=[1.0, 0.0, 0.0], max_step=0.01)
    height = np.concatenate([run.q, run.u], axis=1) @ np.array(normal) - level
    assert many.crossings == ((height[:-1] < 0.0) & (height[1:] >= 0.0)).sum() > 0


def test_counted_sections_change_neither_the_end_nor_the_events_that_are_allowed():
    section = asp.Section([0.0, 0.0, 0.0, 1.0], 0.0)
    counted = asp.integrate_many(UNSTABLE, t_end=120.0, u0=[0.1, 0.0], keep=section)
    alone = asp.integrate(UNSTABLE, t_end=120.0, u0=[0.1, 0.0], sample_every=1e-3)
    height = alone.u[:, 1]
    upwards = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    assert counted.status == "finished"
    assert counted.crossings == len(upwards) == 6
    assert alone.t[upwards[-1]] < counted.crossing_time <= alone.t[upwards[-1] + 1]
    np.testing.assert_allclose(counted.q, alone.q[-1], rtol=1e-7)
    few = {"u0": [0.1, 0.0], "t_end": 400.0, "max_events": 20}
    through = asp.Section([1.0, 0.0, 0.0, 0.0], 20.0)
    for keep in ("end", through):
        stopped = asp.integrate_many(UNSTABLE, keep=keep, **few)
        assert stopped.status == "failed"
        assert "max_events" in str(stopped.failures[0])


SETS = [
    asp.Disk(0.6),
    asp.Ellipse(0.51, 0.6, angle=0.3),
    asp.Superellipse(0.6, 0.5, 2.5, angle=0.2),
    asp.Rectangle(0.6, 0.5, angle=0.1),
    asp.CappedRectangle(0.7, 0.9, cap=0.2),
    asp.WedgeAsperity(0.4, beta=0.3),
    asp.Box([0.6, 0.5]),
]


@pytest.mark.parametrize("reservoir", SETS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("direction", SETS, ids=lambda one: type(one).__name__)
def test_laws_of_all_sets_are_made_to_the_bit(reservoir, direction):
    rng = np.random.default_rng(5)
    system = asp.SlidingPoint(1.0, law=asp.FrictionLaw(reservoir, direction))
    name = next(n for n, v in reservoir._parameters.items() if isinstance(v, float | np.ndarray))
    value = np.asarray(reservoir._parameters[name])
    values = value * rng.uniform(0.8, 1.2, size=(6, *(1,) * value.ndim))
    options = {"dt": 0.01, "t_end": 0.05, "u0": [0.7, -0.4]}
    many = asp.simulate_many(system, replace={f"law.reservoir.{name}": values}, **options)
    for index in range(6):
        law = system.law.replace(reservoir=reservoir.replace(**{name: values[index]}))
        assert_is(many, index, asp.simulate(system.replace(law=law), **options))


@pytest.mark.parametrize(
    ("name", "value", "made"),
    [
        ("radius", 3.0, asp.Disk),
        ("a", 3.0, lambda a: asp.Ellipse(a, 1.0)),
        ("a", 0.03, lambda a: asp.Ellipse(a, 0.01, angle=0.3)),
        ("b", 2.0, lambda b: asp.Superellipse(3.0, b, 2.5)),
        ("b", 2.0, lambda b: asp.Superellipse(3.0, b, 2.5, angle=0.2)),
        ("a", 3.0, lambda a: asp.Rectangle(a, 1.0, angle=0.1)),
        ("cap", 1.0, lambda cap: asp.CappedRectangle(3.0, 2.0, cap=cap)),
        ("upper", [0.2, 0.3], lambda upper: asp.Box(lower=[-0.1, -0.2], upper=upper)),
        ("vertices[0, 0]", 7.0, lambda x: asp.Polygon([[x, -3.0], [5.0, 6.0], [-5.0, -4.0]])),
        ("matrix[0, 1]", 0.2, lambda m: asp.sets.Mapped(asp.Disk(4.0), [[1.0, m], [0.0, 0.5]])),
        ("sets[1].a", 4.0, lambda a: asp.Disk(3.0) + asp.Ellipse(a, 1.0)),
    ],
)
def test_lengths_of_direction_sets_are_those_that_were_written(name, value, made):
    """Each makes the law that its constructor makes; the one that is there changes nothing."""
    values, sizes = np.multiply.outer([1.0, 1.1, 1.2], value), [0.6, 0.5, 0.7]

    def point(index):
        law = asp.FrictionLaw(asp.Ellipse(sizes[index], 0.3, angle=0.2), made(values[index]))
        return asp.SlidingPoint(1.0, law=law)

    names = {f"law.direction.{name}": values, "law.reservoir.a": sizes}
    options = {"dt": 0.01, "t_end": 0.4, "u0": [1.0, 0.5]}
    many = asp.simulate_many(point(0), replace=names, **options)
    for index in range(3):
        assert repr(many.system(index)) == repr(point(index))
        assert_is(many, index, asp.simulate(point(index), **options))


def tilted(normal=(0.3, 1.0, 3.0), axis=(2.0, 0.0, 1.0), frame="plane", turn=(3.0, 1.0, -1.0, 0.2)):
    ball = asp.Body.ball(1.0, radius=0.1, orientation=turn, velocity=(1.0, 0.5, 0.0))
    plane = asp.Plane(normal=normal, axis=axis)
    pair = asp.SpherePlane(0, radius=0.1, plane=plane, law=LAW, frame=frame, normal_force=5.0)
    return asp.RigidBodies([ball], pairs=[pair])


def sloping(normal):
    body, law = (
        asp.PlanarBody.disk(1.0, radius=0.1),
        asp.FrictionLaw.associated(asp.Interval(-0.3, 0.3)),
    )
    pair = asp.SpherePlane(0, radius=0.1, plane=asp.Line(normal=normal), law=law, normal_force=5.0)
    return asp.RigidBodies([body], pairs=[pair])


@pytest.mark.parametrize(
    ("name", "made"),
    [
        ("pairs[0].plane.normal[1]", lambda value: tilted(normal=(0.3, value, 3.0))),
        ("pairs[0].plane.axis[0]", lambda value: tilted(axis=(value, 0.0, 1.0))),
        ("pairs[0].frame.axis[2]", lambda value: tilted(frame=asp.BodyAxis((2.0, 0.0, value)))),
        ("bodies[0].orientation[1]", lambda value: tilted((0, 0, 3), turn=(3.0, value, 0.0, 0.2))),
        ("pairs[0].plane.normal[0]", lambda value: sloping((value, 4.0))),
    ],
)
def test_entries_of_vectors_of_any_length_are_those_that_were_written(name, made):
    """Each makes the system that its constructor makes; the one that is there changes nothing."""
    values, options = [1.0, 1.5, 2.0], {"dt": 0.01, "t_end": 0.1}
    many = asp.simulate_many(made(1.0), replace={name: values}, **options)
    for index, value in enumerate(values):
        assert repr(many.system(index)) == repr(made(value))
        assert_is(many, index, asp.simulate(made(value), **options))
    assert made(1.0) == pickle.loads(pickle.dumps(made(1.0)))
    assert np.unique(many.u, axis=0).shape == many.u.shape


def test_borders_of_what_can_be_replaced():
    rated = BELT.replace(law=LAW.replace(rate=asp.Stribeck(0.3, ratio=0.5)))
    many = asp.simulate_many(rated, **STEPS, replace={"law.rate.ratio": [0.5, 1.05]})
    assert many.status.tolist() == ["finished", "failed"]
    assert "between 0 and 1" in str(many.failures[0])
    none = asp.simulate_many(BELT, **STEPS, replace={"mass": [-1.0, -2.0]})
    assert none.status.tolist() == ["failed", "failed"]
    assert none.q.shape == (2, 2)
    two = asp.LinearSystem(
        1.0,
        contacts=[
            asp.Contact(law, direction=np.eye(2), normal_force=1.0)
            for law in (LAW, asp.FrictionLaw.isotropic(0.5))
        ],
    )
    with pytest.raises(asp.ParameterError, match="no part 'contacts"):
        asp.simulate_many(two, **STEPS, replace={"contacts[*].law.reservoir.a": [0.3, 0.6]})
    with pytest.raises(asp.ParameterError, match="a value at least"):
        asp.simulate_many(BELT, **STEPS, replace={"mass": []})
    with pytest.raises(asp.ParameterError, match="1e8 samples"):
        asp.simulate_many(BELT, dt=1e-6, t_end=100.0, keep=1, u0=np.ones((1000, 2)))
    with pytest.raises(asp.ParameterError, match="axes"):
        asp.simulate_many(BELT, **STEPS, u0=STATES, axes="status")
    ball = asp.RigidBodies([asp.Body.ball(1.0, radius=0.1), asp.Body.ball(2.0, radius=0.1)])
    moved = ball.replace(
        pairs=[
            asp.PointPlane(
                0, point=(0.0, 0.0, -0.1), plane=asp.Plane(point=(0.0, 0.0, -9.0)), law=LAW
            )
        ]
    )
    which = asp.simulate_many(moved, dt=0.01, t_end=0.02, replace={"pairs[0].body": [0, 1]})
    assert which.system(1).pairs[0].body == 1


def test_planar_bodies_start_in_their_own_state_wherever_they_stand():
    foot = asp.PointPlane(
        0, point=(0.0, -0.1), plane=asp.Line(), law=asp.FrictionLaw.isotropic(0.3, dimension=1)
    )
    body = asp.PlanarBody(1.0, inertia=0.1, position=(0.0, 0.1), velocity=(1.0, 0.0))
    planar = asp.RigidBodies([body], pairs=[foot])
    line = asp.Contact(foot.law, direction=np.eye(3)[:, :1], normal=[0.0, 1.0, 0.0])
    linear = asp.LinearSystem(np.eye(3), contacts=[line])
    many = asp.simulate_many([linear, planar], **STEPS)
    assert_is(many, 1, asp.simulate(planar, **STEPS))


def test_quantities_that_there_are_not():
    free = asp.simulate_many(asp.LinearSystem(1.0), **STEPS, u0=[[1.0], [2.0]], keep="stick_share")
    assert free.stick_share.shape == (2, 0)
    late = asp.simulate_many(POINT, **STEPS, keep=["rest_time", "extent"], after=9.0)
    assert np.isnan(late.rest_time)
    assert np.isnan(late.extent).all()
    sampled = asp.integrate_many(POINT, t_end=0.9, u0=[1.0, 0.0], keep=0.3)
    alone = asp.integrate(POINT, t_end=0.9, u0=[1.0, 0.0], sample_every=0.3)
    np.testing.assert_array_equal(sampled.samples["t"], alone.t)


def test_arrays_that_are_replaced_stay_out_of_the_columns():
    many = asp.simulate_many(
        BELT, **STEPS, u0=np.zeros((5, 1, 2)), replace={"belt_velocity": np.ones((4, 2))}
    )
    assert many.shape == (5, 4)
    assert "belt_velocity" not in many.to_xarray()
    assert len(many.to_pandas()) == 20


def test_the_first_search_without_a_cycle_is_that_of_the_smallest_number():
    calm = UNSTABLE.replace(law=asp.FrictionLaw.isotropic(0.5))
    # The second search fails at once, the first one after a while.
    with pytest.raises(asp.NoCycleError):
        asp.limit_cycle_many(calm, replace={"mass": [1.0, -1.0]}, on_failure="raise", threads=2)


MANY_BODIES = """
import asperity as asp
import numpy as np
ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1))
law = asp.FrictionLaw.isotropic(0.3)
bodies = asp.RigidBodies([ball], pairs=[asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=law)])
print("ready", flush=True)
try:
    asp.simulate_many(
        bodies, dt=1e-3, t_end=0.1, replace={"bodies[0].mass": np.linspace(1.0, 2.0, 100000)}
    )
except asp.EnsembleInterrupted as stopped:
    print("interrupted", flush=True)
    assert (stopped.ensemble.status == "interrupted").any()
    raise SystemExit(42)
"""


@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT")
def test_ctrl_c_while_python_makes_systems():
    found = run_interrupted(MANY_BODIES, after=0.05)
    assert found.lines == ["interrupted"]
    assert found.code == 42
