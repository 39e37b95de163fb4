"""Cases that once went wrong: each is the smallest one that shows the fault."""

import asperity as asp
import numpy as np
import pytest

ISO = asp.FrictionLaw.isotropic(0.3)


def test_light_contact_does_not_hide_the_defect_of_heavy_ones():
    light, heavy = 1e6, 1e-6
    pair = heavy * np.array([[1.0, 0.9], [0.9, 1.0]])
    delassus = np.zeros((6, 6))
    delassus[np.ix_([0, 2], [0, 2])] = pair
    delassus[np.ix_([1, 3], [1, 3])] = pair
    delassus[4, 4] = delassus[5, 5] = light
    free = [1.0, 0.2, 0.5, -0.3, 1.0, 0.5]
    normal = [10 * light, 10 * light, 10 * heavy]
    alone = asp.ContactProblem(delassus[:4, :4], free[:4], ISO, normal_force=normal[:2]).solve()
    problem = asp.ContactProblem(delassus, free, ISO, normal_force=normal)
    for solver in (asp.Exact(), asp.ProxGaussSeidel(), asp.ProxJacobi()):
        together = problem.solve(solver)
        np.testing.assert_allclose(together.percussion[:4], alone.percussion, rtol=1e-7)


@pytest.mark.parametrize("dimension", [1, 2])
def test_singular_block_sticks(dimension):
    law = asp.FrictionLaw.isotropic(0.3, dimension=dimension)
    rows = dimension + 1
    problem = asp.ContactProblem(np.ones((rows, rows)) + 0.0, -np.ones(rows), law)
    for solution in problem.solutions(0):
        assert problem.residual(solution.percussion) < 1e-12
    assert problem.solve().converged


def test_continuum_of_stick_is_ambiguous():
    problem = asp.ContactProblem(np.ones((2, 2)), [-0.1, -0.1], ISO, normal_force=1.0)
    assert problem.solve().ambiguous
    assert [one.degenerate for one in problem.solutions(0)] == [True]


def table(height=-0.3, half=0.5):
    """A rigid table on four feet: horizontal motion, height and two tilts; unit mass."""
    contacts = []
    for x, y in [(half, half), (-half, half), (-half, -half), (half, -half)]:
        normal = [0.0, 0.0, 1.0, y, -x]
        direction = np.array([[1, 0], [0, 1], [0, 0], [0, -height], [height, 0]], dtype=float)
        contacts.append(asp.Contact(ISO, direction, normal=normal))
    mass = np.diag([1.0, 1.0, 1.0, 0.1, 0.1])
    return asp.LinearSystem(mass, force=[0.0, 0.0, -9.81, 0.0, 0.0], contacts=contacts)


@pytest.mark.parametrize("dt", [1e-2, 1e-3])
def test_resting_contacts_do_not_open_by_rounding(dt):
    motion = asp.simulate(table(), dt=dt, t_end=1.0, u0=[1.0, 0.3, 0.0, 0.0, 0.0])
    assert motion.phase_counts[:, asp.Phase.OPEN].tolist() == [0, 0, 0, 0]
    assert np.abs(motion.q[:, 2]).max() < 1e-10
    distance = np.hypot(1.0, 0.3) ** 2 / (2 * 0.3 * 9.81)
    assert np.hypot(*motion.q[-1, :2]) == pytest.approx(distance, abs=2 * dt)


def test_lifted_contact_opens():
    lift = asp.LinearSystem(
        np.eye(3),
        force=[0.0, 0.0, 1.0],
        contacts=[asp.Contact(ISO, np.eye(3)[:, :2], normal=[0.0, 0.0, 1.0])],
    )
    motion = asp.simulate(lift, dt=1e-3, t_end=0.1)
    assert motion.phase[-1, 0] == asp.Phase.OPEN
    assert motion.q[-1, 2] == pytest.approx(0.5 * 0.1**2, rel=1e-2)


