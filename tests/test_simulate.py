"""Moreau's scheme against closed forms, invariants and SciPy's integrator."""

import asperity as asp
import numpy as np
import pytest
from asperity import Phase
from samples import SUPERELLIPSES, TILTED_ELLIPSES
from scipy.integrate import solve_ivp

ISOTROPIC = asp.FrictionLaw.isotropic(0.5)
BLOCK = asp.SlidingPoint(0.2, law=ISOTROPIC)


def test_isotropic_block_stops_at_the_known_place_and_time():
    motion = asp.simulate(BLOCK, dt=1e-4, t_end=2.0, u0=[1.5, 2.0], until_rest=True)
    distance = 2.5**2 / (2 * 0.5 * 9.81)
    np.testing.assert_allclose(motion.q[-1], distance * np.array([0.6, 0.8]), atol=1e-7)
    assert motion.t[-1] == pytest.approx(2.5 / (0.5 * 9.81), abs=3e-4)
    assert not motion.u[-1].any()


@pytest.mark.parametrize("law", [TILTED_ELLIPSES, SUPERELLIPSES])
def test_sliding_agrees_with_an_adaptive_integrator(law):
    u0 = np.array([1.0, 0.7])
    reference = solve_ivp(
        lambda t, u: 9.81 * law.force(u), (0.0, 0.1), u0, rtol=1e-11, atol=1e-12
    ).y[:, -1]
    errors = []
    for dt in (2e-4, 1e-4):
        u = asp.simulate(asp.SlidingPoint(1.0, law=law), dt=dt, t_end=0.1, u0=u0).u[-1]
        errors.append(np.linalg.norm(u - reference))
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.2)


def test_stick_is_exact():
    held = asp.LinearSystem(
        1.0,
        force=[3.0, 1.0],
        contacts=[asp.Contact(ISOTROPIC, direction=np.eye(2), normal_force=9.81)],
    )
    motion = asp.simulate(held, dt=1e-2, t_end=60.0)
    assert (motion.phase[1:] == Phase.STICK).all()
    assert np.abs(motion.q).max() < 1e-12
    np.testing.assert_allclose(motion.force[1:, 0], np.tile([-3.0, -1.0], (6000, 1)), atol=1e-11)
    assert motion.stick_fraction.tolist() == [1.0]


GIVEN = {
    "isotropic": ISOTROPIC,
    "ellipses": TILTED_ELLIPSES,
    "superellipses": SUPERELLIPSES,
    "box": asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.3)),
    "collinear": asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.2)),
    "falling": ISOTROPIC.replace(rate=asp.Stribeck(0.2, ratio=0.4)),
}


@pytest.mark.parametrize("law", GIVEN.values(), ids=GIVEN)
def test_friction_never_gives_energy(law):
    """Its power is not positive in any step, in stick or slip, beyond rounding."""
    oscillator = asp.LinearSystem(
        1.0,
        stiffness=[4.0, 1.0],
        contacts=[asp.Contact(law, direction=np.eye(2), normal_force=1.0)],
    )
    motion = asp.simulate(oscillator, dt=1e-3, t_end=20.0, q0=[3.0, -2.0])
    power = np.einsum("tcp,tcp->t", motion.force[1:], motion.slip[1:])
    assert power.max() <= 1e-12
    assert power.min() < -0.1


def test_energy_never_grows():
    oscillator = asp.LinearSystem(
        1.0,
        stiffness=[4.0, 1.0],
        contacts=[asp.Contact(TILTED_ELLIPSES, direction=np.eye(2), normal_force=1.0)],
    )
    motion = asp.simulate(oscillator, dt=1e-3, t_end=60.0, q0=[3.0, -2.0])
    energy = 0.5 * (motion.u**2).sum(1) + 0.5 * (motion.q**2 @ [4.0, 1.0])
    assert np.diff(energy).max() < 1e-4
    assert energy[-1] < 0.1 * energy[0]
    power = np.einsum("tcp,tcp->t", motion.force[1:], motion.slip[1:])
    assert power.max() <= 1e-12


@pytest.mark.parametrize(
    ("dt", "t_end", "steps"),
    [(0.1, 1.0, 10), (0.1, 0.3, 3), (0.1, 0.35, 4), (1e-3, 0.7, 700), (0.5, 0.1, 1)],
)
def test_steps_are_counted_as_integers(dt, t_end, steps):
    motion = asp.simulate(BLOCK, dt=dt, t_end=t_end)
    assert motion.steps == steps
    np.testing.assert_array_equal(motion.t, dt * np.arange(steps + 1))


