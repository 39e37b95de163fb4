"""Motions of rigid bodies against closed forms, invariants and simpler systems."""

import asperity as asp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G = 9.81
FLOOR = asp.Plane()


def test_given_quaternions_are_normalised():
    x, y, z, w = Rotation.random(random_state=2).as_quat()
    orientation = np.array([w, x, y, z])
    state = {"u0": [0.0, 0.0, 0.0, 1.0, 2.0, 3.0], "dt": 1e-2, "t_end": 1.0}
    system = asp.RigidBodies([asp.Body(1.0, inertia=(1.0, 2.0, 2.5))], gravity=np.zeros(3))
    expected = asp.simulate(system, q0=[0.0, 0.0, 0.0, *orientation], **state)
    for length in (1e-200, 0.3, 2.0, 1e200):
        given = [0.0, 0.0, 0.0, *(length * orientation)]
        motion = asp.simulate(system, q0=given, **state)
        np.testing.assert_allclose(np.linalg.norm(motion.q[:, 3:], axis=1), 1.0, rtol=2e-15)
        np.testing.assert_allclose(motion.q, expected.q, atol=1e-12)
    # What is of length one stays to the bit, so that a run can be continued.
    again = asp.simulate(system, q0=expected.q[-1], **state)
    np.testing.assert_array_equal(again.q[0], expected.q[-1])


@pytest.mark.parametrize("body", [0, 1])
def test_orientation_of_length_zero_is_refused(body):
    system = asp.RigidBodies([asp.Body.ball(1.0, radius=0.1)] * 2)
    start = system.q0.copy()
    start[7 * body + 3 : 7 * body + 7] = 0.0
    with pytest.raises(asp.ParameterError, match=rf"q0: the quaternion {body}, \(w, x, y, z\)"):
        asp.simulate(system, dt=0.1, t_end=0.1, q0=start)


def dropped_ball(spin, *, restitution=0.0, tangential=0.0):
    """Return a ball of 1 kg, R = 0.1 m, dropped from 1 m while turning about −y."""
    ball = asp.Body.ball(
        1.0, radius=0.1, position=(0.0, 0.0, 1.0), angular_velocity=(0.0, -spin, 0.0)
    )
    contact = asp.SpherePlane(
        0,
        radius=0.1,
        plane=FLOOR,
        law=asp.FrictionLaw.isotropic(0.2),
        normal_restitution=restitution,
        tangential_restitution=tangential,
    )
    return asp.RigidBodies([ball], pairs=[contact])


def test_dropped_ball_lands_in_time_and_comes_to_rest_after_infinitely_many_impacts():
    motion = asp.simulate(dropped_ball(0.0, restitution=0.5), dt=1e-4, t_end=1.5)
    landing = np.sqrt(2 * 0.9 / G)
    first = np.flatnonzero(np.diff(motion.u[:, 2]) > 1.0)[0]
    assert motion.t[first] == pytest.approx(landing, abs=2e-4)
    assert motion.u[first, 2] == pytest.approx(-4.2021423, abs=2e-3)
    assert motion.u[first + 1, 2] == pytest.approx(0.5 * 4.2021423, abs=2e-3)
    last = motion.t[np.flatnonzero(np.abs(motion.u[:, 2]) > 1e-9)[-1]]
    assert last == pytest.approx(1.2850588, abs=2e-2)
    assert motion.q[-1, 2] == pytest.approx(0.1, abs=2e-4)


def test_spinning_ball_slides_after_the_impact_and_then_rolls():
    system = dropped_ball(50.0)
    motion = asp.simulate(system, dt=1e-4, t_end=1.0)
    spin = system.angular_velocities(motion)[:, 0, 1]
    after = np.searchsorted(motion.t, 0.4283529) + 3
    # μ times the normal percussion; a few steps of sliding friction follow.
    assert motion.u[after, 0] == pytest.approx(-0.840428, abs=2e-3)
    assert spin[after] == pytest.approx(-28.989288, abs=5e-2)
    rolling = motion.t[np.flatnonzero(motion.phase[:, 0] == asp.Phase.SLIP)[-1]]
    assert rolling == pytest.approx(0.728120, abs=1e-3)
    assert motion.u[-1, 0] == pytest.approx(-10 / 7, rel=1e-4)
    assert spin[-1] == pytest.approx(-100 / 7, rel=1e-4)


