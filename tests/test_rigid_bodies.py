"""Rigid bodies: what they are made of, what is refused, what a trajectory holds."""

import asperity as asp
import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from scipy.spatial.transform import Rotation

G = 9.81
NAN = float("nan")
LAW = asp.FrictionLaw.isotropic(0.5)
LINE_LAW = asp.FrictionLaw.isotropic(0.5, dimension=1)
DRILLING = asp.FrictionLaw.associated(asp.CoulombContensou(0.5))
FLOOR = asp.Plane()
BALL = asp.Body.ball(1.0, radius=0.1)
DISK = asp.PlanarBody.disk(1.0, radius=0.1)
POINT = asp.PointPlane(0, point=(0.0, 0.0, -0.1), plane=FLOOR, law=LAW)
ON_DECK = POINT.replace(plane=asp.Plane(body=7))
SPHERES = asp.SphereSphere(0, radius=0.1, other=1, other_radius=0.1, law=LAW)
SPRING = asp.Spring(0, point=(0.0, 0.0, 0.0), stiffness=1.0)
HALF = (0.3, 0.2, 0.1)


def random_rotation(seed):
    turn = Rotation.random(random_state=seed)
    x, y, z, w = turn.as_quat()
    return turn.as_matrix(), (w, x, y, z)


def box_on_incline(slope=0.3, mu=0.5):
    """Return a box at rest on an inclined plane, together with the rotation of the plane."""
    turn = Rotation.from_euler("x", slope)
    x, y, z, w = turn.as_quat()
    axes = turn.as_matrix()
    body = asp.Body.box(
        2.0, half_sizes=HALF, position=axes @ [0.0, 0.0, 0.1], orientation=(w, x, y, z)
    )
    plane = asp.Plane(normal=axes[:, 2], axis=axes[:, 0])
    system = asp.RigidBodies(
        [body],
        pairs=[asp.BoxPlane(0, half_sizes=HALF, plane=plane, law=asp.FrictionLaw.isotropic(mu))],
    )
    return system, axes


def test_rotations_of_scipy_are_orientations():
    turn = Rotation.from_rotvec([0.3, -0.7, 0.2])
    x, y, z, w = turn.as_quat()
    given = asp.Body.box(2.0, half_sizes=HALF, orientation=turn)
    assert given == asp.Body.box(2.0, half_sizes=HALF, orientation=(w, x, y, z))
    assert given == asp.Body.box(2.0, half_sizes=HALF).replace(orientation=turn)
    system = asp.RigidBodies([given.replace(angular_velocity=(1.0, 2.0, 3.0))], pairs=[])
    run = asp.simulate(system, dt=1e-3, t_end=1e-3)
    np.testing.assert_allclose(system.rotations(run)[0, 0], turn.as_matrix(), atol=1e-15)
    for kind in (
        asp.Body.ball(1.0, radius=0.1, orientation=turn),
        asp.Body(1.0, inertia=1.0, orientation=turn),
    ):
        np.testing.assert_array_equal(kind.orientation, given.orientation)


def test_planes_are_oriented_by_rotations_and_quaternions():
    turn = Rotation.from_rotvec([0.3, -0.7, 0.2])
    x, y, z, w = turn.as_quat()
    plane = asp.Plane.oriented(turn, velocity=(0.1, 0.2), body=3)
    np.testing.assert_allclose(plane.axes, turn.as_matrix().T, atol=1e-15)
    assert plane == asp.Plane.oriented((w, x, y, z), velocity=(0.1, 0.2), body=3)
    assert asp.Plane.oriented((1.0, 0.0, 0.0, 0.0)) == FLOOR