def test_saving_every_so_many_steps_keeps_the_last_state():
    full = asp.simulate(BLOCK, dt=1e-3, t_end=0.1, u0=[1.0, 1.0])
    thin = asp.simulate(BLOCK, dt=1e-3, t_end=0.1, u0=[1.0, 1.0], sample_every=0.03)
    kept = [0, 30, 60, 90, 100]
    np.testing.assert_array_equal(thin.q, full.q[kept])
    np.testing.assert_array_equal(thin.phase, full.phase[kept])
    np.testing.assert_array_equal(thin.phase_counts, full.phase_counts)
    assert thin.phase_counts.sum() == thin.steps


def test_sample_zero_is_the_initial_state():
    motion = asp.simulate(BLOCK, dt=1e-3, t_end=0.01, q0=[1.0, 2.0], u0=[3.0, 4.0])
    assert motion.q[0].tolist() == [1.0, 2.0]
    assert motion.u[0].tolist() == [3.0, 4.0]
    assert np.isnan(motion.force[0]).all()
    assert motion.phase[0, 0] == Phase.NONE


def test_every_solver_gives_the_same_motion():
    system = asp.SlidingPoint(1.0, law=TILTED_ELLIPSES)
    options = {"dt": 1e-3, "t_end": 0.3, "u0": [1.0, 0.5], "tolerance": 1e-13}
    first = asp.simulate(system, **options)
    for solver in (asp.ProxJacobi(), asp.ProxGaussSeidel()):
        other = asp.simulate(system, solver=solver, **options)
        np.testing.assert_allclose(other.q, first.q, atol=1e-9)


def test_failure_keeps_the_part_before():
    weak = asp.ProxJacobi(r=1e-6, max_iterations=2)
    with pytest.raises(asp.ConvergenceError) as caught:
        asp.simulate(BLOCK, dt=1e-3, t_end=0.1, u0=[1.0, 0.0], solver=weak)
    error = caught.value
    assert error.step >= 1
    assert error.time == pytest.approx(error.step * 1e-3)
    assert error.contact == 0
    assert error.residual > 1e-10
    assert error.trajectory.steps == error.step - 1
    assert "step" in str(error)
    assert "Auto" in str(error)
    recorded = asp.simulate(
        BLOCK, dt=1e-3, t_end=0.1, u0=[1.0, 0.0], solver=weak, on_failure="record"
    )
    assert recorded.failed_steps > 0
    assert recorded.status is asp.Outcome.FINISHED
    assert recorded.steps == 100


def test_same_input_same_bits():
    runs = [
        asp.simulate(asp.SlidingPoint(1.0, law=SUPERELLIPSES), dt=1e-3, t_end=0.3, u0=[1.0, 0.5])
        for _ in range(2)
    ]
    assert runs[0] == runs[1]


def test_divergence_keeps_the_part_before():
    runaway = asp.LinearSystem(1.0, stiffness=-1e6)
    with pytest.raises(asp.DivergenceError, match="coordinate 0") as caught:
        asp.simulate(runaway, dt=1.0, t_end=1000.0, q0=[1.0])
    kept = caught.value.trajectory
    assert 0 < kept.steps < 1000
    assert np.isfinite(kept.q).all()


SPLITS = 60
SERIES = ("t", "q", "u", "slip", "force", "normal_force", "phase", "iterations", "residual")


def assert_continues(system, cut, steps, *, start=None, through=lambda run: run, **options):
    """A run of `steps` steps equals one that is ended after `cut` and continued, to the bit."""
    dt, start = options.pop("dt"), start or {}
    whole = asp.simulate(system, dt=dt, t_end=steps * dt, **start, **options)
    first = asp.simulate(system, dt=dt, t_end=cut * dt, **start, **options)
    second = asp.simulate(system, dt=dt, t_end=steps * dt, start=through(first), **options)
    assert second.t[0] == first.t[-1]
    for name in SERIES:
        expected = getattr(whole, name)[cut + 1 :]
        np.testing.assert_array_equal(getattr(second, name)[1:], expected, err_msg=name)
    assert second.end == whole.end
    np.testing.assert_array_equal(first.phase_counts + second.phase_counts, whole.phase_counts)
    return whole