@pytest.mark.parametrize(("dt", "error"), [(1e-3, 2e-2), (1e-4, 2e-3)])
def test_bouncing_point_comes_to_rest(dt, error):
    # It rests at t₁ (1 + e)/(1 − e) after a first impact at t₁ = √(2h/g).
    height, e = 0.9, 0.5
    ball = asp.LinearSystem(
        np.eye(2),
        force=[0.0, -9.81],
        contacts=[
            asp.Contact(
                asp.FrictionLaw.isotropic(0.3, dimension=1),
                [1.0, 0.0],
                normal=[0.0, 1.0],
                normal_restitution=e,
            )
        ],
    )
    motion = asp.simulate(ball, dt=dt, t_end=2.0, q0=[0.0, height])
    first = np.sqrt(2 * height / 9.81)
    closed = np.flatnonzero(motion.phase[:, 0] > asp.Phase.OPEN)
    assert motion.t[closed[0]] == pytest.approx(first, abs=2 * dt)
    moving = np.flatnonzero(np.abs(motion.u[:, 1]) > 2e-3)
    assert motion.t[moving[-1]] == pytest.approx(first * (1 + e) / (1 - e), abs=error)


def test_direction_that_is_the_reservoir_scaled_is_the_associated_law():
    reservoir = asp.Ellipse(3.0, 1.0, angle=0.5)
    law = asp.FrictionLaw(reservoir, asp.Ellipse(6.0, 2.0, angle=0.5))
    assert law.direction == reservoir
    assert law == asp.FrictionLaw.associated(reservoir)


def test_alpha_min_of_thin_sets():
    law = asp.FrictionLaw(asp.Ellipse(1e6, 1.0, angle=0.7), asp.Superellipse(1.0, 0.3, 7.0))
    # Along the long axis of C: r_C = 1e6.
    expected = law.direction.radius(0.7) / 1e6
    assert law.alpha_min == pytest.approx(expected, rel=1e-6)


def test_tiny_slips_have_forces():
    assert ISO.force([1e-200, 0.0]).tolist() == [-0.3, 0.0]
    with pytest.raises(asp.ParameterError, match="normal_force"):
        ISO.slip_direction([0.1, 0.0], 0.0)
    # The force jumps where D is flat.
    rectangle = asp.FrictionLaw.associated(asp.Rectangle(1.0, 0.5))
    assert rectangle.jacobian([1.0, 0.0]).tolist() == [[0.0, 0.0], [0.0, -np.inf]]


def test_directions_must_move_something():
    silent = asp.LinearSystem(
        np.eye(2), contacts=[asp.Contact(ISO, np.zeros((2, 2)), normal_force=1.0)]
    )
    with pytest.raises(asp.ParameterError, match="direction"):
        asp.simulate(silent, dt=0.1, t_end=1.0)


def test_numbers_beyond_all_reason_are_named():
    problem = asp.ContactProblem(np.eye(2), [0.1, 0.0], ISO, normal_force=1.0)
    assert problem.solve(time_limit=1e30).converged
    with pytest.raises(asp.ParameterError, match="max_sweeps"):
        asp.Exact(max_sweeps=2**70)
    block = asp.SlidingPoint(1.0, ISO)
    with pytest.raises(asp.ParameterError, match="save_every"):
        asp.simulate(block, dt=0.1, t_end=1.0, save_every=2**70)
    with pytest.raises(asp.ParameterError, match="dt"):
        asp.simulate(block, dt=1e-300, t_end=1.0)


def test_thin_reservoirs_say_that_rounding_limits_them():
    law = asp.FrictionLaw.associated(asp.Ellipse(1.0, 1e-8, angle=0.3))
    rng = np.random.default_rng(1)
    for _ in range(200):
        problem = asp.ContactProblem(np.eye(2), rng.normal(size=2), law, normal_force=1.0)
        solution = problem.solve(on_failure="record")
        assert solution.status in (asp.Status.CONVERGED, asp.Status.INEXACT)
        assert solution.residual < 1e-7


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