BAD_INPUT = [
    # bodies
    ("mass", ParameterError, lambda: asp.Body(0.0, inertia=(1.0, 1.0, 1.0))),
    ("mass", ParameterError, lambda: asp.Body.box(-1.0, half_sizes=HALF)),
    ("mass", ParameterError, lambda: asp.Body.ball(NAN, radius=1.0)),
    ("inertia", DimensionError, lambda: asp.Body(1.0, inertia=(1.0, 1.0))),
    ("inertia", ParameterError, lambda: asp.Body(1.0, inertia=(1.0, 1.0, 0.0))),
    ("inertia", ParameterError, lambda: asp.Body(1.0, inertia=(1.0, 1.0, 2.5))),
    ("inertia", ParameterError, lambda: asp.Body(1.0, inertia=np.eye(3) + np.eye(3, k=1))),
    ("position", DimensionError, lambda: BALL.replace(position=(0.0, 0.0))),
    ("orientation", ParameterError, lambda: BALL.replace(orientation=np.zeros(4))),
    ("orientation", DimensionError, lambda: BALL.replace(orientation=np.eye(3))),
    ("velocity", ParameterError, lambda: BALL.replace(velocity=(NAN, 0.0, 0.0))),
    ("angular_velocity", DimensionError, lambda: BALL.replace(angular_velocity=1.0)),
    ("force", DimensionError, lambda: BALL.replace(force=1.0)),
    ("torque", ParameterError, lambda: BALL.replace(torque=(0.0, 0.0, NAN))),
    ("half_sizes", ParameterError, lambda: asp.Body.box(1.0, half_sizes=(1.0, 0.0, 1.0))),
    ("half_sizes", DimensionError, lambda: asp.Body.box(1.0, half_sizes=(1.0, 1.0))),
    ("radius", ParameterError, lambda: asp.Body.ball(1.0, radius=-0.1)),
    ("height", ParameterError, lambda: asp.Body.cylinder(1.0, radius=0.1, height=0.0)),
    ("inertia", ParameterError, lambda: asp.PlanarBody(1.0, inertia=0.0)),
    ("angle", DimensionError, lambda: DISK.replace(angle=(0.0, 0.0))),
    ("half_sizes", DimensionError, lambda: asp.PlanarBody.box(1.0, half_sizes=HALF)),
    ("radius", ParameterError, lambda: asp.PlanarBody.disk(1.0, radius=0.0)),
    # surfaces
    ("normal", ParameterError, lambda: asp.Plane(normal=np.zeros(3))),
    ("axis", ParameterError, lambda: asp.Plane(normal=(1.0, 0.0, 0.0))),
    ("velocity", DimensionError, lambda: asp.Plane(velocity=(1.0, 0.0, 0.0))),
    ("spin", ParameterError, lambda: asp.Plane(spin=NAN)),
    ("body", ParameterError, lambda: asp.Plane(body=-1)),
    ("body", ParameterError, lambda: asp.Line(body=0.5)),
    ("normal", DimensionError, lambda: asp.Line(normal=(0.0, 0.0, 1.0))),
    ("axis", ParameterError, lambda: asp.BodyAxis(np.zeros(3))),
    # pairs
    ("plane", ParameterError, lambda: POINT.replace(plane=LAW)),
    ("plane", ParameterError, lambda: POINT.replace(plane=asp.Plane(body=0))),
    ("law", ParameterError, lambda: POINT.replace(law=0.5)),
    ("law", DimensionError, lambda: POINT.replace(law=LINE_LAW)),
    ("law", DimensionError, lambda: asp.SpherePlane(0, radius=0.1, plane=asp.Line(), law=LAW)),
    ("point", DimensionError, lambda: POINT.replace(point=(0.0, 0.0))),
    ("body", ParameterError, lambda: POINT.replace(body=-1)),
    ("frame", ParameterError, lambda: POINT.replace(frame="world")),
    ("frame", ParameterError, lambda: POINT.replace(frame=0.3)),
    ("frame", ParameterError, lambda: SPHERES.replace(frame="polar")),
    (
        "frame",
        ParameterError,
        lambda: asp.SpherePlane(0, radius=0.1, plane=asp.Line(), law=LINE_LAW, frame="polar"),
    ),
    ("patch_radius", ParameterError, lambda: POINT.replace(law=DRILLING)),
    ("patch_radius", ParameterError, lambda: POINT.replace(patch_radius=0.1)),
    ("patch_radius", ParameterError, lambda: POINT.replace(law=DRILLING, patch_radius=0.0)),
    ("normal_restitution", ParameterError, lambda: POINT.replace(normal_restitution=1.1)),
    ("tangential_restitution", ParameterError, lambda: POINT.replace(tangential_restitution=-0.1)),
    ("normal_force", ParameterError, lambda: POINT.replace(normal_force=-1.0)),
    ("radius", ParameterError, lambda: asp.SpherePlane(0, radius=0.0, plane=FLOOR, law=LAW)),
    (
        "center",
        DimensionError,
        lambda: asp.SpherePlane(0, radius=0.1, plane=FLOOR, law=LAW, center=(0.0, 0.0)),
    ),
    (
        "half_sizes",
        DimensionError,
        lambda: asp.BoxPlane(0, half_sizes=(0.1, 0.1), plane=FLOOR, law=LAW),
    ),
    ("other", ParameterError, lambda: SPHERES.replace(other=0)),
    ("other_radius", ParameterError, lambda: SPHERES.replace(other_radius=-1.0)),
    # springs
    ("stiffness", ParameterError, lambda: SPRING.replace(stiffness=-1.0)),
    ("damping", ParameterError, lambda: SPRING.replace(damping=NAN)),
    ("length", ParameterError, lambda: SPRING.replace(length=-0.1)),
    ("other", ParameterError, lambda: SPRING.replace(other=0)),
    ("point", DimensionError, lambda: asp.Spring(0, point=(0.0,), stiffness=1.0)),
    ("other_point", DimensionError, lambda: SPRING.replace(other_point=(0.0, 0.0))),
    # systems
    ("bodies", DimensionError, lambda: asp.RigidBodies([])),
    ("bodies", ParameterError, lambda: asp.RigidBodies(BALL)),
    ("bodies", ParameterError, lambda: asp.RigidBodies([BALL, DISK])),
    ("pairs", ParameterError, lambda: asp.RigidBodies([BALL], pairs=[SPRING])),
    ("pairs", DimensionError, lambda: asp.RigidBodies([DISK], pairs=[POINT])),
    ("springs", ParameterError, lambda: asp.RigidBodies([BALL], springs=[POINT])),
    ("springs", DimensionError, lambda: asp.RigidBodies([DISK], springs=[SPRING])),
    ("gravity", DimensionError, lambda: asp.RigidBodies([BALL], gravity=(0.0, -G))),
    (
        "pairs[0].body",
        ParameterError,
        lambda: asp.RigidBodies([BALL], pairs=[POINT.replace(body=1)]),
    ),
    ("pairs[0].plane.body", ParameterError, lambda: asp.RigidBodies([BALL], pairs=[ON_DECK])),
    ("pairs[0].other", ParameterError, lambda: asp.RigidBodies([BALL], pairs=[SPHERES])),
    (
        "springs[0].other",
        ParameterError,
        lambda: asp.RigidBodies([BALL], springs=[SPRING.replace(other=4)]),
    ),
    # simulations
    ("q0", DimensionError, lambda: asp.simulate(TWO, dt=0.1, t_end=0.1, q0=np.zeros(12))),
    ("u0", DimensionError, lambda: asp.simulate(TWO, dt=0.1, t_end=0.1, u0=np.zeros(14))),
    ("trajectory", ParameterError, lambda: TWO.energy(3.0)),
    ("trajectory", DimensionError, lambda: TWO.positions(FALL)),
    ("about", DimensionError, lambda: FALLING.angular_momentum(FALL, about=(0.0, 0.0))),
    ("frame", ParameterError, lambda: FALLING.contact_forces(FALL, frame="plane")),
]
TWO = asp.RigidBodies([BALL, BALL.replace(position=(0.5, 0.0, 0.0))], pairs=[SPHERES])
FALLING = asp.RigidBodies([BALL])
FALL = asp.simulate(FALLING, dt=0.1, t_end=0.2)


