"""Constraints of user-defined and linear systems against simpler systems."""

import copy
import pickle

import asperity as asp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.sparse import eye_array

G, L = 9.81, 0.7
LINE = asp.FrictionLaw.isotropic(0.3, dimension=1)


class Pendulum(asp.System):
    """A point on a rod, in x and y, whose rows may be repeated; y points up."""

    dof, constant_mass = 2, True

    def __init__(self, contacts=(), *, repeats=1, scale=1.0, mass=1.3):
        self.contacts, self.constraints, self.scale, self.inertia = contacts, repeats, scale, mass

    def mass(self, q):
        return self.inertia * np.eye(2)

    def forces(self, t, q, u):
        return np.array([0.0, -self.inertia * G * self.scale])

    def constraint(self, q):
        return np.arange(1.0, self.constraints + 1.0) * (q @ q - (L * self.scale) ** 2)

    def constraint_rows(self, q):
        return np.arange(1.0, self.constraints + 1.0)[:, None] * (2.0 * q)

    def direction(self, t, q, contact):
        """Along the circle."""
        return np.array([[-q[1]], [q[0]]]) / np.hypot(*q)


def at(angle, scale=1.0):
    return scale * L * np.array([np.sin(angle), -np.cos(angle)])


def angle_of(motion):
    return np.unwrap(np.arctan2(motion.q[:, 0], -motion.q[:, 1]))


def swing(start, times):
    found = solve_ivp(
        lambda _, y: [y[1], -G / L * np.sin(y[0])],
        (0.0, times[-1]),
        [start, 0.0],
        "DOP853",
        times,
        rtol=1e-12,
        atol=1e-13,
    )
    return found.y[0]


def test_pendulum_in_x_and_y_follows_its_angle_with_second_order():
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        motion = asp.simulate(Pendulum(), dt=dt, t_end=2.0, q0=at(1.0))
        errors.append(np.abs(angle_of(motion) - swing(1.0, motion.t)).max())
        assert np.abs(np.hypot(*motion.q.T) - L).max() < 1e-14
        assert np.abs((motion.q * motion.u).sum(axis=1)).max() < 1e-11
    assert errors[-1] < 1e-5
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.02)


