"""Many runs in one call are the runs, one by one."""

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


@pytest.mark.parametrize(
    ("system", "name"), [(POINT, "law"), (BELT, "law"), (BELT.linear, "contacts[0].law")]
)
def test_the_core_itself_puts_laws_into_linear_systems(system, name):
    rng = np.random.default_rng(2)
    laws = [LAW, *(asp.FrictionLaw(star_plane(rng), convex_plane(rng)) for _ in range(6))]
    laws.append(LAW.replace(rate=asp.Stribeck(0.1, ratio=0.6)))
    other = {"gravity": [[4.0], [9.81]]} if system is POINT else {}
    variants = Variants(system, {name: laws, **other})
    assert variants.of_the_core() is not None
    many = asp.simulate_many(system, **STEPS, u0=[0.4, -0.3], replace={name: laws, **other})
    for number, index in enumerate(np.ndindex(many.shape)):
        found = variants.system(number)
        assert getattr(found, "linear", found).contacts[0].law == laws[index[-1]]
        assert_is(many, index, asp.simulate(found, **STEPS, u0=[0.4, -0.3]))
    # What a system does not take, it refuses in its own words.
    for odd, words in ((asp.FrictionLaw.isotropic(0.3, dimension=1), "must"), (POINT, "law")):
        (failure,) = asp.simulate_many(
            system, **STEPS, u0=[0.4, -0.3], replace={name: [LAW, odd]}
        ).failures
        assert failure.index == (1,)
        assert words in str(failure.error)


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


def bodies(height, law=LAW):
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, height), velocity=(1.0, 0.0, 0.0))
    plane = asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=law)
    return asp.RigidBodies([ball], pairs=[plane])


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
except asp.errors.EnsembleInterrupted as stopped:
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
        pytest.param(
            "asp.integrate_many(belt, t_end=10.0, u0=states, progress=report)",
            "assert many.t[first] == 10.0",
            marks=pytest.mark.long,
        ),
        pytest.param(
            "asp.simulate_many([belt] * 2000, dt=0.01, t_end=1000.0, progress=report)",
            "assert many.t[first] == 1000.0",
            marks=pytest.mark.long,
        ),
    ],
    ids=["simulate", "integrate", "sequence"],
)
def test_ctrl_c_leaves_what_is_done(call, check):
    found = run_interrupted(INTERRUPT.format(call=call, check=check))
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


def test_quantities_that_there_are_not():
    free = asp.simulate_many(asp.LinearSystem(1.0), **STEPS, u0=[[1.0], [2.0]], keep="stick_share")
    assert free.stick_share.shape == (2, 0)
    late = asp.simulate_many(POINT, **STEPS, keep=["rest_time", "extent"], after=9.0)
    assert np.isnan(late.rest_time)
    assert np.isnan(late.extent).all()
    sampled = asp.integrate_many(POINT, t_end=0.9, u0=[1.0, 0.0], keep=0.3)
    alone = asp.integrate(POINT, t_end=0.9, u0=[1.0, 0.0], sample_every=0.3)
    np.testing.assert_array_equal(sampled.samples["t"], alone.t)
