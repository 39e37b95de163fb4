"""Pendulums with a dry hinge, against the closed form of where they stop.

Of J φ̈ = −m g l sin φ − τ with |τ| ≤ τ₀ every swing goes from φ₀ to the φ₁ at which the work of the
weight is used up, m g l (cos φ₁ − cos φ₀) = τ₀ |φ₁ − φ₀|, until one ends where m g l |sin φ₁| ≤ τ₀.
"""

import asperity as asp
import mujoco
import numpy as np
import pytest
from asperity.mujoco import Scene
from profiles import every
from scipy.optimize import brentq

GRAVITY = 9.81


class Pendulum(asp.System):
    """A body on an arm whose hinge resists with a torque up to τ₀."""

    dof = 1
    coordinate_names = ("angle",)
    coordinate_units = ("rad",)

    def __init__(self, mass, length, torque):
        self.weight, self.inertia = mass * GRAVITY * length, mass * length**2
        law = asp.FrictionLaw.isotropic(1.0, dimension=1)
        self.contacts = [asp.ContactLaw(law, normal_force=torque)]

    def mass(self, q):
        """M = m l²."""
        return np.array([[self.inertia]])

    def forces(self, t, q, u):
        """H = −m g l sin φ."""
        return -self.weight * np.sin(q)

    def direction(self, t, q, contact):
        """W = 1."""
        return np.array([[1.0]])


class Case:
    """A random pendulum, let go at an angle beyond the band in which it would rest."""

    def __init__(self, seed):
        rng = np.random.default_rng([30, seed])
        self.mass, self.length = rng.uniform(0.2, 3.0), rng.uniform(0.1, 1.0)
        self.band = rng.uniform(0.05, 0.5)
        self.torque = self.mass * GRAVITY * self.length * np.sin(self.band)
        self.start = rng.choice([-1.0, 1.0]) * rng.uniform(1.2 * self.band, 2.5)
        # A swing takes less than twice as long as one of small angles.
        swings = len(self.turning_points())
        self.duration = 2.0 * swings * np.pi * np.sqrt(self.length / GRAVITY)

    def turning_points(self):
        """The angles at which it comes to rest, the last of which it does not leave."""
        points, dry = [self.start], np.sin(self.band)
        while abs(np.sin(points[-1])) > dry or abs(points[-1]) > np.pi / 2:
            # The energy over m g l that is left on the way from the side where it was let go.
            side, begin = np.sign(points[-1]), abs(points[-1])

            def left(angle, begin=begin):
                return np.cos(angle) - np.cos(begin) - dry * (begin - angle)

            # Between its least point, beyond which it is braked, and where the energy is negative.
            points.append(side * brentq(left, -np.pi, np.arcsin(dry), xtol=1e-15))
        return points


@pytest.mark.parametrize("seed", every(4, range(100)))
def test_a_pendulum_stops_at_the_angle_of_the_closed_form(seed):
    case = Case(seed)
    points = case.turning_points()
    system = Pendulum(case.mass, case.length, case.torque)
    motion = asp.integrate(
        system, t_end=case.duration, q0=[case.start], u0=[0.0], tolerance=1e-11, max_events=1000
    )
    assert abs(motion.q[-1, 0] - points[-1]) < 1e-9
    assert abs(motion.q[-1, 0]) <= case.band + 1e-9
    assert (motion.u[-1, 0], motion.phase[-1, 0]) == (0.0, asp.Phase.STICK)
    # It turns at the angles between, where it slips on at once.
    assert len(motion.events) == len(points) - 1 + (len(points) == 1)


@pytest.mark.parametrize("seed", every(10, range(100)))
def test_a_hinge_of_mujoco_stops_within_the_band(seed):
    case = Case(seed)
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler balanceinertia="true"/><option timestep="1e-3"/><worldbody><body>
        <joint axis="0 1 0" frictionloss="{case.torque}"/>
        <inertial pos="0 0 {-case.length}" mass="{case.mass}" diaginertia="1e-9 1e-9 1e-9"/>
        </body></worldbody></mujoco>"""
    )
    scene, data = Scene(model), mujoco.MjData(model)
    data.qpos[0] = case.start
    rests = 0
    # Where it turns it may stop for the rest of one step.
    while rests < 3:
        assert data.time < case.duration
        scene.step(data)
        rests = rests + 1 if abs(data.qvel[0]) < 1e-12 else 0
    angle = data.qpos[0]
    assert abs(angle) <= case.band + 1e-9
    # Of first order in the step for each of the turns.
    points = case.turning_points()
    assert abs(angle - points[-1]) < 1e-3 * len(points)
    for _ in range(100):
        scene.step(data)
    assert abs(data.qpos[0] - angle) < 1e-12