def test_energy_does_not_drift():
    motion = asp.simulate(Pendulum(), dt=1e-2, t_end=100.0, q0=at(2.5))
    energy = 0.5 * (motion.u**2).sum(axis=1) + G * motion.q[:, 1]
    energy -= energy[0]
    first, last = energy[: len(energy) // 4], energy[-len(energy) // 4 :]
    assert np.abs(energy).max() < 2e-2
    assert abs(last.max() - first.max()) < 2e-4
    assert abs(last.min() - first.min()) < 2e-4


@pytest.mark.parametrize(("scale", "mass"), [(1e-3, 1e-6), (1e3, 1e6)])
def test_units_and_sizes_do_not_matter(scale, mass):
    plain = asp.simulate(Pendulum(), dt=1e-3, t_end=1.0, q0=at(1.0))
    scaled = Pendulum(scale=scale, mass=mass)
    motion = asp.simulate(scaled, dt=1e-3, t_end=1.0, q0=at(1.0, scale))
    np.testing.assert_allclose(angle_of(motion), angle_of(plain), atol=1e-10)


def test_repeated_rows_change_nothing():
    once, thrice = (
        asp.simulate(Pendulum(repeats=repeats), dt=1e-3, t_end=1.0, q0=at(1.0))
        for repeats in (1, 3)
    )
    np.testing.assert_allclose(thrice.q, once.q, atol=1e-12)
    np.testing.assert_allclose(thrice.u, once.u, atol=1e-11)


class Double(asp.System):
    """Two planar bodies, x, y and angle each, on pins at the origin and between them."""

    dof, constraints = 6, 4
    places = np.array([[0.3, 0.0], [0.6, 0.2]])
    pin = np.array([0.6, 0.0])
    inertia = np.diag([1.0, 1.0, 0.02, 2.0, 2.0, 0.05])

    def mass(self, q):
        return self.inertia

    def forces(self, t, q, u):
        return self.inertia @ [0.0, -G, 0.0, 0.0, -G, 0.0]

    def arms(self, q):
        """Return the arms from the centres to the pins in the world's axes: three of two."""
        given = [-self.places[0], self.pin - self.places[0], self.pin - self.places[1]]
        turned = []
        for arm, angle in zip(given, (q[2], q[2], q[5]), strict=True):
            c, s = np.cos(angle), np.sin(angle)
            turned.append(np.array([[c, -s], [s, c]]) @ arm)
        return turned

    def constraint(self, q):
        fixed, end, other = self.arms(q)
        return np.append(q[:2] + fixed, q[3:5] + other - q[:2] - end)

    def constraint_rows(self, q):
        def across(arm):
            return np.column_stack([np.eye(2), [-arm[1], arm[0]]])

        fixed, end, other = map(across, self.arms(q))
        return np.block([[fixed, np.zeros((2, 3))], [-end, other]])


def test_double_pendulum_moves_as_rigid_bodies_with_hinges_do():
    system = Double()
    bodies = [
        asp.PlanarBody(1.0, inertia=0.02, position=system.places[0]),
        asp.PlanarBody(2.0, inertia=0.05, position=system.places[1]),
    ]
    hinges = [asp.Hinge(0, anchor=(0.0, 0.0)), asp.Hinge(1, other=0, anchor=system.pin)]
    hinged = asp.RigidBodies(bodies, joints=hinges)
    expected = asp.simulate(hinged, dt=1e-3, t_end=2.0)
    motion = asp.simulate(system, dt=1e-3, t_end=2.0, q0=hinged.q0)
    assert np.abs(motion.q[:, 2]).max() > 1.0
    np.testing.assert_allclose(motion.q, expected.q, atol=1e-9)


def test_friction_along_a_circle_stops_within_the_stick_band():
    contact = asp.ContactLaw(LINE, normal_force=6.0)
    bound, weight = 0.3 * 6.0, 1.3 * G
    for start in (2.0, 1.0, 0.4):
        system = Pendulum([contact])
        motion = asp.simulate(system, dt=1e-3, t_end=20.0, q0=at(start))
        angle = angle_of(motion)
        assert weight * abs(np.sin(angle[-1])) < bound
        assert np.abs(motion.u[-1]).max() < 1e-9
        assert abs(angle[-1] - angle[-2000]) < 1e-9
        lost = weight * (motion.q[0, 1] - motion.q[-1, 1])
        assert lost == pytest.approx(bound * L * np.abs(np.diff(angle)).sum(), rel=1e-3)
    still = asp.simulate(system, dt=1e-3, t_end=1.0, q0=at(0.1), tolerance=1e-13)
    np.testing.assert_allclose(still.q - still.q[0], 0.0, atol=1e-12)


class Rail(asp.System):
    """A point in x and y that a rail along x holds above a floor."""

    dof, constraints, constant_mass, constant_contacts = 2, 1, True, True
    contacts = (asp.ContactLaw(LINE, name="sole"),)
    slope = np.array([[0.0, 1.0]])

    def mass(self, q):
        return np.eye(2)

    def forces(self, t, q, u):
        return np.array([0.0, -G])

    def constraint(self, q):
        return self.slope @ q

    def constraint_rows(self, q):
        return self.slope

    def direction(self, t, q, contact):
        return np.array([[1.0], [0.0]])

    def normal(self, t, q, contact):
        return np.array([0.0, 1.0])

    def gap(self, t, q, contact):
        return q[1]


def test_contact_whose_normal_constraints_hold_is_refused():
    with pytest.raises(asp.ParameterError, match="constraints: must let contact 0 move along"):
        asp.simulate(Rail(), dt=1e-3, t_end=0.1)


def test_contact_on_an_inclined_rail_carries_what_is_left():
    """Forces of the floor and the weight have no part along the rail; the rail bears the rest."""

    class Wedge(Rail):
        slope = np.array([[np.sin(0.2), -np.cos(0.2)]])

    motion = asp.simulate(Wedge(), dt=1e-3, t_end=0.1)
    np.testing.assert_allclose(motion.q, 0.0, atol=1e-9)
    along = np.array([np.cos(0.2), np.sin(0.2)])
    force = motion.normal_force[1:, 0, None] * [0.0, 1.0] + motion.force[1:, 0] * [1.0, 0.0]
    np.testing.assert_allclose(force @ along, G * along[1], atol=1e-6)


def linear(law, *, constant=0.1, sliding=0.0, **changes):
    """Return three coupled masses, q₀ + 2 q₁ − q₂ = 0.1 held, and the same in q₀ and q₁."""
    random = np.random.default_rng(4)
    a = random.normal(size=(3, 3))
    mass, stiffness = a @ a.T + np.eye(3), 4.0 * np.diag([1.0, 2.0, 3.0]) + a + a.T
    damping, force = 0.1 * np.eye(3), random.normal(size=3)
    direction = random.normal(size=(3, 1))
    rows = np.array([[1.0, 2.0, -1.0]])
    basis = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]])
    offset = np.array([0.0, 0.0, -constant])

    def contact(direction):
        return asp.Contact(law, direction=direction, normal_force=6.0, velocity=[sliding])

    held = asp.LinearSystem(
        mass,
        stiffness=stiffness,
        damping=damping,
        force=force,
        contacts=contact(direction),
        constraint_rows=rows,
        constraint=[-constant],
        **changes,
    )
    free = asp.LinearSystem(
        basis.T @ mass @ basis,
        stiffness=basis.T @ stiffness @ basis,
        damping=basis.T @ damping @ basis,
        force=basis.T @ (force - stiffness @ offset),
        contacts=contact(basis.T @ direction),
    )
    return held, free, lambda q: q @ basis.T + offset, lambda u: u @ basis.T


