"""Why steady sliding is unstable, with unilateral contacts, own systems and rigid bodies."""

import math

import asperity as asp
import numpy as np
import pytest

LINE = asp.FrictionLaw.isotropic(1.0, dimension=1)


def on_belt(mu, mass, stiffness, damping=None, force=(0.0, -1.0)):
    """Two coordinates, x along a belt that moves to +x below and z, pressed to z = 0."""
    law = asp.FrictionLaw.isotropic(mu, dimension=1)
    contact = asp.Contact(law, direction=[1.0, 0.0], normal=[0.0, 1.0], velocity=[-1.0])
    return asp.LinearSystem(
        mass, stiffness=stiffness, damping=damping, force=force, contacts=[contact]
    )


def mode_coupling(mu, belt_mass):
    """A mass on springs at 150° and 30° on a belt that a third spring presses from below."""
    K = np.diag([0.0, 0.0, 4.0 / 3.0])
    for sign, degrees in ((-1.0, 150.0), (1.0, 30.0)):
        axis = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.0])
        K += 2.0 / 3.0 * (2.0 + sign * math.sqrt(3.0)) * np.outer(axis, axis)
    law = asp.FrictionLaw.isotropic(mu, dimension=1)
    contact = asp.Contact(law, direction=[1.0, 0.0, 0.0], normal=[0.0, 1.0, -1.0], velocity=[1.0])
    return asp.LinearSystem(
        [1.0, 1.0, belt_mass], stiffness=K, force=[0.0, -1.0, 0.0], contacts=[contact]
    )


class Follower(asp.System):
    """Double pendulum, masses 2 and 1, with a friction force of constant size along its end."""

    dof = 2

    def __init__(self, load):
        self.contacts = (asp.ContactLaw(LINE, normal_force=load),)

    def mass(self, q):
        c = math.cos(q[0] - q[1])
        return np.array([[3.0, c], [c, 1.0]])

    def forces(self, t, q, u):
        s = math.sin(q[0] - q[1])
        return np.array([-2.0 * q[0] + q[1] - s * u[1] ** 2, q[0] - q[1] + s * u[0] ** 2])

    def direction(self, t, q, contact):
        return np.array([[math.sin(q[1] - q[0])], [0.0]])

    def velocity(self, t, q, contact):
        return np.array([1.0])


@pytest.mark.parametrize(("mu", "growth"), [(0.9, 0.157147), (1.2, 0.269036)])
def test_mode_coupling_numbers(mu, growth):
    K = [[2.0, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]]
    for system in (mode_coupling(mu, 1e-9), asp.LinearSystem(np.eye(2), stiffness=K)):
        found = asp.stability(system)
        np.testing.assert_allclose(found.growth_rate, growth, atol=1e-6)
        assert found.mechanisms == {"mode coupling": 0.0}
        assert "mode coupling" in found.reason
        split = np.sqrt(1.0 - 4.0 * mu / 3.0 + 0j)
        for square in (2.0 + split, 2.0 - split):
            assert np.abs(found.eigenvalues - np.sqrt(-square)).min() < 1e-7


def held_ball(phi, law):
    """A ball on a belt, held by springs at six points of its surface."""
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1))
    places = 0.1 * np.vstack([np.eye(3), -np.eye(3)])
    held = places + np.array([0.0, 0.0, 0.1])
    springs = [
        asp.Spring(0, point=p, other_point=at, stiffness=500.0)
        for p, at in zip(places, held, strict=True)
    ]
    table = asp.Plane(velocity=(math.cos(phi), math.sin(phi)))
    return asp.RigidBodies(
        [ball], pairs=[asp.SpherePlane(0, radius=0.1, plane=table, law=law)], springs=springs
    )


def test_rigid_bodies():
    """Growth of a ball whose friction torque keeps its direction, against a simulation."""
    law = asp.FrictionLaw(asp.Ellipse(0.3, 0.1, angle=math.pi / 6), asp.Ellipse(3.0, 1.0))
    system = held_ball(np.deg2rad(50.0), law)
    found = asp.stability(system)
    assert found.kind == "unstable"
    # Conservative torques have a symmetric stiffness in whatever axes.
    assert set(found.mechanisms) == {"tangent cone", "follower force"}
    assert found.equilibrium.q.shape == (7,)
    np.testing.assert_allclose(found.equilibrium.normal_force, 9.81, rtol=1e-9)
    path = asp.simulate(
        system,
        dt=1e-4,
        t_end=20.0,
        q0=found.equilibrium.q,
        u0=1e-5 * (found.eigenvalues[0] * found.modes[:, 0]).real,
    )
    size = np.linalg.norm(path.u, axis=1)
    peaks = [size[a : a + 20000].max() for a in (0, 100000, 180000)]
    growth = math.log(peaks[2] / peaks[1]) / 8.0
    np.testing.assert_allclose(growth, found.growth_rate, rtol=0.05)


