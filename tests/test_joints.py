"""Hinges, sliders and welds against closed forms, other engines and simpler systems."""

import itertools

import asperity as asp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

G = 9.81
ORIGIN = (0.0, 0.0, 0.0)
ROD = (0.02, 0.03, 0.3)


def apart(system, motion, joint, anchor, body=0, other=None):
    """Return how far the points of both bodies that met at the anchor are from each other."""
    positions, rotations = system.positions(motion), system.rotations(motion)
    ends = []
    for k in (body, other):
        if k is None:
            ends.append(np.broadcast_to(anchor, positions[:, 0].shape))
        else:
            arm = rotations[0, k].T @ (np.asarray(anchor) - positions[0, k])
            ends.append(positions[:, k] + rotations[:, k] @ arm)
    return np.abs(ends[0] - ends[1]).max()


def pendulum(angle=1.0, turn=None, scale=1.0, mass=2.0, **changes):
    """Return a slender box on a hinge about a horizontal axis, at an angle from below."""
    turn = Rotation.identity() if turn is None else turn
    attitude = turn * Rotation.from_euler("y", -angle)
    x, y, z, w = attitude.as_quat()
    half = scale * np.array(ROD)
    arm = attitude.apply([0.0, 0.0, -half[2]])
    body = asp.Body.box(mass, half_sizes=half, position=arm, orientation=(w, x, y, z))
    hinge = asp.Hinge(0, anchor=ORIGIN, axis=turn.apply([0.0, 1.0, 0.0]))
    gravity = turn.apply([0.0, 0.0, -G * scale])
    return asp.RigidBodies([body], joints=[hinge], gravity=gravity, **changes)


def swing(angle, times, rate=G * 0.3 / (0.3**2 + (0.02**2 + 0.3**2) / 3.0)):
    def motion(_, state):
        return [state[1], -rate * np.sin(state[0])]

    found = solve_ivp(
        motion, (0.0, times[-1]), [angle, 0.0], "DOP853", times, rtol=1e-12, atol=1e-13
    )
    return found.y[0]


def angle_of(system, motion, turn):
    arm = turn.inv().apply(system.positions(motion)[:, 0])
    return np.unwrap(np.arctan2(arm[:, 0], -arm[:, 2]))


def test_pendulum_follows_its_equation_with_second_order():
    turn, errors = Rotation.random(random_state=3), []
    system = pendulum(1.0, turn)
    for dt in (4e-3, 2e-3, 1e-3):
        motion = asp.simulate(system, dt=dt, t_end=2.0)
        errors.append(np.abs(angle_of(system, motion, turn) - swing(1.0, motion.t)).max())
        assert apart(system, motion, 0, np.zeros(3)) < 1e-13
    assert errors[-1] < 1e-5
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.02)