def test_slowly_spinning_ball_rolls_at_once():
    motion = asp.simulate(dropped_ball(10.0), dt=1e-4, t_end=0.5)
    assert not (motion.phase == asp.Phase.SLIP).any()
    assert motion.u[-1, 0] == pytest.approx(-2 / 7, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_box_below_the_angle_of_friction_does_not_drift(seed):
    turn = Rotation.random(random_state=seed)
    incline = turn * Rotation.from_euler("x", 0.3)
    (x, y, z, w), axes = incline.as_quat(), incline.as_matrix()
    half = (0.3, 0.2, 0.1)
    box = asp.Body.box(
        2.0, half_sizes=half, position=axes @ [0.0, 0.0, 0.1], orientation=(w, x, y, z)
    )
    plane = asp.Plane(normal=axes[:, 2], axis=axes[:, 0])
    floor = asp.BoxPlane(0, half_sizes=half, plane=plane, law=asp.FrictionLaw.isotropic(0.5))
    system = asp.RigidBodies([box], pairs=[floor], gravity=turn.apply([0.0, 0.0, -G]))
    motion = asp.simulate(system, dt=1e-2, t_end=60.0, tolerance=1e-12)
    np.testing.assert_allclose(system.positions(motion) - motion.q[0, :3], 0.0, atol=1e-12)
    np.testing.assert_allclose(motion.q - motion.q[0], 0.0, atol=1e-11)


def rocking_block(angle):
    """Return a block on its lower left corner, tilted by `angle`, that cannot slip."""
    half = np.array([0.0125, 0.05])
    corner = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ (-half)
    block = asp.PlanarBody.box(1.0, half_sizes=half, position=-corner, angle=angle)
    floor = asp.BoxPlane(
        0, half_sizes=half, plane=asp.Line(), law=asp.FrictionLaw.isotropic(100.0, dimension=1)
    )
    return asp.RigidBodies([block], pairs=[floor])


def test_rocking_block_falls_in_time_and_loses_housners_share_at_each_impact():
    motion = asp.simulate(rocking_block(np.deg2rad(8.0)), dt=1e-4, t_end=1.2)
    angle, rate = motion.q[:, 2], motion.u[:, 2]
    impact = np.flatnonzero(np.diff(np.sign(angle)))[0]
    assert motion.t[impact] == pytest.approx(0.1246523, abs=5e-4)
    ratio = 1 - 1.5 * np.sin(np.arctan(0.25)) ** 2
    assert rate[impact + 3] / rate[impact - 3] == pytest.approx(ratio, abs=1e-2)
    turning = np.flatnonzero(np.diff(np.sign(rate)) * np.sign(angle[:-1]) < 0)
    peaks = np.abs(np.rad2deg(angle[turning]))
    peaks = peaks[peaks > 1.0][:4]
    np.testing.assert_allclose(peaks[-3:], [6.07183, 4.76791, 3.80877], atol=5e-2)


def test_sliding_box_stops_after_the_distance_of_coulombs_law():
    box = asp.Body.box(
        2.0, half_sizes=(0.2, 0.2, 0.02), position=(0.0, 0.0, 0.02), velocity=(1.0, 0.5, 0.0)
    )
    floor = asp.BoxPlane(
        0, half_sizes=(0.2, 0.2, 0.02), plane=FLOOR, law=asp.FrictionLaw.isotropic(0.3)
    )
    system = asp.RigidBodies([box], pairs=[floor])
    motion = asp.simulate(system, dt=1e-3, t_end=1.0, until_rest=True)
    speed = np.hypot(1.0, 0.5)
    assert motion.status is asp.Outcome.AT_REST
    stop = np.flatnonzero(np.abs(motion.u[:, 0]) < 1e-6)[0]
    assert motion.t[stop] == pytest.approx(speed / (0.3 * G), abs=2e-3)
    way = system.positions(motion)[-1, 0] - box.position
    np.testing.assert_allclose(way[:2], speed / (2 * 0.3 * G) * np.array([1.0, 0.5]), rtol=1e-2)


@pytest.mark.parametrize("carrier", ["plane", "body", "function"])
def test_anisotropic_friction_deflects_a_sliding_body_as_it_does_the_sliding_point(carrier):
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(2.0, 1.0))
    turn = 0.4
    axis = (np.cos(turn), np.sin(turn), 0.0)
    plane = asp.Plane(axis=axis) if carrier == "plane" else FLOOR
    frames = {
        "plane": "plane",
        "body": asp.BodyAxis(axis),
        "function": lambda x1, x2: turn,
    }
    # The point of contact lies in the centre of mass: the body does not turn.
    body = asp.Body.ball(0.2, radius=0.1, velocity=(1.0, 0.3, 0.0))
    contact = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=plane, law=law, frame=frames[carrier])
    options = {"dt": 1e-3, "t_end": 1.0}
    motion = asp.simulate(asp.RigidBodies([body], pairs=[contact]), **options)
    back = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    point = asp.simulate(asp.SlidingPoint(0.2, law=law), u0=back @ [1.0, 0.3], **options)
    np.testing.assert_allclose(motion.q[:, :2] @ back.T, point.q, atol=1e-9)
    np.testing.assert_allclose(motion.force[1:, 0], point.force[1:, 0], atol=1e-7)