@pytest.mark.parametrize("options", [{}, {"implicit": 0.5}, {"implicit": 0.8}])
@pytest.mark.parametrize("law", [LINE, LINE.replace(rate=asp.Stribeck(0.2, ratio=0.6))])
def test_linear_system_moves_as_with_eliminated_coordinates(law, options):
    held, free, place, speed = linear(law)
    options = {"dt": 1e-2, "t_end": 5.0, "tolerance": 1e-13, **options}
    q0, u0 = np.array([0.5, -0.4]), np.array([1.0, 0.3])
    motion = asp.simulate(held, q0=place(q0), u0=speed(u0), **options)
    expected = asp.simulate(free, q0=q0, u0=u0, **options)
    np.testing.assert_allclose(motion.q, place(expected.q), atol=1e-10)
    np.testing.assert_allclose(motion.u, speed(expected.u), atol=1e-10)
    np.testing.assert_allclose(motion.force, expected.force, atol=1e-9)
    assert {asp.Phase.SLIP, asp.Phase.STICK} <= set(motion.phase[1:].ravel())


def test_constraints_of_a_linear_system_may_repeat_each_other():
    held, _, place, speed = linear(LINE)
    rows = np.vstack([held.constraint_rows, -3.0 * held.constraint_rows])
    twice = held.replace(constraint_rows=rows, constraint=[-0.1, 0.3])
    options = {"dt": 1e-2, "t_end": 5.0, "q0": place(np.ones(2)), "u0": speed(np.ones(2))}
    one, two = asp.simulate(held, **options), asp.simulate(twice, **options)
    np.testing.assert_allclose(two.q, one.q, atol=1e-11)
    with pytest.raises(asp.ParameterError, match="q0: must be coordinates that constraint 1"):
        asp.simulate(twice.replace(constraint=[-0.1, 0.2]), **options)
    assert twice.replace(constraint_rows=None).constraints == 0
    with pytest.raises(asp.DimensionError, match="constraint_rows: must have 1 row, as constraint"):
        held.replace(constraint_rows=rows)


def test_steps_are_as_long_as_the_motion_that_is_left_allows():
    """A spring that a constraint holds does not bound the step, one across it does."""
    stiff = asp.LinearSystem(
        np.ones(2), stiffness=[1e8, 1.0], constraint_rows=[[1.0, 0.0]], constraint=[0.0]
    )
    motion = asp.simulate(stiff, dt=0.1, t_end=10.0, q0=[0.0, 1.0])
    assert np.abs(motion.q[:, 1]).max() < 1.1
    with pytest.raises(asp.ParameterError, match=r"dt: must be at most 0\.0001999"):
        asp.simulate(stiff.replace(constraint_rows=[[0.0, 1.0]]), dt=0.1, t_end=1.0)


def test_many_runs_of_a_constrained_system():
    held, _, place, speed = linear(LINE)
    u0 = speed(np.array([[1.0, 0.0], [0.0, 2.0]]))
    options = {"q0": place(np.ones(2)), "dt": 1e-2, "t_end": 1.0}
    loads = np.array([1.0, 3.0])
    many = asp.simulate_many(held, u0=u0, replace={"contacts[0].normal_force": loads}, **options)
    for i, load in enumerate(loads):
        contact = held.contacts[0].replace(normal_force=load)
        own = asp.simulate(held.replace(contacts=contact), u0=u0[i], **options)
        np.testing.assert_array_equal(many.q[i], own.q[-1])
    wrong = asp.simulate_many(held, u0=np.eye(3), **options)
    assert "must be velocities that constraint 0 lets pass" in str(wrong.failures)


