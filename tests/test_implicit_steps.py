"""Time stepping with implicit stiffness and damping: orders, energies, agreement of both ways."""

import asperity as asp
import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from brake_pads import pad_system

LAW = asp.FrictionLaw(reservoir=asp.Ellipse(0.5, 0.3), direction=asp.Disk(1.0))


class Falling(asp.System):
    dof = 1

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return np.array([-9.81])


def sparse(system):
    """Return the same system with sparse matrices."""
    return asp.LinearSystem(**{**system._parameters, "mass": sp.csc_array(system.mass)})


def chain(n, seed=0):
    """Return M, K of a chain of unequal parts that is held at one end."""
    rng = np.random.default_rng(seed)
    D = np.eye(n) - np.eye(n, k=-1)
    return np.diag(rng.uniform(0.5, 2.0, n)), D.T @ np.diag(rng.uniform(50.0, 200.0, n)) @ D


def two_contacts(law, restitution=0.0):
    """Return a system with a contact that opens and closes and one of prescribed load."""
    M, K = chain(4)
    unit = np.eye(4)
    touching = asp.Contact(
        law,
        direction=unit[1],
        normal=unit[0],
        gap=0.01,
        velocity=[-0.4],
        normal_restitution=restitution,
    )
    loaded = asp.Contact(law, direction=unit[3] + 0.3 * unit[2], normal_force=3.0, velocity=[0.5])
    return asp.LinearSystem(
        M, stiffness=K, damping=0.01 * K, force=[-3.0, 0.0, 1.0, 0.5], contacts=[touching, loaded]
    )


