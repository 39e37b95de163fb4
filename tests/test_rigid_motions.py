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