def test_linear_system_and_the_same_written_in_python():
    """Differences give what constant matrices give."""
    linear = mode_coupling(1.1, 0.2)
    (contact,) = linear.contacts

    class Same(asp.System):
        dof = 3
        contacts = (asp.ContactLaw(contact.law),)

        def mass(self, q):
            return linear.mass

        def forces(self, t, q, u):
            return linear.force - linear.stiffness @ q - linear.damping @ u + 0.3 * q[0] ** 3

        def direction(self, t, q, contact):
            return linear.contacts[contact].direction

        def velocity(self, t, q, contact):
            return linear.contacts[contact].velocity

        def normal(self, t, q, contact):
            return linear.contacts[contact].normal

        def gap(self, t, q, contact):
            return float(linear.contacts[contact].normal @ q)

    own = asp.equilibrium(Same())
    forces = Same().forces(0.0, own.q, np.zeros(3))
    balance = forces + linear.contacts[0].normal * own.normal_force[0]
    balance += linear.contacts[0].direction @ own.force[0]
    np.testing.assert_allclose(balance, 0.0, atol=1e-12)
    cubic = np.zeros((3, 3))
    cubic[:, 0] = 0.9 * own.q[0] ** 2
    tangent = asp.LinearSystem(
        linear.mass,
        stiffness=linear.stiffness - cubic,
        force=linear.force,
        contacts=linear.contacts,
    )
    expected, found = asp.stability(tangent), asp.stability(Same())
    np.testing.assert_allclose(found.stiffness, expected.stiffness, atol=1e-10)
    np.testing.assert_allclose(found.growth_rate, expected.growth_rate, rtol=1e-8)


ISOTROPIC = asp.FrictionLaw.isotropic(0.3)


@pytest.mark.parametrize(
    ("argument", "message", "call"),
    [
        ("system", "would stick", lambda: asp.equilibrium(asp.SlidingPoint(1.0, law=ISOTROPIC))),
        (
            "system",
            "singular",
            lambda: asp.equilibrium(
                asp.MassOnBelt(
                    1.0, stiffness=0.0, law=ISOTROPIC, normal_force=1.0, belt_velocity=[1.0, 0.0]
                )
            ),
        ),
        (
            "system",
            "flat",
            lambda: asp.stability(
                asp.MassOnBelt(
                    1.0,
                    stiffness=1.0,
                    law=asp.FrictionLaw.associated(asp.Rectangle(2, 1)),
                    normal_force=1.0,
                    belt_velocity=[1.0, 0.0],
                )
            ),
        ),
        (
            "system",
            "would open",
            lambda: asp.equilibrium(on_belt(0.5, np.eye(2), 1.0, force=[0, 1])),
        ),
        (
            "system",
            "Painlevé",
            lambda: asp.stability(on_belt(1.2, [[1.0, 0.9], [0.9, 1.0]], 1.0)),
        ),
        ("closed", "unilateral", lambda: asp.equilibrium(mode_coupling(0.5, 0.1), closed=[1])),
        (
            "closed",
            "penetrates",
            lambda: asp.equilibrium(on_belt(0.5, np.eye(2), 1.0), closed=[]),
        ),
        ("system", "must be a system", lambda: asp.equilibrium("belt")),
        ("q0", "shape", lambda: asp.equilibrium(mode_coupling(0.5, 0.1), q0=[0.0])),
        ("tolerance", "positive", lambda: asp.equilibrium(mode_coupling(0.5, 0.1), tolerance=0.0)),
        (
            "equilibrium",
            "Equilibrium",
            lambda: asp.stability(mode_coupling(0.5, 0.1), equilibrium=3),
        ),
        (
            "equilibrium",
            "balance",
            lambda: asp.stability(
                mode_coupling(0.5, 0.1), equilibrium=asp.equilibrium(mode_coupling(0.9, 0.1))
            ),
        ),
    ],
)
def test_errors_name_the_argument(argument, message, call):
    with pytest.raises(asp.ParameterError, match=message) as caught:
        call()
    assert caught.value.argument == argument


def test_no_steady_sliding():
    class Runaway(Follower):
        def forces(self, t, q, u):
            return q**2 + 1.0

        def direction(self, t, q, contact):
            return np.zeros((2, 1))

    with pytest.raises(asp.ConvergenceError, match="no steady sliding"):
        asp.equilibrium(Runaway(1.0), q0=[0.7, 0.3])