@pytest.mark.parametrize(
    ("argument", "kind", "call"),
    BAD_INPUT,
    ids=[f"{i}-{case[0]}" for i, case in enumerate(BAD_INPUT)],
)
def test_bad_input_is_refused_by_name(argument, kind, call):
    with pytest.raises(kind) as caught:
        call()
    assert caught.value.argument == argument
    assert len(caught.value.message) > 8


def test_moments_of_inertia():
    np.testing.assert_allclose(
        asp.Body.box(3.0, half_sizes=HALF).inertia.diagonal(), [0.05, 0.1, 0.13], rtol=1e-14
    )
    np.testing.assert_allclose(asp.Body.cylinder(12.0, radius=0.1, height=0.2).inertia[2, 2], 0.06)
    np.testing.assert_allclose(asp.Body.cylinder(12.0, radius=0.1, height=0.2).inertia[0, 0], 0.07)
    assert asp.PlanarBody.box(3.0, half_sizes=(0.3, 0.2)).inertia == pytest.approx(0.13)
    full = asp.Body(1.0, inertia=np.diag([1.0, 2.0, 2.5]))
    assert full == asp.Body(1.0, inertia=(1.0, 2.0, 2.5))


def test_initial_state_comes_from_the_bodies():
    axes, orientation = random_rotation(1)
    body = BALL.replace(
        position=(1.0, 2.0, 3.0),
        orientation=2.0 * np.array(orientation),
        velocity=(4.0, 5.0, 6.0),
        angular_velocity=(0.1, 0.2, 0.3),
    )
    system = asp.RigidBodies([BALL, body])
    assert (system.dof, system.coordinates) == (12, 14)
    np.testing.assert_allclose(system.q0[7:], [1.0, 2.0, 3.0, *orientation])
    np.testing.assert_allclose(system.u0[6:], [4.0, 5.0, 6.0, *(axes.T @ [0.1, 0.2, 0.3])])
    motion = asp.simulate(system, dt=0.1, t_end=0.2)
    np.testing.assert_array_equal(motion.q[0], system.q0)
    np.testing.assert_allclose(system.positions(motion)[0], [[0, 0, 0], [1, 2, 3]])
    np.testing.assert_allclose(system.rotations(motion)[0, 1], axes, atol=1e-15)
    np.testing.assert_allclose(system.angular_velocities(motion)[:, 1], [[0.1, 0.2, 0.3]] * 3)