@pytest.mark.parametrize("theta", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("restitution", [0.0, 0.6])
@pytest.mark.parametrize(
    "rate", [None, asp.Stribeck(0.5, ratio=0.2), asp.Stribeck(0.5, viscous=0.4)], ids=str
)
def test_sparse_systems_take_the_steps_of_dense_ones(theta, restitution, rate):
    law = asp.FrictionLaw.isotropic(0.4, dimension=1).replace(rate=rate)
    system = two_contacts(law, restitution)
    options = {"dt": 0.02, "t_end": 4.0, "implicit": theta, "u0": [0.0, 1.0, -1.0, 2.0]}
    dense, other = (asp.simulate(one, **options) for one in (system, sparse(system)))
    assert set(dense.phase[1:].ravel()) >= {0, 2}
    np.testing.assert_array_equal(other.phase, dense.phase)
    for name in ("q", "u", "slip", "force", "normal_force"):
        expected = getattr(dense, name)
        size = np.nanmax(np.abs(expected))
        np.testing.assert_allclose(getattr(other, name), expected, rtol=0, atol=1e-11 * size)


@pytest.mark.parametrize("theta", [0.5, 0.7, 1.0])
def test_steps_are_those_of_the_scheme(theta):
    """The residual of the θ scheme in its own words."""
    system = two_contacts(asp.FrictionLaw.isotropic(0.4, dimension=1))
    dt = 0.02
    run = asp.simulate(system, dt=dt, t_end=4.0, implicit=theta, u0=[0.0, 1.0, -1.0, 2.0])

    def mean(x):
        return theta * x[1:] + (1.0 - theta) * x[:-1]

    np.testing.assert_allclose(np.diff(run.q, axis=0), dt * mean(run.u), rtol=0, atol=1e-14)
    touching, loaded = system.contacts
    pushed = run.normal_force[1:, :1] * touching.normal
    pushed = pushed + run.force[1:, 0] * touching.direction.T
    pushed = pushed + run.force[1:, 1] * loaded.direction.T
    forces = system.force - mean(run.u) @ system.damping.T - mean(run.q) @ system.stiffness.T
    change = np.diff(run.u, axis=0) @ system.mass.T
    np.testing.assert_allclose(change, dt * (forces + pushed), rtol=0, atol=1e-12)


@pytest.mark.parametrize("make", [lambda system: system, sparse])
@pytest.mark.parametrize("dt", [0.01, 1.0, 30.0])
def test_free_vibrations_keep_their_energy(make, dt):
    M, K = chain(5)
    system = make(asp.LinearSystem(M, stiffness=K))
    q0 = np.arange(5.0)
    energies = {}
    for theta in (0.5, 0.6):
        run = asp.simulate(system, dt=dt, t_end=300 * dt, q0=q0, implicit=theta)
        kinetic, potential = (
            np.einsum("ti,ij,tj->t", part, matrix, part)
            for part, matrix in ((run.u, M), (run.q, K))
        )
        energies[theta] = (kinetic + potential) / (q0 @ K @ q0)
    np.testing.assert_allclose(energies[0.5], 1.0, rtol=1e-10)
    assert energies[0.6][-1] < 0.9


def test_sliding_along_a_line_is_of_second_order():
    """A contact that stays closed with a load that varies, and one of prescribed load."""
    M, K = chain(4)
    unit = np.eye(4)
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    contacts = [
        asp.Contact(law, direction=unit[1], normal=unit[0], velocity=[-5.0]),
        asp.Contact(law, direction=unit[3], normal_force=2.0, velocity=[-5.0]),
    ]
    coupled = K + 20.0 * np.outer(unit[0] + unit[1], unit[0] + unit[1])
    system = asp.LinearSystem(
        M, stiffness=coupled, damping=0.02 * K, force=-40.0 * unit[0], contacts=contacts
    )
    start = {"q0": [0.0, 0.1, 0.05, -0.1], "u0": [0.0, 0.5, -0.3, 0.2], "t_end": 1.0}
    exact = asp.integrate(system, tolerance=1e-12, **start)
    assert set(exact.phase.ravel()) == {2}
    errors = {}
    for theta in (0.5, 1.0):
        for make in (lambda one: one, sparse):
            runs = [
                asp.simulate(make(system), dt=dt, implicit=theta, **start)
                for dt in (0.01, 0.005, 0.0025)
            ]
            errors[theta] = [np.abs(run.u[-1] - exact.u[-1]).max() for run in runs]
            order = np.log2(np.array(errors[theta][:-1]) / errors[theta][1:])
            expected, room = (2.0, 0.15) if theta == 0.5 else (1.0, 0.3)
            np.testing.assert_allclose(order, expected, atol=room)
    assert errors[0.5][-1] < 0.02 * errors[1.0][-1]


def test_stick_is_exact_and_ends_when_the_force_suffices():
    law = asp.FrictionLaw.isotropic(0.5, dimension=1)
    spring = [asp.Contact(law, direction=[0.0, 1.0], normal_force=10.0)]
    K = 1e4 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    for force, moves in ((4.999, False), (5.001, True)):
        system = asp.LinearSystem([0.01, 1.0], stiffness=K, force=[force, 0.0], contacts=spring)
        # The spring is at its load: nothing vibrates.
        options = {"dt": 0.05, "t_end": 5.0, "q0": [force / 1e4, 0.0], "implicit": 0.5}
        for one in (system, sparse(system)):
            run = asp.simulate(one, **options)
            assert (run.phase[1:] == 2).any() == moves
            assert moves or np.abs(run.u[:, 1]).max() <= 1e-15


@pytest.mark.parametrize("disc", [False, True])
def test_long_steps_lead_to_steady_sliding(disc):
    """Steps 150 times as long as the longest explicit one."""
    system = pad_system((3, 2, 1), LAW, phi=0.4, disc=disc)
    with pytest.raises(asp.ParameterError, match="dt: must be at most"):
        asp.simulate(system.dense(), dt=1e-3, t_end=0.1)
    steady = asp.equilibrium(system)
    run = asp.simulate(system, dt=1e-3, t_end=0.6, implicit=1.0, sample_every=0.2)
    # Where contacts have closed within a step, what they have gone too deep is left: 1e-8 of q.
    size = np.abs(steady.q).max()
    np.testing.assert_allclose(run.q[-1], steady.q, rtol=0, atol=1e-7 * size)
    for name in ("normal_force", "force"):
        expected = getattr(steady, name)
        np.testing.assert_allclose(
            getattr(run, name)[-1], expected, rtol=0, atol=1e-7 * np.abs(expected).max()
        )


def test_a_limit_cycle_is_that_of_the_events():
    law = asp.FrictionLaw.isotropic(0.5, dimension=1).replace(rate=asp.Stribeck(0.5, ratio=0.5))
    belt = asp.Contact(law, direction=[1.0], normal_force=10.0, velocity=[-0.3])
    system = asp.LinearSystem(1.0, stiffness=[30.0], contacts=[belt])
    events = asp.integrate(system, t_end=10.0, sample_every=0.01)
    assert set(events.phase.ravel()) >= {1, 2}
    for one in (system, sparse(system)):
        errors = []
        for dt in (1e-3, 2.5e-4):
            run = asp.simulate(one, dt=dt, t_end=10.0, implicit=0.5, sample_every=0.01)
            expected = np.interp(run.t, events.t, events.q[:, 0])
            errors.append(np.abs(run.q[:, 0] - expected).max() / np.abs(expected).max())
        # Changes between stick and slip are resolved to one step.
        assert errors[1] <= 0.3 * errors[0] <= 0.01


def test_massless_coordinates_are_condensed():
    """A chain without mass at every second node moves as the one of which they are eliminated."""
    M, K = chain(6)
    massless = np.arange(6) % 2 == 1
    M[massless, massless] = 0.0
    a, b = np.flatnonzero(~massless), np.flatnonzero(massless)
    condensed = K[np.ix_(a, a)] - K[np.ix_(a, b)] @ np.linalg.solve(
        K[np.ix_(b, b)], K[np.ix_(b, a)]
    )
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    contacts = [asp.Contact(law, direction=np.eye(6)[0], normal_force=2.0, velocity=[-1.0])]
    whole = asp.LinearSystem(sp.csc_array(M), stiffness=K, contacts=contacts)
    with pytest.raises(asp.ParameterError, match="mass"):
        whole.dense()
    part = asp.LinearSystem(
        M[np.ix_(a, a)],
        stiffness=condensed,
        contacts=[contacts[0].replace(direction=np.eye(3)[0])],
    )
    options = {"dt": 0.01, "t_end": 3.0, "implicit": 0.6}
    full, few = (asp.simulate(one, **options) for one in (whole, part))
    np.testing.assert_allclose(full.q[:, a], few.q, atol=1e-12)
    np.testing.assert_array_equal(full.phase, few.phase)


def test_runs_go_on_are_thinned_repeated_and_stored(tmp_path):
    law = asp.FrictionLaw.isotropic(0.4, dimension=1)
    for system in (two_contacts(law), sparse(two_contacts(law))):
        options = {"dt": 0.02, "implicit": 0.7}
        whole = asp.simulate(system, t_end=2.0, u0=[0.0, 1.0, -1.0, 2.0], **options)
        part = asp.simulate(
            system, t_end=1.0, u0=[0.0, 1.0, -1.0, 2.0], sample_every=0.3, **options
        )
        np.testing.assert_array_equal(part.u, whole.u[[0, 15, 30, 45, 50]])
        np.testing.assert_array_equal(part.q, whole.q[[0, 15, 30, 45, 50]])
        rest = asp.simulate(system, t_end=2.0, start=part, **options)
        np.testing.assert_allclose(rest.q[-1], whole.q[-1], atol=1e-13)
        assert part.repeat() == part
        assert part.options.implicit == 0.7
    with pytest.warns(UserWarning, match="without its system"):
        part.save(tmp_path / "run.npz")
    assert asp.Trajectory.load(tmp_path / "run.npz") == part


def test_what_is_no_such_run_is_refused_by_name():
    M, K = chain(3)
    system, belt = asp.LinearSystem(M, stiffness=K), sp.csc_array(M)
    unit = np.eye(3)
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    twice = [asp.Contact(law, direction=unit[0], normal_force=1.0)] * 2
    options = {"dt": 0.1, "t_end": 1.0}
    for given, argument, message in (
        ((system, {"implicit": 0.4}), "implicit", "0.5 to 1"),
        ((system, {"implicit": np.nan}), "implicit", "finite"),
        ((sparse(system), {}), "system", "implicit="),
        ((sparse(system), {"implicit": 0.5, "until_rest": True}), "until_rest", "sparse"),
        ((asp.LinearSystem(belt, contacts=twice), {"implicit": 0.5}), "system", "dependent"),
        ((asp.LinearSystem(M, stiffness=-1e3 * K), {"implicit": 0.5}), "dt", "positive definite"),
        ((asp.LinearSystem(belt, stiffness=-1e3 * K), {"implicit": 0.5}), "dt", "positive"),
        ((asp.LinearSystem(sp.csc_array((3, 3))), {"implicit": 0.5}), "dt", "neither mass"),
        ((Falling(), {"implicit": 0.5}), "implicit", "matrices, got Falling"),
    ):
        with pytest.raises(asp.ParameterError, match=message) as refused:
            asp.simulate(given[0], **options, **given[1])
        assert refused.value.argument == argument


def test_unsymmetric_stiffness_acts_at_the_midpoint():
    """Follower forces: the skew part is explicit, and of second order all the same."""
    M, K = chain(3)
    K = K + np.array([[0.0, 9.0, 0.0], [-9.0, 0.0, 4.0], [0.0, -4.0, 0.0]])
    exact = scipy.linalg.expm(
        np.block([[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(M, K), np.zeros((3, 3))]])
    )
    q0 = np.array([0.1, 0.0, -0.2])
    end = exact @ np.concatenate([q0, np.zeros(3)])
    system = asp.LinearSystem(M, stiffness=K)
    errors = []
    for dt in (0.01, 0.005):
        runs = [
            asp.simulate(one, dt=dt, t_end=1.0, q0=q0, implicit=0.5)
            for one in (system, sparse(system))
        ]
        np.testing.assert_allclose(runs[0].q, runs[1].q, atol=1e-13)
        errors.append(np.abs(runs[0].q[-1] - end[:3]).max())
    assert 3.5 < errors[0] / errors[1] < 4.5