def test_circular_grooves_guide_a_body_on_a_circle():
    # Friction is strong across the grooves, away from the centre, and weak along them.
    law = asp.FrictionLaw.associated(asp.Ellipse(50.0, 1e-3))
    body = asp.Body.ball(0.1, radius=0.01, position=(1.0, 0.0, 0.0), velocity=(0.0, 2.0, 0.0))
    grooves = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=FLOOR, law=law, frame="polar")
    motion = asp.simulate(asp.RigidBodies([body], pairs=[grooves]), dt=1e-3, t_end=3.0)
    # The step runs along tangents: the radius grows by ½ v² Δt a second.
    np.testing.assert_allclose(np.hypot(*motion.q[:, :2].T), 1.0, atol=7e-3)
    assert np.arctan2(motion.q[-1, 1], motion.q[-1, 0]) == pytest.approx(6.0 - 2 * np.pi, abs=0.1)


def test_belt_and_turntable_carry_a_body_along():
    law = asp.FrictionLaw.isotropic(0.5)
    half = (0.05, 0.05, 0.01)
    box = asp.Body.box(1.0, half_sizes=half, position=(0.3, 0.0, 0.01))
    belt = asp.Plane(axis=(0.0, 1.0, 0.0), velocity=(0.4, 0.0))
    system = asp.RigidBodies([box], pairs=[asp.BoxPlane(0, half_sizes=half, plane=belt, law=law)])
    motion = asp.simulate(system, dt=1e-3, t_end=0.5)
    np.testing.assert_allclose(motion.u[-1], [0.0, 0.4, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    assert motion.q[-1, 1] == pytest.approx(0.4 * 0.5 - 0.4**2 / (2 * 0.5 * G), abs=1e-3)

    table = asp.Plane(spin=1.0)
    system = asp.RigidBodies([box], pairs=[asp.BoxPlane(0, half_sizes=half, plane=table, law=law)])
    motion = asp.simulate(system, dt=1e-3, t_end=4.0)
    np.testing.assert_allclose(system.angular_velocities(motion)[-1, 0], [0, 0, 1], atol=1e-6)
    radius = np.hypot(*motion.q[-1, :2])
    np.testing.assert_allclose(np.hypot(*motion.u[-1, :2]), radius, rtol=1e-3)


def test_plane_on_a_body_carries_another_one_and_is_pushed_back():
    law = asp.FrictionLaw.isotropic(0.4)
    sledge = asp.Body.box(3.0, half_sizes=(0.5, 0.5, 0.05), velocity=(1.0, 0.0, 0.0))
    half = (0.1, 0.1, 0.01)
    load = asp.Body.box(1.0, half_sizes=half, position=(0.0, 0.0, 0.06))
    deck = asp.Plane(point=(0.0, 0.0, 0.05), body=0)
    rail = asp.Plane(point=(0.0, 0.0, -0.05))
    smooth = asp.FrictionLaw.isotropic(1e-12)
    system = asp.RigidBodies(
        [sledge, load],
        pairs=[
            asp.BoxPlane(1, half_sizes=half, plane=deck, law=law),
            asp.BoxPlane(0, half_sizes=(0.5, 0.5, 0.05), plane=rail, law=smooth),
        ],
    )
    motion = asp.simulate(system, dt=1e-3, t_end=1.0)
    np.testing.assert_allclose(motion.u[-1, [0, 6]], 0.75, atol=1e-6)
    np.testing.assert_allclose(system.momentum(motion)[:, 0], 3.0, atol=1e-6)


def test_spinning_disk_on_the_spot_stops_by_drilling_friction():
    disk = asp.Body.cylinder(1.0, radius=0.1, height=0.02, angular_velocity=(0.0, 0.0, 20.0))
    law = asp.FrictionLaw.associated(asp.CoulombContensou(0.3, pressure="uniform"))
    below = (0.0, 0.0, -0.01)
    patch = asp.PointPlane(0, point=below, plane=asp.Plane(point=below), law=law, patch_radius=0.1)
    system = asp.RigidBodies([disk], pairs=[patch])
    motion = asp.simulate(system, dt=1e-3, t_end=1.0, until_rest=True)
    stop = 20.0 * (0.5 * 0.1**2) / (2 / 3 * 0.3 * G * 0.1)
    assert motion.t[-1] == pytest.approx(stop, abs=4e-3)
    np.testing.assert_allclose(motion.force[1, 0], [0.0, 0.0, -2 / 3 * 0.3 * G], atol=1e-6)


def test_spheres_exchange_their_velocities_in_a_central_elastic_impact():
    left = asp.Body.ball(1.0, radius=0.1, velocity=(1.0, 0.0, 0.0))
    right = asp.Body.ball(1.0, radius=0.1, position=(0.5, 0.0, 0.0))
    touch = asp.SphereSphere(
        0,
        radius=0.1,
        other=1,
        other_radius=0.1,
        law=asp.FrictionLaw.isotropic(0.3),
        normal_restitution=1.0,
    )
    system = asp.RigidBodies([left, right], pairs=[touch], gravity=(0.0, 0.0, 0.0))
    motion = asp.simulate(system, dt=1e-3, t_end=1.0)
    np.testing.assert_allclose(motion.u[-1, [0, 6]], [0.0, 1.0], atol=1e-12)


def test_oblique_impact_keeps_momentum_and_angular_momentum():
    bodies = [
        asp.Body.ball(
            1.0, radius=0.1, velocity=(1.0, 0.05, -0.02), angular_velocity=(3.0, -2.0, 9.0)
        ),
        asp.Body.ball(2.5, radius=0.15, position=(0.5, 0.1, 0.02)),
    ]
    touch = asp.SphereSphere(
        0, radius=0.1, other=1, other_radius=0.15, law=asp.FrictionLaw.isotropic(0.1),
        normal_restitution=0.6, tangential_restitution=0.6,
    )  # fmt: skip
    system = asp.RigidBodies(bodies, pairs=[touch], gravity=(0.0, 0.0, 0.0))
    motion = asp.simulate(system, dt=1e-3, t_end=1.0)
    assert (motion.phase == asp.Phase.SLIP).sum() == 1
    np.testing.assert_allclose(np.ptp(system.momentum(motion), axis=0), 0.0, atol=1e-14)
    np.testing.assert_allclose(np.ptp(system.angular_momentum(motion), axis=0), 0.0, atol=1e-13)
    energy = system.energy(motion)
    assert energy[-1] < energy[0]


def test_free_asymmetric_body_keeps_momentum_to_round_off():
    top = asp.Body(
        1.3, inertia=(1.0, 2.0, 2.9), velocity=(0.3, 0.1, -0.2), angular_velocity=(1e-3, 3.0, 1e-3)
    )
    system = asp.RigidBodies([top], gravity=(0.0, 0.0, 0.0))
    motion = asp.simulate(system, dt=1e-2, t_end=60.0)
    np.testing.assert_allclose(system.momentum(motion) / 1.3, [[0.3, 0.1, -0.2]] * len(motion.t))
    spin = system.angular_momentum(motion)
    np.testing.assert_allclose(spin, spin[:1].repeat(len(spin), axis=0), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(motion.q[:, 3:], axis=1), 1.0, atol=1e-14)
    # The tennis racket turns over.
    assert motion.u[:, 4].min() < -2.5


def test_two_bodies_on_a_spring_swing_about_their_centre():
    bodies = [
        asp.PlanarBody(1.0, inertia=1.0),
        asp.PlanarBody(3.0, inertia=1.0, position=(0.5, 0.0)),
    ]
    spring = asp.Spring(
        0, point=(0.0, 0.0), other=1, other_point=(0.0, 0.0), stiffness=30.0, length=0.4
    )
    system = asp.RigidBodies(bodies, springs=[spring], gravity=(0.0, 0.0))
    period = 2 * np.pi * np.sqrt(0.75 / 30.0)
    motion = asp.simulate(system, dt=period / 1000, t_end=period)
    distance = motion.q[:, 3] - motion.q[:, 0]
    assert distance.min() == pytest.approx(0.3, abs=1e-3)
    assert distance[-1] == pytest.approx(0.5, abs=1e-3)
    np.testing.assert_allclose(system.momentum(motion), 0.0, atol=1e-13)
    np.testing.assert_allclose(system.energy(motion), 0.15, rtol=2e-2)


def test_damper_brings_a_body_to_rest():
    body = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, -0.2))
    spring = asp.Spring(0, point=(0.0, 0.0, 0.0), stiffness=50.0, damping=14.0, length=0.1)
    system = asp.RigidBodies([body], springs=[spring])
    motion = asp.simulate(system, dt=1e-3, t_end=10.0)
    assert motion.q[-1, 2] == pytest.approx(-0.1 - G / 50.0, abs=1e-6)
    assert system.energy(motion)[-1] < system.energy(motion)[0]