@pytest.mark.parametrize(
    ("run", "options"), [(asp.simulate, {"dt": 1e-3}), (asp.integrate, {})], ids=["step", "event"]
)
def test_bodies_that_overlap_at_the_start_are_refused(run, options):
    law = asp.FrictionLaw.isotropic(0.3)
    balls = [
        asp.Body.ball(1.0, radius=0.1, position=(x, 0.0, 5.0), name=name)
        for x, name in ((0.0, "left"), (0.19, "right"))
    ]
    touch = asp.SphereSphere(0, radius=0.1, other=1, other_radius=0.1, law=law)
    system = asp.RigidBodies(balls, pairs=[touch])
    with pytest.raises(ParameterError, match=r"left on right does by 0.01 m") as refused:
        run(system, t_end=0.1, **options)
    assert refused.value.argument == "system"
    apart = system.q0.copy()
    apart[7] = 0.2
    run(system, t_end=0.1, q0=apart, **options)
    with pytest.raises(ParameterError, match="left on right") as refused:
        run(system, t_end=0.1, q0=3.0 * (system.q0 == 1.0) + 5.0 * (system.q0 == 5.0), **options)
    assert refused.value.argument == "q0"

    half = (0.3, 0.2, 0.1)
    tilted = asp.axis_angle((0.0, 1.0, 0.0), angle=0.5)
    # The lower edge of a box that is turned by 0.5 about y is deeper by its half edges.
    height = 0.3 * np.sin(0.5) + 0.1 * np.cos(0.5)
    for above, deep in ((0.0, False), (-1e-12, False), (-1e-6, True)):
        box = asp.Body.box(
            1.0, half_sizes=half, position=(9.0, 0.0, height + above), orientation=2.0 * tilted
        )
        feet = asp.BoxPlane(0, half_sizes=half, plane=asp.Plane(), law=law)
        system = asp.RigidBodies([box], pairs=[feet])
        if deep:
            with pytest.raises(ParameterError, match=r"body 0 on plane corner \d does by 1e-06 m"):
                run(system, t_end=0.01, **options)
        else:
            run(system, t_end=0.01, **options)