def random_system(rng):
    """Up to three masses with springs, contacts of all kinds, some that depend on the speed."""
    n = int(rng.integers(1, 4))
    square = rng.normal(size=(n, n))
    contacts = []
    for _ in range(rng.integers(1, 4)):
        p = int(rng.integers(1, 3))
        law = asp.FrictionLaw.isotropic(0.5, dimension=1)
        if p == 2:
            angle = rng.uniform(0.0, 3.0)
            law = asp.FrictionLaw(asp.Ellipse(0.6, 0.3, angle=angle), asp.Ellipse(2.0, 1.0))
        if rng.random() < 0.3:
            law = law.replace(
                rate=asp.Stribeck(0.3, ratio=0.5, viscous=rng.choice([0.0, 1.0, 30.0]))
            )
        directions = rng.normal(size=(n, p))
        if rng.random() < 0.5:
            closing = {"normal_force": rng.uniform(0.5, 3.0), "velocity": rng.normal(size=p)}
        else:
            closing = {"normal": rng.normal(size=n), "gap": rng.uniform(0.0, 0.3)}
            closing["normal_restitution"] = rng.choice([0.0, 0.5])
        contacts.append(asp.Contact(law, direction=directions, **closing))
    return asp.LinearSystem(
        square @ square.T + np.eye(n),
        stiffness=np.diag(rng.uniform(0.5, 3.0, n)),
        force=3.0 * rng.normal(size=n),
        contacts=contacts,
    )


def test_a_continued_run_equals_an_unbroken_one_to_the_bit():
    rng = np.random.default_rng(0)
    ambiguous = 0
    for _ in range(SPLITS):
        system = random_system(rng)
        whole = assert_continues(
            system,
            int(rng.integers(1, 299)),
            300,
            start={"u0": rng.normal(size=system.dof)},
            dt=5e-3,
            on_failure="record",
        )
        ambiguous += whole.ambiguous_steps > 0
    # Where contacts have several solutions, the phases that are handed over decide.
    assert ambiguous >= 5


def test_a_continued_run_of_rigid_bodies_equals_an_unbroken_one_to_the_bit():
    # A box of unequal moments tumbles onto the floor; its angular momentum is kept.
    box = asp.Body(1.0, inertia=(2.5e-3, 4.2e-3, 5.0e-3), position=(0.0, 0.0, 0.3))
    floor = asp.BoxPlane(0, half_sizes=(0.1, 0.07, 0.05), plane=asp.Plane(), law=ISOTROPIC)
    system = asp.RigidBodies([box], pairs=[floor])
    start = {"u0": [1.0, 0.3, 0.0, 3.0, -5.0, 2.0]}
    for cut in (50, 250, 400):
        assert_continues(system, cut, 600, start=start, dt=2e-3)


def test_a_continued_run_keeps_its_clock_and_what_was_saved(tmp_path):
    class Driven(asp.System):
        dof = 1
        contacts = (asp.ContactLaw(asp.FrictionLaw.isotropic(0.3, dimension=1), normal_force=1.0),)

        def mass(self, q):
            return np.eye(1)

        def forces(self, t, q, u):
            return np.array([np.sin(7.0 * t)])

        def direction(self, t, q, contact):
            return np.eye(1)

    def reloaded(run):
        run.save(tmp_path / "run.npz")
        loaded = asp.Trajectory.load(tmp_path / "run.npz")
        assert loaded == run
        return loaded

    assert_continues(Driven(), 123, 300, dt=0.01, through=reloaded)
    assert_continues(Driven(), 123, 300, dt=0.01, through=lambda run: run.end)