def gained_energy(angle, speed, tangential):
    """Return by how much a rod that strikes the ground with its end gains energy."""
    rod = asp.PlanarBody(
        1.0,
        inertia=1 / 12,
        position=(0.5 * np.cos(angle), 0.5 * np.sin(angle) + 1e-4),
        angle=angle,
        velocity=(speed, -1.0),
    )
    tip = asp.PointPlane(
        0,
        point=(-0.5, 0.0),
        plane=asp.Line(),
        law=asp.FrictionLaw.isotropic(0.5, dimension=1),
        normal_restitution=0.9,
        tangential_restitution=tangential,
    )
    system = asp.RigidBodies([rod], pairs=[tip], gravity=(0.0, 0.0))
    motion = asp.simulate(system, dt=1e-3, t_end=2e-3)
    assert (motion.phase[1:] != asp.Phase.OPEN).sum() == 1
    before, *_, after = system.energy(motion)
    return after / before - 1.0


def test_energy_may_grow_where_the_coefficients_of_restitution_differ():
    # Kane's paradox.
    cases = [(a, v) for a in np.linspace(0.1, 1.5, 15) for v in np.linspace(-2.0, 2.0, 21)]
    assert max(gained_energy(*case, 0.0) for case in cases) > 0.01
    assert max(gained_energy(*case, 0.9) for case in cases) < 1e-12