def test_an_overlap_is_taken_as_a_state():
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    disk = asp.PlanarBody.disk(1.0, radius=0.1, position=(0.0, 0.09))
    foot = asp.PointPlane(0, point=(0.0, -0.1), plane=asp.Line(), law=law)
    system = asp.RigidBodies([disk], pairs=[foot])
    with pytest.raises(ParameterError, match="system: must not let bodies overlap"):
        asp.simulate(system, dt=1e-3, t_end=0.1)
    sunk = asp.simulate(system, dt=1e-3, t_end=0.1, start=asp.State(system.q0, system.u0))
    np.testing.assert_allclose(sunk.q[-1], system.q0, atol=1e-12)
    # What time stepping itself has let overlap goes on.
    dropped = asp.RigidBodies([disk.replace(position=(0.0, 0.15))], pairs=[foot])
    landed = asp.simulate(dropped, dt=1e-2, t_end=0.5)
    assert landed.q[-1, 1] < 0.1
    assert asp.simulate(dropped, dt=1e-2, t_end=0.6, start=landed).steps == 10
    # `integrate` moves the contact apart until it touches: the body rests on the line.
    rest = asp.integrate(dropped, t_end=0.6, start=landed)
    np.testing.assert_allclose(rest.q[-1, 1], 0.1, atol=1e-12)
    with pytest.raises(ParameterError, match="overlap"):
        asp.integrate(dropped, t_end=0.6, start=asp.State(landed.q[-1], landed.u[-1]))

    # A box that has come to rest on four corners, in space.
    half = (0.3, 0.2, 0.1)
    box = asp.Body.box(
        1.0,
        half_sizes=half,
        position=(0.0, 0.0, 0.3),
        orientation=asp.axis_angle((1.0, 0.3, 0.0), angle=0.2),
        velocity=(1.0, 0.0, 0.0),
    )
    law = asp.FrictionLaw.isotropic(0.3)
    tumbling = asp.RigidBodies(
        [box], pairs=[asp.BoxPlane(0, half_sizes=half, plane=asp.Plane(), law=law)]
    )
    landed = asp.simulate(tumbling, dt=1e-3, t_end=1.0)
    assert landed.q[-1, 2] < 0.0999
    rest = asp.integrate(tumbling, t_end=1.1, start=landed)
    np.testing.assert_allclose(rest.q[-1, 2], 0.1, atol=1e-12)
    np.testing.assert_allclose(rest.u[-1], 0.0, atol=1e-9)


def test_contacts_are_labelled():
    deck = asp.Plane(body=0)
    system = asp.RigidBodies(
        [BALL, BALL], pairs=[SPHERES, asp.BoxPlane(1, half_sizes=HALF, plane=deck, law=LAW)]
    )
    assert len(system.contacts) == 9
    assert system.contacts[0] == (0, 0)
    assert system.contacts[8].pair == 1
    assert system.contacts[8].corner == 7
    run = asp.simulate(system, dt=1e-3, t_end=1e-3, start=asp.State(system.q0, system.u0))
    points = system.contact_points(run)[0, 1:]
    signs = [[-1 if k >> i & 1 == 0 else 1 for i in range(3)] for k in range(8)]
    np.testing.assert_allclose(points, signs * np.array(HALF), atol=1e-15)