def test_energy_of_a_pendulum_does_not_drift():
    system = pendulum(2.5)
    motion = asp.simulate(system, dt=1e-2, t_end=100.0)
    energy = system.energy(motion) - system.energy(motion)[0]
    first, last = energy[: len(energy) // 4], energy[-len(energy) // 4 :]
    assert np.abs(energy).max() < 2e-2
    assert abs(last.max() - first.max()) < 2e-4
    assert abs(last.min() - first.min()) < 2e-4


CHAIN = """
<mujoco>
  <option timestep="1e-4" integrator="RK4" gravity="0 0 -9.81"><flag contact="disable"/></option>
  <worldbody>
    <body pos="0.3 0 0">
      <inertial pos="0 0 0" mass="2" diaginertia="0.02 0.05 0.06"/>
      <joint type="hinge" axis="0 0.6 0.8" pos="-0.3 0 0"/>
      <body pos="0.3 0.2 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.004 0.012"/>
        <joint type="hinge" axis="1 0 0.5" pos="0 -0.2 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def double_pendulum(order=1):
    bodies = [
        asp.Body(2.0, inertia=(0.02, 0.05, 0.06), position=(0.3, 0.0, 0.0)),
        asp.Body(1.0, inertia=(0.01, 0.004, 0.012), position=(0.6, 0.2, 0.0)),
    ]
    joints = [
        asp.Hinge(0, anchor=ORIGIN, axis=(0.0, 0.6, 0.8)),
        asp.Hinge(1, other=0, anchor=(0.6, 0.0, 0.0), axis=(1.0, 0.0, 0.5)),
    ]
    return asp.RigidBodies(bodies, joints=joints[::order])


def test_double_pendulum_in_space_moves_as_in_mujoco():
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(CHAIN)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 10_000)
    system, errors = double_pendulum(), []
    for dt in (2e-3, 1e-3):
        motion = asp.simulate(system, dt=dt, t_end=1.0)
        errors.append(np.abs(system.positions(motion)[-1] - data.xipos[1:]).max())
        assert apart(system, motion, 1, (0.6, 0.0, 0.0), 1, 0) < 1e-12
    assert errors[1] < 2e-5
    assert 3.8 < errors[0] / errors[1] < 4.2


def test_order_of_joints_does_not_matter():
    motions = [asp.simulate(double_pendulum(order), dt=1e-3, t_end=1.0) for order in (1, -1)]
    np.testing.assert_allclose(motions[0].q, motions[1].q, atol=1e-10)


def test_runs_can_be_continued_stored_and_made_many_times(tmp_path):
    system = double_pendulum()
    whole = asp.simulate(system, dt=1e-3, t_end=0.4)
    half = asp.simulate(system, dt=1e-3, t_end=0.2)
    rest = asp.simulate(system, dt=1e-3, t_end=0.4, start=half)
    np.testing.assert_array_equal(rest.q[-1], whole.q[-1])
    np.testing.assert_array_equal(rest.u[-1], whole.u[-1])
    half.save(tmp_path / "run.npz")
    assert asp.Trajectory.load(tmp_path / "run.npz").repeat() == half
    many = asp.simulate_many(system, u0=np.zeros((2, 12)), dt=1e-3, t_end=0.2)
    np.testing.assert_array_equal(many.q[1], half.q[-1])


def test_runs_at_rest_can_be_continued():
    """Velocities at rest are rounding, which joints need not let pass."""
    system, _ = leg(asp.FrictionLaw.isotropic(0.5))
    whole = asp.simulate(system, dt=1e-3, t_end=0.1)
    half = asp.simulate(system, dt=1e-3, t_end=0.05)
    rest = asp.simulate(system, dt=1e-3, t_end=0.1, start=half)
    np.testing.assert_array_equal(rest.q[-1], whole.q[-1])
    np.testing.assert_array_equal(rest.u[-1], whole.u[-1])
    asp.simulate(system, dt=1e-3, t_end=0.1, q0=half.q[-1], u0=half.u[-1])


def test_pendulum_that_rebounds_keeps_its_energy():
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.5, 0.0, 0.5))
    floor = asp.SpherePlane(
        0,
        radius=0.1,
        plane=asp.Plane(),
        law=asp.FrictionLaw.isotropic(1e-12),
        normal_restitution=1.0,
    )
    hinge = asp.Hinge(0, anchor=(0.0, 0.0, 0.3), axis=(0.0, 1.0, 0.0))
    system = asp.RigidBodies([ball], pairs=[floor], joints=[hinge])
    motion = asp.simulate(system, dt=1e-3, t_end=5.0)
    energy = system.energy(motion)
    assert (motion.normal_force[1:] > 0.0).sum() > 5
    np.testing.assert_allclose(energy, energy[0], rtol=1e-5)


def test_slider_on_an_incline_accelerates_by_its_slope():
    turn = Rotation.from_euler("yz", [0.4, 0.7])
    box = asp.Body.box(3.0, half_sizes=(0.1, 0.2, 0.3), position=(1.0, 2.0, 3.0))
    rail = asp.Slider(0, anchor=(1.0, 2.0, 2.5), axis=turn.apply([1.0, 0.0, 0.0]))
    system = asp.RigidBodies([box], joints=[rail])
    motion = asp.simulate(system, dt=1e-2, t_end=2.0)
    way = turn.inv().apply(system.positions(motion)[:, 0] - box.position)
    np.testing.assert_allclose(
        way[:, 0], 0.5 * G * np.sin(0.4) * motion.t**2, rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(way[:, 1:], 0.0, atol=1e-12)
    np.testing.assert_allclose(motion.q[:, 3:] - motion.q[0, 3:], 0.0, atol=1e-13)


def slab(welded, law, rate):
    """Return two boxes side by side, or one body with their mass and inertia, on the floor."""
    half, masses = np.array([0.1, 0.1, 0.05]), np.array([1.0, 3.0])
    places = np.array([[-0.1, 0.0, 0.05], [0.1, 0.0, 0.05]])
    center = masses @ places / masses.sum()
    turn = Rotation.from_euler("z", 0.3)
    x, y, z, w = turn.as_quat()
    velocity, spin = np.array([1.0, 0.5, 0.0]), np.array([0.0, 0.0, rate])
    corners = [[sx * 0.2, sy * 0.1, -0.05] for sx in (-1, 1) for sy in (-1, 1)]
    arms = turn.apply(places - center)
    if welded:
        bodies = [
            asp.Body.box(
                m,
                half_sizes=half,
                position=arm + center,
                orientation=(w, x, y, z),
                velocity=velocity + np.cross(spin, arm),
                angular_velocity=spin,
            )
            for m, arm in zip(masses, arms, strict=True)
        ]
        points = [(int(c[0] > 0), np.subtract(c, [np.sign(c[0]) * 0.1, 0.0, 0.0])) for c in corners]
        joints = [asp.Weld(0, other=1)]
    else:
        inertia = np.zeros((3, 3))
        for m, place in zip(masses, places - center, strict=True):
            squares = half**2
            inertia += np.diag(m / 3.0 * (squares.sum() - squares))
            inertia += m * (place @ place * np.eye(3) - np.outer(place, place))
        bodies = [
            asp.Body(
                4.0,
                inertia=inertia,
                position=center,
                orientation=(w, x, y, z),
                velocity=velocity,
                angular_velocity=spin,
            )
        ]
        points = [(0, np.subtract(np.add(c, [0.0, 0.0, 0.05]), center)) for c in corners]
        joints = []
    pairs = [asp.PointPlane(k, point=p, plane=asp.Plane(), law=law) for k, p in points]
    return asp.RigidBodies(bodies, pairs=pairs, joints=joints)


@pytest.mark.parametrize("kind", ["isotropic", "extended"])
def test_welded_boxes_move_as_one(kind):
    law = asp.FrictionLaw.isotropic(0.3)
    if kind == "extended":
        law = asp.FrictionLaw(asp.Ellipse(0.4, 0.2), asp.Ellipse(2.0, 1.0))
    masses = np.array([1.0, 3.0]) / 4.0

    def difference(rate, dt):
        two, one = slab(True, law, rate), slab(False, law, rate)
        options = {"dt": dt, "t_end": 0.6, "tolerance": 1e-12}
        welded, whole = asp.simulate(two, **options), asp.simulate(one, **options)
        center = np.einsum("k,tkj->tj", masses, two.positions(welded))
        assert np.abs(whole.u[-1]).max() < 1e-9
        assert np.linalg.norm(center[-1] - center[0]) > 0.1
        turned = two.rotations(welded)[:, 1] - one.rotations(whole)[:, 0]
        return max(np.abs(center - one.positions(whole)[:, 0]).max(), np.abs(turned).max())

    assert difference(0.0, 1e-3) < 1e-9
    # Where they turn, a step is another one of second order.
    coarse, fine = difference(6.0, 2e-3), difference(6.0, 1e-3)
    assert fine < 5e-6
    assert fine < 0.3 * coarse


def four_bar(second=1.0, **changes):
    """Return a crank, a coupler and a rocker, whose axes are parallel: three rows repeat others."""
    places = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.4], [0.8, 0.0, 0.9], [1.0, 0.0, 0.0]])
    bodies = []
    for a, b in itertools.pairwise(places):
        along = b - a
        turn = Rotation.align_vectors([along], [[0.0, 0.0, 1.0]])[0]
        x, y, z, w = turn.as_quat()
        half = (0.02, 0.03, 0.5 * np.linalg.norm(along))
        bodies.append(
            asp.Body.box(1.0, half_sizes=half, position=(a + b) / 2.0, orientation=(w, x, y, z))
        )
    axis = (0.0, second, 0.0)
    joints = [
        asp.Hinge(0, anchor=places[0], axis=axis),
        asp.Hinge(1, other=0, anchor=places[1], axis=axis),
        asp.Hinge(2, other=1, anchor=places[2], axis=axis),
        asp.Hinge(2, anchor=places[3], axis=axis),
    ]
    return asp.RigidBodies(bodies, joints=joints, **changes), places


def test_four_bar_loop_stays_closed():
    system, places = four_bar()
    motion = asp.simulate(system, dt=1e-3, t_end=10.0)
    assert (
        max(
            apart(system, motion, 0, places[0]),
            apart(system, motion, 1, places[1], 1, 0),
            apart(system, motion, 2, places[2], 2, 1),
            apart(system, motion, 3, places[3], 2),
        )
        < 1e-11
    )
    np.testing.assert_allclose(system.positions(motion)[..., 1], 0.0, atol=1e-10)
    energy = system.energy(motion)
    kinetic = np.ptp(system.positions(motion)[..., 2].sum(axis=1)) * G
    assert kinetic > 1.0
    assert np.abs(energy - energy[0]).max() < 1e-4 * kinetic


@pytest.mark.parametrize("tilt", [1e-12, 1e-10, 1e-6])
def test_loop_whose_axes_are_not_quite_parallel(tilt):
    """Up to what a start may be off it moves on, with more the joints do not fit."""
    system, _ = four_bar()
    expected = asp.simulate(system, dt=1e-3, t_end=1.0)
    joints = list(system.joints)
    joints[1] = joints[1].replace(axis=(tilt, 1.0, 0.0))
    tilted = system.replace(joints=joints)
    if tilt > 1e-9:
        with pytest.raises(asp.ParameterError, match="or joints do not fit"):
            asp.simulate(tilted, dt=1e-3, t_end=1.0)
        return
    motion = asp.simulate(tilted, dt=1e-3, t_end=1.0)
    np.testing.assert_allclose(motion.q, expected.q, atol=1e-8)


def test_planar_joints_move_bodies_as_joints_in_space_do():
    rods = [(0.3, 0.0), (0.6, 0.2)]
    flat = asp.RigidBodies(
        [asp.PlanarBody(1.0, inertia=0.02, position=place) for place in rods],
        joints=[asp.Hinge(0, anchor=(0.0, 0.0)), asp.Hinge(1, other=0, anchor=(0.6, 0.0))],
    )
    deep = asp.RigidBodies(
        [asp.Body(1.0, inertia=(0.02, 0.02, 0.02), position=(*place, 0.0)) for place in rods],
        joints=[
            asp.Hinge(0, anchor=ORIGIN, axis=(0.0, 0.0, 1.0)),
            asp.Hinge(1, other=0, anchor=(0.6, 0.0, 0.0), axis=(0.0, 0.0, 1.0)),
        ],
        gravity=(0.0, -9.81, 0.0),
    )
    planar, spatial = (asp.simulate(system, dt=1e-3, t_end=2.0) for system in (flat, deep))
    places = deep.positions(spatial)
    np.testing.assert_allclose(flat.positions(planar), places[..., :2], atol=1e-9)


def test_units_and_sizes_do_not_matter():
    plain = pendulum(1.0)
    expected = angle_of(plain, asp.simulate(plain, dt=1e-3, t_end=1.0), Rotation.identity())
    for scale, mass in ((1e-3, 1e-6), (1e3, 1e6)):
        system = pendulum(1.0, scale=scale, mass=mass)
        motion = asp.simulate(system, dt=1e-3, t_end=1.0)
        angles = angle_of(system, motion, Rotation.identity())
        np.testing.assert_allclose(angles, expected, atol=1e-11)


@pytest.mark.parametrize("ratio", [1e-8, 1e8])
def test_extreme_ratios_of_masses(ratio):
    """A body of another mass that hangs on the tip swings as if it or the rod had none."""
    rod = asp.Body.ball(1.0, radius=0.1, position=(0.5, 0.0, 0.0))
    tip = asp.Body.ball(ratio, radius=1e-3, position=(1.0, 0.0, 0.0))
    axis = (0.0, 1.0, 0.0)
    joints = [asp.Hinge(0, anchor=ORIGIN, axis=axis), asp.Weld(1, other=0)]
    system = asp.RigidBodies([rod, tip], joints=joints)
    motion = asp.simulate(system, dt=1e-3, t_end=1.0)
    moments = 0.25 + 0.4 * 0.01 + ratio * (1.0 + 0.4 * 1e-6)
    rate = G * (0.5 + ratio) / moments
    place = system.positions(motion)[:, 0]
    angles = np.arctan2(place[:, 0], -place[:, 2])
    np.testing.assert_allclose(angles, swing(np.pi / 2.0, motion.t, rate), atol=2e-5)
    assert apart(system, motion, 1, (1.0, 0.0, 0.0), 1, 0) < 1e-12


def test_states_that_joints_do_not_allow_are_refused():
    system = pendulum(0.5)
    moved = system.q0 + 1e-3 * np.eye(7)[0]
    with pytest.raises(asp.ParameterError, match="q0: must be coordinates that joint 0 allows"):
        asp.simulate(system, dt=1e-3, t_end=0.1, q0=moved)
    with pytest.raises(asp.ParameterError, match="u0: must be velocities that joint 0 lets pass"):
        asp.simulate(system, dt=1e-3, t_end=0.1, u0=[0.1, 0.0, 0.0, 0.0, 0.0, 0.0])


def test_what_does_not_know_joints_refuses_them():
    system = pendulum(0.5)
    for call in (
        lambda: asp.integrate(system, t_end=1.0),
        lambda: asp.equilibrium(system),
        lambda: asp.stability(system),
    ):
        with pytest.raises(asp.ParameterError, match=r"system: .*joints"):
            call()


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        (lambda: asp.Hinge(0, anchor=ORIGIN, axis=ORIGIN), "axis: must not be zero"),
        (lambda: asp.Hinge(0, anchor=ORIGIN), "axis: must be given"),
        (lambda: asp.Slider(0, anchor=(0.0, 0.0)), "axis: must be given"),
        (lambda: asp.Weld(1, other=1), "other: must be another body than 1"),
        (lambda: asp.RigidBodies([asp.Body.ball(1.0, radius=1.0)], joints=[asp.Weld(1)]), "body"),
    ],
)
def test_joints_that_are_none_are_refused(joint, message):
    with pytest.raises(asp.ParameterError, match=message):
        joint()


def test_dry_hinge_stops_where_its_torque_holds_the_weight():
    """A patch at the anchor that is pressed on by a given force turns with friction."""
    bound, radius = 0.4, 0.1  # N m, m
    law = asp.FrictionLaw.isotropic(1.0, dimension=3)
    turn = Rotation.identity()
    for start in (2.0, 1.0, 0.4):
        hinged = pendulum(start)
        plane = asp.Plane(normal=(0.0, 1.0, 0.0), axis=(1.0, 0.0, 0.0))
        dry = asp.PointPlane(
            0,
            point=(0.0, 0.0, ROD[2]),
            plane=plane,
            law=law,
            normal_force=bound / radius,
            patch_radius=radius,
        )
        system = hinged.replace(pairs=[dry])
        motion = asp.simulate(system, dt=1e-3, t_end=20.0)
        angle = angle_of(system, motion, turn)
        weight = 2.0 * G * ROD[2] * np.sin(angle[-1])
        assert abs(weight) < bound
        assert np.abs(motion.u[-1]).max() < 1e-9
        assert abs(angle[-1] - angle[-2000]) < 1e-9
        # Friction has taken the energy that is gone.
        taken = system.energy(motion)[0] - system.energy(motion)[-1]
        assert taken == pytest.approx(bound * np.abs(np.diff(angle)).sum(), rel=1e-3)
    still = pendulum(0.06).replace(pairs=[dry])
    held = asp.simulate(still, dt=1e-3, t_end=1.0, tolerance=1e-13)
    np.testing.assert_allclose(held.q - held.q[0], 0.0, atol=1e-12)


def test_foot_of_an_arm_on_a_hinge_slides_with_an_extended_law():
    """An arm about a vertical hinge on a carriage presses its foot on the floor.

    The carriage slides upright, so that the weight of the arm is on the foot. Its rate follows
    J dω/dt = l λ(φ)·e: friction of the foot along its way, as the law has it.
    """
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(1.0, 3.0))
    length, mass, start = 0.5, 2.0, 4.0
    carriage = asp.Body.ball(0.5, radius=0.05)
    arm = asp.Body.ball(
        mass,
        radius=0.1,
        position=(length, 0.0, 0.0),
        velocity=(0.0, length * start, 0.0),
        angular_velocity=(0.0, 0.0, start),
    )
    foot = asp.PointPlane(1, point=ORIGIN, plane=asp.Plane(axis=(1.0, 0.0, 0.0)), law=law)
    up = (0.0, 0.0, 1.0)
    joints = [
        asp.Slider(0, anchor=ORIGIN, axis=up),
        asp.Hinge(1, other=0, anchor=ORIGIN, axis=up),
    ]
    system = asp.RigidBodies([carriage, arm], pairs=[foot], joints=joints)
    moment, load = mass * length**2 + 0.4 * mass * 0.1**2, 2.5 * G

    def rates(_, state):
        along = np.array([-np.sin(state[0]), np.cos(state[0])])
        return [state[1], length * law.force(along, normal_force=load) @ along / moment]

    found = solve_ivp(rates, (0.0, 0.3), [0.0, start], rtol=1e-10, atol=1e-12)
    errors = []
    for dt in (2e-3, 1e-3):
        motion = asp.simulate(system, dt=dt, t_end=0.3)
        place = system.positions(motion)[-1, 1]
        errors.append(abs(np.arctan2(place[1], place[0]) - found.y[0, -1]))
        np.testing.assert_allclose(motion.normal_force[1:], load, rtol=1e-9)
        np.testing.assert_allclose(system.positions(motion)[:, 1, 2], 0.0, atol=1e-9)
    assert errors[1] < 1e-3
    assert errors[1] < 0.6 * errors[0]


def test_contact_whose_normal_joints_hold_is_refused():
    half = (0.1, 0.1, 0.1)
    box = asp.Body.box(1.0, half_sizes=half, position=(0.0, 0.0, 0.1))
    floor = asp.BoxPlane(0, half_sizes=half, plane=asp.Plane(), law=asp.FrictionLaw.isotropic(0.3))
    system = asp.RigidBodies([box], pairs=[floor], joints=[asp.Weld(0)])
    with pytest.raises(asp.ParameterError, match="joints: must let the bodies of contact 0 move"):
        asp.simulate(system, dt=1e-3, t_end=0.1)


def leg(law):
    """Return two bars from a hinge over a knee to a foot on the floor."""
    places = np.array([[0.0, 0.0, 0.8], [0.5, 0.0, 0.9], [0.9, 0.0, 0.0]])
    bars = []
    for a, b in itertools.pairwise(places):
        x, y, z, w = Rotation.align_vectors([b - a], [[0.0, 0.0, 1.0]])[0].as_quat()
        half = (0.02, 0.03, 0.5 * np.linalg.norm(b - a))
        bars.append(
            asp.Body.box(1.0, half_sizes=half, position=(a + b) / 2.0, orientation=(w, x, y, z))
        )
    axis, point = (0.0, 1.0, 0.0), np.array([0.0, 0.0, half[2]])
    joints = [asp.Hinge(0, anchor=places[0], axis=axis)]
    joints.append(asp.Hinge(1, other=0, anchor=places[1], axis=axis))
    foot = asp.PointPlane(1, point=point, plane=asp.Plane(), law=law)
    return asp.RigidBodies(bars, pairs=[foot], joints=joints), point


def test_foot_that_sticks_carries_what_statics_say():
    system, _ = leg(asp.FrictionLaw(asp.Ellipse(0.5, 0.3, angle=0.4), asp.Ellipse(1.0, 3.0)))
    motion = asp.simulate(system, dt=1e-3, t_end=0.2)
    # Moments about the hinge and about the knee.
    thrust, load = np.linalg.solve([[0.8, 0.9], [0.9, 0.4]], [0.95 * G, 0.2 * G])
    np.testing.assert_allclose(motion.force[1:, 0, 0], thrust, rtol=1e-9)
    np.testing.assert_allclose(motion.normal_force[1:, 0], load, rtol=1e-9)
    np.testing.assert_allclose(motion.q - motion.q[0], 0.0, atol=1e-12)


def test_foot_of_a_leg_slides_smoothly_and_takes_what_friction_takes():
    system, point = leg(asp.FrictionLaw(asp.Ellipse(0.12, 0.2), asp.Ellipse(1.0, 3.0)))
    errors = []
    for dt in (2e-3, 1e-3):
        motion = asp.simulate(system, dt=dt, t_end=0.25)
        foot = system.positions(motion)[:, 1] + system.rotations(motion)[:, 1] @ point
        assert (motion.phase[1:] == asp.Phase.SLIP).all()
        assert np.abs(np.diff(motion.normal_force[1:, 0])).max() < 200.0 * dt
        assert np.abs(foot[:, 2]).max() < 2.0 * dt**2
        work = (motion.force[1:, 0] * np.diff(foot[:, :2], axis=0)).sum()
        gained = system.energy(motion)[-1] - system.energy(motion)[0]
        assert gained < -0.05
        errors.append(abs(gained - work))
    assert errors[1] < 2e-4
    assert errors[1] < 0.3 * errors[0]


def test_hinges_of_a_hanging_chain_carry_what_hangs_below():
    masses = np.array([1.0, 3.0, 0.5])
    # One link that hangs beside its hinge, along the axis; then three that hang straight.
    axes = np.array([(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.6, 0.8, 0.0)])
    anchors = np.array([[0.0, 0.0, -0.4 * k] for k in range(3)])
    centers = anchors + 0.05 * axes - [0.0, 0.0, 0.2]
    hung = masses[:, None] * [0.0, 0.0, -G]
    joints = [asp.Hinge(k, other=k - 1, anchor=anchors[k], axis=axes[k]) for k in (1, 2)]
    links = [
        asp.Body.box(m, half_sizes=(0.02, 0.03, 0.2), position=center)
        for m, center in zip(masses, centers, strict=True)
    ]
    system = asp.RigidBodies(links[:1], joints=[asp.Hinge(0, anchor=anchors[0], axis=axes[0])])
    forces, torques = system.joint_reactions(asp.simulate(system, dt=1e-3, t_end=0.01))
    np.testing.assert_allclose(forces[:, 0], np.broadcast_to(-hung[0], (11, 3)), atol=1e-9)
    moment = -np.cross(0.05 * axes[0], hung[0])
    np.testing.assert_allclose(torques[:, 0], np.broadcast_to(moment, (11, 3)), atol=1e-9)
    straight = [link.replace(position=(0.0, 0.0, -0.2 - 0.4 * k)) for k, link in enumerate(links)]
    chain = asp.RigidBodies(
        straight, joints=[*joints, asp.Hinge(0, anchor=anchors[0], axis=axes[0])]
    )
    forces, torques = chain.joint_reactions(asp.simulate(chain, dt=1e-3, t_end=0.01))
    below = np.cumsum(hung[::-1], axis=0)[::-1]
    np.testing.assert_allclose(forces, np.broadcast_to(-below[[1, 2, 0]], (11, 3, 3)), atol=1e-8)
    np.testing.assert_allclose(torques, 0.0, atol=1e-8)


def test_weld_of_a_bracket_carries_its_weight_and_moment():
    arm, mass = np.array([0.5, 0.2, 0.1]), 2.0
    turn = Rotation.from_euler("xyz", [0.3, -0.4, 1.1])
    x, y, z, w = turn.as_quat()
    wall = asp.Body.box(mass, half_sizes=(0.1, 0.2, 0.3), position=arm, orientation=(w, x, y, z))
    tip = asp.Body.ball(1.0, radius=0.1, position=2.0 * arm)
    system = asp.RigidBodies([wall, tip], joints=[asp.Weld(0), asp.Weld(1, other=0)])
    forces, torques = system.joint_reactions(asp.simulate(system, dt=1e-3, t_end=0.01))
    np.testing.assert_allclose(forces[1:, :, 2], np.broadcast_to([3.0 * G, G], (10, 2)), rtol=1e-9)
    np.testing.assert_allclose(forces[1:, :, :2], 0.0, atol=1e-8)
    load = np.array([0.0, 0.0, -G])
    # About the centre of the bracket, the weight at the tip and the wall's force have torques.
    moment = -np.cross(arm, load)
    np.testing.assert_allclose(torques[-1, 0], moment, atol=1e-8)
    np.testing.assert_allclose(torques[-1, 1], 0.0, atol=1e-8)


def test_hinge_of_a_pendulum_carries_weight_and_centripetal_force():
    turn, mass, arm = Rotation.random(random_state=3), 2.0, ROD[2]
    system, errors = pendulum(1.0, turn), []
    square = (ROD[0] ** 2 + arm**2) / 3.0
    for dt in (4e-3, 2e-3):
        motion = asp.simulate(system, dt=dt, t_end=1.0)
        forces, torques = system.joint_reactions(motion)
        middle = motion.t[1:] - 0.5 * dt
        angle = swing(1.0, np.append(0.0, middle))[1:]
        rate = G * arm / (arm**2 + square)
        along = mass * (G * np.cos(angle) + 2.0 * arm * rate * (np.cos(angle) - np.cos(1.0)))
        across = mass * (G - arm * rate) * np.sin(angle)
        rod = np.column_stack([np.sin(angle), 0.0 * angle, -np.cos(angle)])
        side = np.column_stack([np.cos(angle), 0.0 * angle, np.sin(angle)])
        expected = turn.apply(across[:, None] * side - along[:, None] * rod)
        errors.append(np.abs(forces[1:, 0] - expected).max())
        np.testing.assert_allclose(torques[1:], 0.0, atol=1e-3)
    assert errors[1] < 1e-3
    assert 3.6 < errors[0] / errors[1] < 4.4


def test_reactions_and_forces_of_the_floor_balance_the_weight_of_a_leg():
    system, _ = leg(asp.FrictionLaw(asp.Ellipse(0.5, 0.3, angle=0.4), asp.Ellipse(1.0, 3.0)))
    motion = asp.simulate(system, dt=1e-3, t_end=0.1)
    forces, torques = system.joint_reactions(motion)
    assert np.isnan(forces[0]).all()
    floor = system.contact_forces(motion, frame="world")[1:, 0]
    weight = np.array([0.0, 0.0, G])
    np.testing.assert_allclose(
        forces[1:, 0] + floor, np.broadcast_to(2.0 * weight, (100, 3)), atol=1e-6
    )
    np.testing.assert_allclose(forces[1:, 1] + floor, np.broadcast_to(weight, (100, 3)), atol=1e-6)
    np.testing.assert_allclose(torques[1:], 0.0, atol=1e-6)
    # Planar rods hang with the same force.
    rod = asp.PlanarBody(1.5, inertia=0.02, position=(0.0, -0.5))
    flat = asp.RigidBodies([rod], joints=[asp.Hinge(0, anchor=(0.0, 0.0))])
    forces, torques = flat.joint_reactions(asp.simulate(flat, dt=1e-3, t_end=0.01))
    np.testing.assert_allclose(forces[:, 0], np.broadcast_to([0.0, 1.5 * G], (11, 2)), atol=1e-9)
    assert torques.shape == (11, 1)