class Disk(asp.System):
    """A disk in space that rolls upright along a line, or turns on a pin: quaternion and centre."""

    dof, rotations, constraints = 6, (3,), 5
    constant_mass = True
    inertia = np.diag([2.0, 2.0, 2.0, 0.02, 0.02, 0.04])
    arm = np.array([0.3, 0.0, 0.1])

    def mass(self, q):
        return self.inertia

    def turn(self, q):
        w, *v = q[3:]
        v = np.array(v)
        cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
        return np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross, cross

    def forces(self, t, q, u):
        spin = self.inertia[3:, 3:] @ u[3:]
        return np.append([0.0, 0.0, -2.0 * G], np.cross(spin, u[3:]))

    def constraint(self, q):
        """The pin stays, and so does the axis y."""
        turn, _ = self.turn(q)
        return np.append(q[:3] - turn @ self.arm, [turn[0, 1], turn[2, 1]])

    def constraint_rows(self, q):
        turn, _ = self.turn(q)
        x, y, z = self.arm
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rows = np.zeros((5, 6))
        rows[:3, :3], rows[:3, 3:] = np.eye(3), turn @ cross
        # The axis turns by R (Ω × e_y).
        across = np.column_stack([[0.0, 0.0, 1.0], np.zeros(3), [-1.0, 0.0, 0.0]])
        across = turn @ np.cross(np.eye(3), [0.0, 1.0, 0.0]).T
        rows[3:, 3:] = across[[0, 2]]
        return rows


def test_rotations_of_space_are_held_as_by_a_hinge():
    disk = Disk()
    body = asp.Body(2.0, inertia=(0.02, 0.02, 0.04), position=disk.arm)
    hinge = asp.Hinge(0, anchor=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0))
    hinged = asp.RigidBodies([body], joints=[hinge])
    motion = asp.simulate(disk, dt=1e-3, t_end=1.0, q0=hinged.q0)
    expected = asp.simulate(hinged, dt=1e-3, t_end=1.0)
    assert np.abs(motion.q[:, 0] - motion.q[0, 0]).max() > 0.5
    np.testing.assert_allclose(motion.q, expected.q, atol=1e-9)


class Scaled(Pendulum):
    """The same with velocities that are not the rates: twice those of x, and those of y."""

    rates = np.array([0.5, 1.0])

    def mass(self, q):
        return 1.3 * np.diag(self.rates**2)

    def advance(self, q, u, dt):
        return q + dt * self.rates * u

    def constraint_rows(self, q):
        return super().constraint_rows(q) * self.rates


def test_velocities_that_are_no_rates_are_held():
    plain, scaled = (
        asp.simulate(system, dt=1e-3, t_end=1.0, q0=at(1.0)) for system in (Pendulum(), Scaled())
    )
    np.testing.assert_allclose(scaled.q, plain.q, atol=1e-11)


def test_runs_are_continued_saved_and_copied(tmp_path):
    contact = asp.ContactLaw(LINE, normal_force=1.0)
    system = Pendulum([contact])
    options = {"dt": 1e-3, "q0": at(1.0)}
    whole = asp.simulate(system, t_end=0.4, **options)
    half = asp.simulate(system, t_end=0.2, **options)
    rest = asp.simulate(system, dt=1e-3, t_end=0.4, start=half)
    np.testing.assert_array_equal(rest.q[-1], whole.q[-1])
    half.save(tmp_path / "run.npz")
    np.testing.assert_array_equal(asp.Trajectory.load(tmp_path / "run.npz").q, half.q)
    weak = copy.copy(system).with_law(LINE.replace(reservoir=asp.Interval(-0.1, 0.1)))
    assert weak.constraints == 1
    assert weak.contacts[0].law != system.contacts[0].law
    assert system.labels.coordinates == ("q0", "q1")
    assert abs(asp.simulate(weak, t_end=0.4, **options).q[-1] - whole.q[-1]).max() > 1e-3

    held, _, place, speed = linear(LINE, coordinate_names=["a", "b", "c"])
    again = pickle.loads(pickle.dumps(held))
    assert again == held
    assert again.constraints == 1
    assert "constraint_rows=[[1.0, 2.0, -1.0]]" in repr(again)
    assert held.with_law(LINE).constraint_rows is not None
    assert held.labels.coordinates == ("a", "b", "c")
    run = asp.simulate(held, dt=1e-2, t_end=1.0, q0=place(np.ones(2)), u0=speed(np.ones(2)))
    run.save(tmp_path / "linear.npz")
    assert asp.Trajectory.load(tmp_path / "linear.npz").repeat() == run


def test_starts_that_constraints_do_not_allow_are_refused():
    with pytest.raises(asp.ParameterError, match="q0: must be coordinates that constraint 0 allow"):
        asp.simulate(Pendulum(), dt=1e-3, t_end=0.1, q0=at(1.0) * 1.001)
    with pytest.raises(asp.ParameterError, match="u0: must be velocities that constraint 0 lets"):
        asp.simulate(Pendulum(), dt=1e-3, t_end=0.1, q0=at(0.0), u0=[0.0, 1.0])