def test_box_on_an_incline_stays_and_its_forces_balance_the_weight_in_every_frame():
    system, axes = box_on_incline()
    # What the tolerance leaves adds up over 200 steps.
    motion = asp.simulate(system, dt=1e-2, t_end=2.0, tolerance=1e-13)
    np.testing.assert_allclose(system.positions(motion) - motion.q[0, :3], 0.0, atol=1e-12)
    surface = system.contact_forces(motion)[1:]
    world = system.contact_forces(motion, frame="world")[1:]
    body = system.contact_forces(motion, frame="body")[1:]
    assert np.isnan(system.contact_forces(motion)[0]).all()
    np.testing.assert_allclose(world.sum(axis=1), [[0.0, 0.0, 2.0 * G]] * 200, atol=1e-8)
    np.testing.assert_allclose(surface @ axes.T, world, atol=1e-10)
    # The body's axes are those of the plane.
    np.testing.assert_allclose(body, surface, atol=1e-9)
    np.testing.assert_array_equal(surface[..., 2], motion.normal_force[1:])
    below = np.flatnonzero(np.array([label.corner for label in system.contacts]) < 4)
    assert (surface[:, below, 2] >= 0.0).all()


def test_prescribed_normal_force_presses_without_a_gap():
    body = BALL.replace(velocity=(1.0, 0.0, 0.0))
    clamp = asp.PointPlane(0, point=(0.0, 0.0, 0.0), plane=FLOOR, law=LAW, normal_force=4.0)
    system = asp.RigidBodies(
        [body.replace(force=(0.0, 0.0, -4.0))], pairs=[clamp], gravity=np.zeros(3)
    )
    motion = asp.simulate(system, dt=1e-3, t_end=0.4)
    np.testing.assert_allclose(motion.u[-1, 0], 1.0 - 0.5 * 4.0 * 0.4, rtol=1e-9)
    np.testing.assert_allclose(motion.q[:, 2], 0.0, atol=1e-12)
    np.testing.assert_array_equal(motion.normal_force[1:, 0], 4.0)


def test_exception_in_a_frame_comes_back():
    def groove(x1, x2):
        if x1 > 0.1:
            raise ZeroDivisionError("in the user's code")
        return 0.0

    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.3), asp.Ellipse(2.0, 1.0))
    body = BALL.replace(velocity=(1.0, 0.0, 0.0))
    system = asp.RigidBodies(
        [body], pairs=[asp.PointPlane(0, point=(0, 0, 0), plane=FLOOR, law=law, frame=groove)]
    )
    with pytest.raises(ZeroDivisionError, match="user's code") as caught:
        asp.simulate(system, dt=1e-2, t_end=1.0)
    assert caught.value.trajectory.q[-1, 0] < 0.15
    # It is over with the run.
    asp.simulate(system, dt=1e-2, t_end=5e-2)


def test_laws_of_all_or_some_pairs_are_exchanged():
    rough, smooth = asp.FrictionLaw.isotropic(0.6), asp.FrictionLaw.isotropic(0.1)
    floor = asp.Plane()
    feet = [
        asp.PointPlane(0, point=(x, y, -0.1), plane=floor, law=rough)
        for x, y in ((0.1, 0.0), (-0.1, 0.1), (-0.1, -0.1))
    ]
    body = asp.Body.box(1.0, half_sizes=(0.1, 0.1, 0.1), position=(0.0, 0.0, 0.1))
    table = asp.RigidBodies([body], pairs=feet)
    assert {pair.law for pair in table.with_law(smooth).pairs} == {smooth}
    some = table.with_law(smooth, pairs=[0, 2])
    assert [pair.law for pair in some.pairs] == [smooth, rough, smooth]
    assert some.replace(pairs=table.pairs) == table
    for wrong in (3, [], "left", 0.5):
        with pytest.raises(asp.ParameterError) as refused:
            table.with_law(smooth, pairs=wrong)
        assert refused.value.argument == "pairs"
    with pytest.raises(asp.ParameterError, match="law"):
        table.with_law(0.3)