def test_what_a_run_may_start_from():
    options = {"dt": 1e-2, "u0": [1.0, 1.0]}
    run = asp.simulate(BLOCK, t_end=0.1, **options)
    with pytest.raises(asp.ParameterError, match="start: excludes"):
        asp.simulate(BLOCK, t_end=0.2, start=run, **options)
    with pytest.raises(asp.ParameterError, match=r"t_end: .* 0\.1 s"):
        asp.simulate(BLOCK, dt=1e-2, t_end=0.1, start=run)
    with pytest.raises(asp.ParameterError, match=r"start: .*State"):
        asp.simulate(BLOCK, dt=1e-2, t_end=0.2, start=run.slice(0.0, 0.05))
    with pytest.raises(asp.ParameterError, match="start: must be"):
        asp.simulate(BLOCK, dt=1e-2, t_end=0.2, start=0.1)
    with pytest.raises(asp.ParameterError, match="q0: must have 1"):
        asp.simulate(asp.LinearSystem(1.0, stiffness=1.0), dt=1e-2, t_end=0.2, start=run)
    assert run.slice(0.05, 0.1).end == run.end
    # Another step: the clock goes on from where it stood. A fresh start at a time is a State, too.
    finer = asp.simulate(BLOCK, dt=3e-3, t_end=0.2, start=run)
    np.testing.assert_allclose(finer.t, 0.1 + 3e-3 * np.arange(35))
    fresh = asp.State(run.q[-1], run.u[-1], t0=run.t[-1])
    assert asp.simulate(BLOCK, dt=1e-2, t_end=0.2, start=fresh).t[-1] == pytest.approx(0.2)


def test_times_may_be_negative_but_must_be_told_apart():
    early = asp.State([0.0, 0.0], [1.0, 1.0], t0=-5.0)
    for t_end in (-4.0, 0.0, 1.0):
        run = asp.simulate(BLOCK, dt=1e-2, t_end=t_end, start=early)
        np.testing.assert_allclose(run.t[[0, -1]], [-5.0, t_end], atol=1e-12)
        assert run.steps == round(100.0 * (t_end + 5.0))
    for t_end in (-5.0, -6.0):
        with pytest.raises(asp.ParameterError, match=r"t_end: must lie after .* -5 s"):
            asp.simulate(BLOCK, dt=1e-2, t_end=t_end, start=early)
    with pytest.raises(asp.ParameterError, match="t_end: must be positive"):
        asp.simulate(BLOCK, dt=1e-2, t_end=-1.0)
    # Beyond 1e14 s numbers are farther apart than such steps.
    late = early.replace(t0=1e17)
    with pytest.raises(asp.ParameterError, match=r"dt: must be at least 32 s, .* t = 1e\+17 s"):
        asp.simulate(BLOCK, dt=1e-2, t_end=1e17 + 100.0, start=late)
    assert (np.diff(asp.simulate(BLOCK, dt=32.0, t_end=1e17 + 320.0, start=late).t) > 0.0).all()


def test_the_last_step_is_kept_however_a_run_ends():
    # The block slips along, then sticks, which two iterations do not find.
    weak = asp.ProxJacobi(r=1e-6, max_iterations=2)
    with pytest.raises(asp.ConvergenceError) as caught:
        asp.simulate(BLOCK, dt=1e-3, t_end=1.0, u0=[1.0, 0.0], solver=weak, sample_every=1e3)
    part = caught.value.trajectory
    assert part.steps == caught.value.step - 1
    assert part.t.tolist() == [0.0, 1e-3 * part.steps][: 1 + (part.steps > 0)]
    np.testing.assert_array_equal(part.q[-1], part.end.q)
    assert asp.simulate(BLOCK, dt=1e-3, t_end=1.0, start=part).steps == 1000 - part.steps

    class Stops(asp.System):
        dof = 1

        def mass(self, q):
            return np.eye(1)

        def forces(self, t, q, u):
            if t > 0.05:
                raise RuntimeError("enough")
            return np.ones(1)

    with pytest.raises(RuntimeError, match="enough") as caught:
        asp.simulate(Stops(), dt=1e-3, t_end=1.0, sample_every=1.0)
    part = caught.value.trajectory
    assert part.steps == 50
    assert part.t.tolist() == [0.0, 0.05]
    assert part.end.t == 0.05


ISO = asp.FrictionLaw.isotropic(0.3)


def test_directions_must_move_something():
    silent = asp.LinearSystem(
        np.eye(2), contacts=[asp.Contact(ISO, direction=np.zeros((2, 2)), normal_force=1.0)]
    )
    with pytest.raises(asp.ParameterError, match="direction"):
        asp.simulate(silent, dt=0.1, t_end=1.0)


def test_exceptions_of_the_user_keep_the_part_before():
    class Fragile(asp.System):
        dof = 1

        def mass(self, q):
            return np.eye(1)

        def forces(self, t, q, u):
            if t > 0.5:
                raise LookupError("no data")
            return np.zeros(1)

    with pytest.raises(LookupError) as caught:
        asp.simulate(Fragile(), dt=0.1, t_end=1.0, u0=[1.0])
    assert caught.value.trajectory.steps == 5