class Torn(Pendulum):
    """A rod whose row turns along its circle where it moves, or is another one from the start."""

    def __init__(self, wrong=None, **options):
        super().__init__(**options)
        self.wrong = wrong

    def constraint_rows(self, q):
        if self.wrong is not None:
            return super().constraint_rows(q) * self.wrong
        turn = 1e3 * (np.arctan2(q[0], -q[1]) - 1.0)
        c, s = np.cos(turn), np.sin(turn)
        return super().constraint_rows(q) @ np.array([[c, -s], [s, c]])


def test_rows_that_are_no_rates_are_told():
    with pytest.raises(asp.ParameterError, match=r"constraints are not held .* must be the rates"):
        asp.simulate(Torn(), dt=1e-2, t_end=1.0, q0=at(1.0))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("wrong", [[-1.0, 1.0], [1.0, 0.5], [0.99, 1.0], [1.0, 0.0]])
def test_rows_that_are_no_rates_from_the_start_are_refused(scale, wrong):
    """In mm, m and km, with the row and both numbers."""
    system = Torn(np.array(wrong), scale=scale, repeats=2)
    with pytest.raises(asp.ParameterError, match="must be the rates of constraint") as caught:
        asp.simulate(system, dt=1e-3, t_end=0.1, q0=at(1.0, scale))
    assert caught.value.argument == "constraint_rows"
    words = str(caught.value).split()
    k, has = (
        int(np.argmin(wrong) if wrong != [1.0, 0.5] else 1),
        float(words[words.index("has") + 1]),
    )
    true = 2.0 * at(1.0, scale)
    assert f"in row 0 for velocity {k}," in str(caught.value)
    assert has == pytest.approx(true[k] * wrong[k], rel=1e-6)
    assert float(words[-1]) == pytest.approx(true[k], rel=1e-6)


class Curve(asp.System):
    """A point in x and y on a curve of this size, which may have kinks."""

    dof, constraints, constant_mass = 2, 1, True

    def __init__(self, size, height, slope):
        self.size, self.height, self.slope = size, height, slope

    def mass(self, q):
        return np.eye(2)

    def forces(self, t, q, u):
        return np.zeros(2)

    def constraint(self, q):
        return [q[1] - self.size * self.height(q[0] / self.size)]

    def constraint_rows(self, q):
        return [[-self.slope(q[0] / self.size), 1.0]]


@pytest.mark.parametrize("size", 10.0 ** np.arange(-7.0, 5.0))
@pytest.mark.parametrize("start", [0.0, 0.3, 1.0, 2.0])
def test_rows_that_are_rates_pass_at_every_size(size, start):
    knots, heights = np.arange(-3.0, 4.0), np.array([0.0, 1.0, -1.0, 0.5, 0.2, 2.0, 0.0])
    curves = [
        (np.sin, np.cos),
        (np.cosh, np.sinh),
        (lambda x: np.interp(x, knots, heights), lambda x: np.diff(heights)[int(x // 1) + 3]),
    ]
    for height, slope in curves:
        q0 = size * np.array([start, height(start)])
        asp.simulate(Curve(size, height, slope), dt=1e-3, t_end=2e-3, q0=q0)


@pytest.mark.parametrize("repeats", [1, 2])
def test_rod_of_a_pendulum_carries_weight_and_centripetal_force(repeats):
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        system = Pendulum(repeats=repeats)
        motion = asp.simulate(system, dt=dt, t_end=1.0, q0=at(1.0))
        forces = system.constraint_forces(motion)
        assert forces.shape == (len(motion.t), repeats)
        angle = swing(1.0, np.append(0.0, motion.t[1:] - 0.5 * dt))[1:]
        tension = 1.3 * G * (3.0 * np.cos(angle) - 2.0 * np.cos(1.0))
        # The row of number k is k times 2 q.
        found = -2.0 * L * forces[1:] @ np.arange(1.0, repeats + 1.0)
        errors.append(np.abs(found - tension).max())
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.05)


def test_forces_of_constraints_and_contacts_balance():
    """On the inclined rail above the rail and the floor bear the weight; so of a linear system."""

    class Wedge(Rail):
        slope = np.array([[np.sin(0.2), -np.cos(0.2)]])

    system = Wedge()
    motion = asp.simulate(system, dt=1e-3, t_end=0.1)
    forces = system.constraint_forces(motion)
    assert np.isnan(forces[0]).all()
    floor = np.column_stack([motion.force[1:, 0, 0], motion.normal_force[1:, 0]])
    held = floor + forces[1:] @ system.slope
    np.testing.assert_allclose(held, np.broadcast_to([0.0, G], held.shape), atol=1e-6)

    held, _, place, speed = linear(LINE)
    motion = asp.simulate(held, dt=1e-3, t_end=1.0, q0=place(np.ones(2)), u0=speed(np.ones(2)))
    forces, middle = held.constraint_forces(motion), 0.5 * (motion.q[1:] + motion.q[:-1])
    pushed = held.force - middle @ held.stiffness.T - motion.u[1:] @ held.damping.T
    pushed += motion.force[1:, 0] @ held.contacts[0].direction.T + forces[1:] @ held.constraint_rows
    expected = np.diff(motion.u, axis=0) / 1e-3 @ held.mass.T
    np.testing.assert_allclose(pushed, expected, atol=2e-3 * np.abs(expected).max())


LINK = {"mass": [2.0, 1.0], "constraint_rows": [[1.0, -1.0]]}


def link(run, system):
    """What the link transmits, and the middles of the steps."""
    return system.constraint_forces(run)[1:, 0], run.t[1:] - 0.5 * run.dt


@pytest.mark.parametrize(("theta", "order"), [(0.5, 2), (1.0, 1)])
def test_forces_of_implicit_steps_converge(theta, order):
    """Two masses on a link, one on a spring and a damper: m₂ ẍ in closed form."""
    k, c, m = 300.0, 12.0, 3.0
    system = asp.LinearSystem(stiffness=np.diag([k, 0.0]), damping=np.diag([c, 0.0]), **LINK)
    fade, omega = c / (2.0 * m), np.sqrt(k / m - (c / (2.0 * m)) ** 2)
    rate = complex(-fade, omega)
    # x = Re(A e^{rt}) with x(0) = 1 and ẋ(0) = 0.
    amplitude = complex(1.0, fade / omega).conjugate()
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        run = asp.simulate(system, dt=dt, t_end=0.4, implicit=theta, q0=[1.0, 1.0])
        found, t = link(run, system)
        # J = (1, −1) pushes the second mass by −Λ.
        expected = -1.0 * (amplitude * rate**2 * np.exp(rate * t)).real
        errors.append(np.abs(found - expected).max() / np.abs(expected).max())
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < (1e-3 if order == 2 else 5e-2)
    np.testing.assert_allclose(orders, order, atol=0.1)


@pytest.mark.parametrize("theta", [0.5, 0.75, 1.0])
@pytest.mark.parametrize("stiff", [1.0, 1e6])
def test_forces_of_implicit_steps_are_their_percussions(theta, stiff):
    """M (u_E − u_B) = Δt (f − B u_θ − K q_θ + W λ + JᵀΛ), of stiff springs and contacts, too."""
    rng = np.random.default_rng(8)
    n, dt, law = 5, 1e-2, asp.FrictionLaw.isotropic(0.4)
    root = rng.normal(size=(3, n, n))
    mass, stiffness, damping = root @ root.transpose(0, 2, 1)
    rows = rng.normal(size=(2, n))
    rows = np.vstack([rows, rows[0] - rows[1]])
    tangent, normal = rng.normal(size=(2, n, 2))
    system = asp.LinearSystem(
        mass + np.eye(n),
        stiffness=stiff * stiffness,
        damping=stiff * damping,
        force=rng.normal(size=n),
        contacts=[
            asp.Contact(law, direction=tangent, normal_force=2.0),
            asp.Contact(law, direction=normal, normal=tangent[:, 0] + normal[:, 0]),
        ],
        constraint_rows=rows,
    )
    free = np.linalg.svd(rows[:2])[2][2:].T
    start = {"q0": free @ rng.normal(size=3), "u0": free @ rng.normal(size=3)}
    run = asp.simulate(system, dt=dt, t_end=0.5, implicit=theta, **start)
    forces = system.constraint_forces(run)
    assert np.isnan(forces[0]).all()
    assert ((forces[1:] == 0.0).sum(axis=1) >= 1).all()  # a row repeats the others

    def mean(values):
        return theta * values[1:] + (1.0 - theta) * values[:-1]

    pushed = system.force - mean(run.u) @ system.damping.T - mean(run.q) @ system.stiffness.T
    pushed += forces[1:] @ rows
    for number, contact in enumerate(system.contacts):
        pushed += run.force[1:, number] @ contact.direction.T
        if contact.normal is not None:
            pushed += run.normal_force[1:, [number]] * contact.normal
    change = np.diff(run.u, axis=0) @ system.mass.T / dt
    size = np.abs(mean(run.q) @ system.stiffness.T).max() + np.abs(forces[1:]).max()
    np.testing.assert_allclose(pushed, change, atol=1e-8 * size)
    fewer = asp.simulate(system, dt=dt, t_end=0.5, implicit=theta, sample_every=10 * dt, **start)
    np.testing.assert_allclose(
        system.constraint_forces(fewer)[1:], forces[10::10], atol=1e-9 * np.abs(forces[1:]).max()
    )


def test_a_step_that_ends_at_rest_wherever_it_began_has_no_known_forces():
    """With θ = ½ and Δt B = 2 M a damper ends each motion in a step."""
    system = asp.LinearSystem(damping=np.diag([30.0, 0.0]), **LINK)
    run = asp.simulate(system, dt=0.2, t_end=1.0, implicit=0.5, u0=[1.0, 1.0])
    assert np.abs(run.u[1:]).max() < 1e-15
    with pytest.raises(asp.ParameterError, match="beginnings follow from their ends"):
        system.constraint_forces(run)
    run = asp.simulate(system, dt=0.2, t_end=1.0, implicit=1.0, u0=[1.0, 1.0])
    found, _ = link(run, system)
    np.testing.assert_allclose(found, -np.diff(run.u[:, 1]) / 0.2, rtol=1e-9)


def test_forces_of_no_constraints_and_of_other_systems():
    free = asp.LinearSystem(np.ones(2))
    motion = asp.simulate(free, dt=0.1, t_end=1.0)
    assert free.constraint_forces(motion).shape == (11, 0)
    with pytest.raises(asp.DimensionError, match="trajectory: must have"):
        linear(LINE)[0].constraint_forces(motion)
    with pytest.raises(asp.ParameterError, match="trajectory: must be a Trajectory or a Motion"):
        Pendulum().constraint_forces(3)
    held = asp.LinearSystem(np.ones(2), constraint_rows=[[1.0, 0.0]])
    with pytest.raises(asp.ParameterError, match="trajectory: must be a Trajectory of simulate"):
        held.constraint_forces(asp.integrate(free, t_end=1.0))
    other = asp.simulate(held, dt=0.1, t_end=1.0, implicit=0.5)
    with pytest.raises(asp.ParameterError, match="trajectory: must be of this system"):
        Pendulum().constraint_forces(other)


def test_rows_of_a_copy_need_no_constants_where_there_were_none():
    held = asp.LinearSystem(np.ones(3), constraint_rows=[[1.0, 0.0, 0.0]])
    assert held.replace(constraint_rows=np.eye(3)[:2]).constraint.tolist() == [0.0, 0.0]
    with pytest.raises(asp.ParameterError, match="constraint_rows: must be a rectangular array"):
        held.replace(constraint_rows=[[1.0, 0.0], [1.0]])
    with pytest.raises(asp.DimensionError, match="constraint_rows: must have 1 row, as constraint"):
        held.replace(constraint=[0.5]).replace(constraint_rows=np.eye(3)[:2])


@pytest.mark.parametrize(
    ("method", "value", "message"),
    [
        ("constraint", [0.0, 0.0], r"constraint: must return shape \[1\], returned \[2\]"),
        ("constraint", [np.nan], "constraint: must return finite numbers"),
        ("constraint", None, "constraint: must return numbers, returned None"),
        ("constraint_rows", [1.0, 0.0], r"constraint_rows: must return shape \[1, 2\]"),
        ("constraint_rows", [[np.inf, 0.0]], "constraint_rows: must return finite numbers"),
    ],
)
def test_what_a_method_returns_is_checked(method, value, message):
    changed = type("Changed", (Pendulum,), {method: lambda self, q: value})
    with pytest.raises((asp.ParameterError, asp.DimensionError), match=message):
        asp.simulate(changed(), dt=1e-3, t_end=0.1, q0=at(1.0))


def test_steps_so_long_that_coordinates_grow_without_bound_are_too_long():
    """Of a method that is asked there, its numbers are not to blame."""

    class Squared(Pendulum):
        def constraint(self, q):
            assert np.isfinite(q).all()
            return [0.5 * (q @ q - 1.0)]

        def constraint_rows(self, q):
            return [q]

    for dt in (10.0, 1e3, 1e200, 1e305):
        with pytest.raises(asp.ParameterError, match=r"dt: is too long.* at t = 5") as caught:
            asp.simulate(Squared(), dt=dt, t_end=20.0 * dt, q0=[1.0, 0.0], u0=[0.0, 1.0])
        assert caught.value.argument == "dt"


def test_what_does_not_hold_constraints_refuses_them():
    held, *_ = linear(LINE)
    for system in (Pendulum(), held):
        for call in (
            lambda system=system: asp.integrate(system, t_end=1.0),
            lambda system=system: asp.equilibrium(system),
            lambda system=system: asp.stability(system),
            lambda system=system: asp.limit_cycle(system),
        ):
            with pytest.raises(asp.ParameterError, match=r"system: must have no constraints"):
                call()
    with pytest.raises(asp.ParameterError, match="system: must have no constraints"):
        asp.stability(held, near=1.0)


def test_constraints_that_are_none_are_refused():
    with pytest.raises(asp.ParameterError, match="constraint_rows: must be given with constraint"):
        asp.LinearSystem(np.ones(2), constraint=[0.0])
    with pytest.raises(asp.DimensionError, match="constraint_rows"):
        asp.LinearSystem(np.ones(2), constraint_rows=[1.0, 0.0])
    with pytest.raises(asp.DimensionError, match="constraint: "):
        asp.LinearSystem(np.ones(2), constraint_rows=[[1.0, 0.0]], constraint=[0.0, 0.0])
    with pytest.raises(asp.ParameterError, match="constraint_rows: must be left out with sparse"):
        asp.LinearSystem(eye_array(2), constraint_rows=[[1.0, 0.0]])
    blocks = type("Blocks", (Pendulum,), {"blocks": (1, 1), "block_mass": lambda self, q, block: q})
    with pytest.raises(asp.ParameterError, match="blocks: must be left out where a system has con"):
        asp.simulate(blocks(), dt=1e-3, t_end=0.1, q0=at(1.0))
    none = type("None_", (asp.System,), {"mass": Pendulum.mass, "forces": Pendulum.forces})
    none.dof, none.constraints = 2, 1
    with pytest.raises(TypeError, match=r"must define the method constraint\(self, q\)"):
        asp.simulate(none(), dt=1e-3, t_end=0.1)
    none.constraints = -1
    with pytest.raises(asp.ParameterError, match="constraints: must lie in 0"):
        asp.simulate(none(), dt=1e-3, t_end=0.1)


@pytest.mark.parametrize("method", ["constraint", "constraint_rows", "advance"])
def test_exceptions_of_methods_come_back(method):
    def failing(*_):
        raise KeyError("mine")

    class Failing(Pendulum):
        def constraint(self, q):
            return failing() if method == "constraint" else super().constraint(q)

        def constraint_rows(self, q):
            return failing() if method == "constraint_rows" else super().constraint_rows(q)

        def advance(self, q, u, dt):
            return failing() if method == "advance" else q + dt * u

    with pytest.raises(KeyError, match="mine"):
        asp.simulate(Failing(), dt=1e-3, t_end=0.1, q0=at(1.0))


def test_friction_that_wedges_a_body_between_constraints_ends_the_run():
    """As without constraints in one coordinate, where the contact problem has no solution."""
    law = asp.FrictionLaw.isotropic(0.6, dimension=1)
    given = {"gap": 0.05, "normal_restitution": 0.8}
    alone = asp.Contact(law, direction=[[1.0]], normal=[0.5], **given)
    with pytest.raises(asp.NoSolutionError):
        asp.simulate(asp.LinearSystem([[1.0]], contacts=[alone]), dt=1e-3, t_end=0.3, u0=[-1.0])
    held = asp.Contact(law, direction=[[1.0], [0.0]], normal=[0.5, 0.0], **given)
    system = asp.LinearSystem(np.eye(2), constraint_rows=[[0.0, 1.0]], contacts=[held])
    with pytest.raises(asp.ConvergenceError, match="without bound"):
        asp.simulate(system, dt=1e-3, t_end=0.3, u0=[-1.0, 0.0])


@pytest.mark.parametrize("angle", np.arange(0.0, 3.0, 0.5))
def test_a_body_that_a_stop_has_stopped_rests_without_forces(angle):
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-along[1], along[0]])
    stop = asp.Contact(
        asp.FrictionLaw.isotropic(0.3, dimension=1),
        direction=(0.2 * across + 0.7 * along)[:, None],
        normal=0.5 * across + 0.4 * along,
        gap=0.05,
    )
    system = asp.LinearSystem(np.eye(2), constraint_rows=[along], contacts=[stop])
    motion = asp.simulate(system, dt=1e-3, t_end=0.5, u0=-across)
    assert np.abs(motion.u[-1]).max() == 0.0
    assert abs(motion.q[-1] @ across + 0.1) < 1e-3
